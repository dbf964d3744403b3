// The shaders of the floor and of the shadows on it, which use those of scene.wgsl.

// ---- Floor: a faint grid of units of length that fades into the background.

// Number of strips of the floor, and of squares in each.
const FLOOR_STRIPS = 16.0;

struct Floor { @builtin(position) clip: vec4<f32>, @location(0) world: vec3<f32> };

// The floor is drawn in strips, one an instance: software that draws single large triangles leaves
// out parts of them.
@vertex fn floor_vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) strip: u32) -> Floor {
    let corner = vec2(f32(i >> 1u), f32(strip + (i & 1u))) / FLOOR_STRIPS * 2.0 - 1.0;
    let at = globals.floor.zw + corner * globals.floor.y;
    var out: Floor;
    out.world = vec3(at.x, globals.floor.x, at.y);
    out.clip = globals.view_proj * vec4(out.world, 1.0);
    // The floor is a little lower than its height, so that it does not hide a cloth that lies on
    // it. A floor that only marks a height is behind everything, and hides nothing.
    out.clip.z = select(out.clip.z + 1e-4 * out.clip.w, 0.999999 * out.clip.w, globals.light.w > 0.5);
    return out;
}

// The visibility of the floor, from 1 at its centre to 0 at its edge.
fn floor_fade(world: vec3<f32>) -> f32 {
    return 1.0 - smoothstep(0.25, 1.0, length(world.xz - globals.floor.zw) / globals.floor.y);
}

// The visibility of the lines of the grid, from 0 between them to 1 on them.
fn floor_grid(world: vec3<f32>) -> f32 {
    let at = world.xz / globals.eye.w;
    let width = max(fwidth(at), vec2(1e-5));
    let line = 1.0 - min(abs(fract(at - 0.5) - 0.5) / width / globals.depth.z, vec2(1.0));
    return max(line.x, line.y) * min(1.0, 0.2 / max(width.x, width.y));
}

// The floor is fainter at grazing angles.
fn floor_grazing(world: vec3<f32>) -> f32 {
    return smoothstep(0.0, 0.12, abs(normalize(globals.eye.xyz - world).y));
}

// The colour of the floor at a point of the world that is seen in this pixel.
fn floor_color(world: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let ground = mix(vec3(0.90, 0.895, 0.88), vec3(0.085, 0.092, 0.11), globals.depth.w);
    let color = mix(ground, grid(), 0.35 * floor_grid(world));
    let behind = background(pixel) + dither(pixel);
    return mix(behind, color, 0.75 * floor_fade(world) * floor_grazing(world));
}

@fragment fn floor_fragment(in: Floor) -> @location(0) vec4<f32> {
    return vec4(floor_color(in.world, in.clip.xy), 1.0);
}

// From below the floor is glass, through which everything on it is visible.
@fragment fn floor_below_fragment(in: Floor) -> @location(0) vec4<f32> {
    let opacity = 0.16 + 0.5 * floor_grid(in.world);
    return vec4(grid() * 0.9, opacity * floor_fade(in.world) * floor_grazing(in.world));
}

// ---- Shadows on the floor. The stencil keeps them to the pixels in which the floor is seen, and
// where several overlap, the darkest one is seen. The cast shadow is the projection along the light
// of everything above the floor. The contact shadow is where surfaces near the floor keep the sky
// from it.

struct Shadow { @builtin(position) clip: vec4<f32>, @location(0) world: vec3<f32>, @location(1) opacity: f32 };

// A corner of a shadow on the floor.
fn shadow_at(x: f32, z: f32, opacity: f32) -> Shadow {
    var out: Shadow;
    out.world = vec3(x, globals.floor.x, z);
    out.clip = globals.view_proj * vec4(out.world, 1.0);
    out.opacity = mix(1.0, 1.75, globals.depth.w) * opacity;
    return out;
}

// The cast shadow of a point: the higher, the fainter.
fn shadow(p: vec3<f32>) -> Shadow {
    let height = max(p.y - globals.floor.x, 0.0);
    let world = p - globals.light.xyz * (height / globals.light.y);
    return shadow_at(world.x, world.z, 0.34 / (1.0 + 0.35 * height / globals.eye.w));
}

// The contact shadow of a point of a surface with this normal. It is strong where the surface is
// horizontal, and its border, where the surface is vertical, is spread outwards.
fn contact(p: vec3<f32>, normal: vec3<f32>) -> Shadow {
    let n = normal / max(length(normal), 1e-20);
    let at = p.xz + 0.13 * globals.eye.w * n.xz;
    let near = clamp(1.0 - (p.y - globals.floor.x) / (0.22 * globals.eye.w), 0.0, 1.0);
    return shadow_at(at.x, at.y, 0.5 * abs(n.y) * near * near);
}

// The colour of the floor in a shadow.
fn shadow_color(world: vec3<f32>, pixel: vec2<f32>, opacity: f32) -> vec4<f32> {
    let color = mix(vec3(0.10, 0.11, 0.17), vec3(0.0), globals.depth.w);
    return vec4(mix(floor_color(world, pixel), color, opacity * floor_fade(world)), 1.0);
}

@vertex fn mesh_shadow_vertex(@builtin(vertex_index) i: u32) -> Shadow {
    return shadow(point(i).xyz);
}

@vertex fn mesh_contact_vertex(@builtin(vertex_index) i: u32) -> Shadow {
    return contact(point(i).xyz, mesh_normal(i));
}

@vertex fn ball_shadow_vertex(
    @location(0) unit: vec3<f32>, @location(1) ball: vec4<f32>, @location(2) color: vec4<f32>
) -> Shadow {
    return shadow(ball.xyz + ball.w * unit);
}

@vertex fn ball_contact_vertex(
    @location(0) unit: vec3<f32>, @location(1) ball: vec4<f32>, @location(2) color: vec4<f32>
) -> Shadow {
    return contact(ball.xyz + ball.w * unit, unit);
}

@fragment fn shadow_fragment(in: Shadow) -> @location(0) vec4<f32> {
    return shadow_color(in.world, in.clip.xy, in.opacity);
}
