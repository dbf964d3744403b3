// The shaders of lines, which use those of scene.wgsl.

// ---- Lines: quads of a given width on the screen, with edges that fade over a pixel.

struct Line {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    // Distance from the middle of the line (px) and 1, both times the depth: their ratio is linear
    // on the screen, even without linear interpolation, as in WebGL.
    @location(1) across: vec2<f32>,
    // Half the width of the line (px).
    @location(2) @interpolate(flat) half_width: f32,
};

// Corner i of the quad from a to b. A line that crosses the near plane is cut there.
fn line(a: vec3<f32>, b: vec3<f32>, points_wide: f32, color: vec4<f32>, i: u32) -> Line {
    var ca = globals.view_proj * vec4(a, 1.0);
    var cb = globals.view_proj * vec4(b, 1.0);
    if ca.z < 0.0 && cb.z > 0.0 { ca = mix(ca, cb, ca.z / (ca.z - cb.z)); }
    if cb.z < 0.0 && ca.z > 0.0 { cb = mix(cb, ca, cb.z / (cb.z - ca.z)); }
    let half_size = globals.tile.zw * 0.5;
    let along = (cb.xy / cb.w - ca.xy / ca.w) * half_size;
    let direction = select(vec2(1.0, 0.0), normalize(along), dot(along, along) > 1e-12);
    let end = select(ca, cb, i >= 2u);
    let side = f32(i & 1u) * 2.0 - 1.0;
    let half_width = 0.5 * points_wide * globals.depth.z;
    let reach = half_width + 1.0;
    // Opaque lines reach half a width beyond each end, so that they join. Transparent ones do not,
    // because the overlap would show.
    let beyond = direction * half_width * select(-1.0, 1.0, i >= 2u) * step(0.999, color.a);
    let offset = (vec2(-direction.y, direction.x) * side * reach + beyond) / half_size;
    var out: Line;
    // The line is slightly nearer to the eye, so that a surface does not hide a line on it.
    out.clip = vec4(end.xy + offset * end.w, end.z - 2e-4 * end.w, end.w);
    out.color = color;
    out.across = vec2(side * reach, 1.0) * end.w;
    out.half_width = half_width;
    return out;
}

// The opacity of a wire between two points, which decreases with the distance.
fn faded(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let far = distance(globals.eye.xyz, 0.5 * (a + b));
    let depth = (far - globals.depth.x) / max(globals.depth.y - globals.depth.x, 1e-6);
    return mix(0.95, 0.38, clamp(depth, 0.0, 1.0));
}

@vertex fn wire_vertex(@builtin(vertex_index) i: u32, @location(0) ends: vec2<u32>) -> Line {
    let a = point(ends.x);
    let b = point(ends.y);
    let value = -1.0 - select(a.w, b.w, i >= 2u);
    if value >= 0.0 { return line(a.xyz, b.xyz, 2.0, vec4(ramp(value), 1.0), i); }
    return line(a.xyz, b.xyz, 1.35, vec4(inked(INK), faded(a.xyz, b.xyz)), i);
}

// A spring between two particles, in the colour of its kind or of a value.
@vertex fn spring_vertex(
    @builtin(vertex_index) i: u32,
    @location(0) ends: vec2<u32>, @location(1) points_wide: f32, @location(2) color: vec3<f32>
) -> Line {
    let a = point(ends.x);
    let b = point(ends.y);
    let value = -1.0 - select(a.w, b.w, i >= 2u);
    if value >= 0.0 { return line(a.xyz, b.xyz, points_wide, vec4(ramp(value), 1.0), i); }
    // Opaque, so that no colour is visible through another.
    let strength = 0.75 + 0.25 * faded(a.xyz, b.xyz);
    return line(a.xyz, b.xyz, points_wide, vec4(mix(paper(), inked(color), strength), 1.0), i);
}

@vertex fn line_vertex(
    @builtin(vertex_index) i: u32,
    @location(0) a: vec4<f32>, @location(1) b: vec4<f32>, @location(2) color: vec4<f32>
) -> Line {
    return line(a.xyz, b.xyz, a.w, vec4(inked(color.rgb), color.a), i);
}

// The shadow of a line is as wide on the screen as the line.
struct LineShadow {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) opacity: f32,
    @location(2) across: vec2<f32>,
    @location(3) @interpolate(flat) half_width: f32,
};

fn line_shadow(a: vec3<f32>, b: vec3<f32>, points_wide: f32, i: u32) -> LineShadow {
    let sa = shadow(a);
    let sb = shadow(b);
    let drawn = line(sa.world, sb.world, points_wide, vec4(1.0), i);
    var out: LineShadow;
    out.clip = drawn.clip;
    out.world = select(sa.world, sb.world, i >= 2u);
    out.opacity = select(sa.opacity, sb.opacity, i >= 2u);
    out.across = drawn.across;
    out.half_width = drawn.half_width;
    return out;
}

@vertex fn wire_shadow_vertex(@builtin(vertex_index) i: u32, @location(0) ends: vec2<u32>) -> LineShadow {
    return line_shadow(point(ends.x).xyz, point(ends.y).xyz, 1.35, i);
}

@vertex fn spring_shadow_vertex(
    @builtin(vertex_index) i: u32,
    @location(0) ends: vec2<u32>, @location(1) points_wide: f32, @location(2) color: vec3<f32>
) -> LineShadow {
    return line_shadow(point(ends.x).xyz, point(ends.y).xyz, points_wide, i);
}

@vertex fn line_shadow_vertex(
    @builtin(vertex_index) i: u32,
    @location(0) a: vec4<f32>, @location(1) b: vec4<f32>, @location(2) color: vec4<f32>
) -> LineShadow {
    // A line without a shadow is drawn with no width.
    return line_shadow(a.xyz, select(a.xyz, b.xyz, b.w > 0.5), a.w * step(0.5, b.w), i);
}

@fragment fn line_shadow_fragment(in: LineShadow) -> @location(0) vec4<f32> {
    let edge = clamp(in.half_width + 0.5 - abs(in.across.x / in.across.y), 0.0, 1.0) * step(0.01, in.half_width);
    return shadow_color(in.world, in.clip.xy, edge * in.opacity);
}

@fragment fn line_fragment(in: Line) -> @location(0) vec4<f32> {
    return vec4(in.color.rgb, in.color.a * clamp(in.half_width + 0.5 - abs(in.across.x / in.across.y), 0.0, 1.0));
}
