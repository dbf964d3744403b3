// The shaders of all pipelines. They share one bind group: the camera and the light, and the
// positions of the particles with the triangles that give them normals. Positions are sent once per
// frame; the mesh, the wireframe and the shadow read the same copy. Lists are in the rows of
// textures, because WebGL has no storage buffers. floor.wgsl and lines.wgsl continue this file.

struct Globals {
    view_proj: mat4x4<f32>,
    // Position of the eye, and unit of length (m).
    eye: vec4<f32>,
    // The direction towards the light, in world space; 1 if the floor only marks a height.
    light: vec4<f32>,
    // Left, top, width and height of the picture in its target (px).
    tile: vec4<f32>,
    // Height of the floor, its radius, and x and z of its centre (m).
    floor: vec4<f32>,
    // Distances of the nearest and the farthest particle from the eye (m); pixels per point; 1 in
    // the dark theme and 0 in the light one.
    depth: vec4<f32>,
};

@group(0) @binding(0) var<uniform> globals: Globals;
@group(0) @binding(1) var points: texture_2d<f32>;
// The triangles around point i are items first[i] to first[i + 1] - 1 of `around`. Each is given by
// its other two corners.
@group(0) @binding(2) var first: texture_2d<u32>;
@group(0) @binding(3) var around: texture_2d<u32>;

// The number of items in a row of a list.
const ROW = 2048u;

// The texel of item i of a list.
fn item(i: u32) -> vec2<u32> { return vec2(i % ROW, i / ROW); }

// Position of point i (m), and the look of its surface.
fn point(i: u32) -> vec4<f32> { return textureLoad(points, item(i), 0); }

const PAPER = vec3(0.86, 0.855, 0.835);
const SHADE = vec3(0.56, 0.60, 0.655);
// Water in spray, at its surface, and deep below it.
const SPRAY = vec3(0.80, 0.90, 0.94);
const SHALLOW = vec3(0.05, 0.42, 0.60);
const DEEP = vec3(0.01, 0.11, 0.30);
const INK = vec3(0.035, 0.05, 0.09);

// Paper, its shade towards the corners, and the grid on the floor, in the theme's colours.
fn paper() -> vec3<f32> { return mix(PAPER, vec3(0.060, 0.066, 0.082), globals.depth.w); }
fn shade() -> vec3<f32> { return mix(SHADE, vec3(0.020, 0.022, 0.030), globals.depth.w); }
fn grid() -> vec3<f32> { return mix(SHADE * 0.8, vec3(0.20, 0.22, 0.26), globals.depth.w); }

// A colour, or light grey for one that is nearly black in the dark theme.
fn inked(color: vec3<f32>) -> vec3<f32> {
    let black = max(color.r, max(color.g, color.b)) < 0.12;
    return select(color, vec3(0.62, 0.64, 0.68), black && globals.depth.w > 0.5);
}

// The colours of surfaces by their look, outside and inside: cloth in red, teal, amber and violet,
// jelly in green, orange, berry and blue, and steel.
const OUTSIDE = array(
    vec3(0.62, 0.045, 0.06), vec3(0.01, 0.30, 0.34), vec3(0.72, 0.30, 0.02), vec3(0.24, 0.09, 0.46),
    vec3(0.05, 0.42, 0.16), vec3(0.82, 0.22, 0.02), vec3(0.50, 0.03, 0.22), vec3(0.03, 0.20, 0.55),
    vec3(0.30, 0.36, 0.44),
);
const INSIDE = array(
    vec3(0.50, 0.17, 0.05), vec3(0.10, 0.36, 0.22), vec3(0.58, 0.42, 0.12), vec3(0.40, 0.14, 0.36),
    vec3(0.12, 0.50, 0.24), vec3(0.90, 0.36, 0.08), vec3(0.62, 0.10, 0.32), vec3(0.10, 0.32, 0.66),
    vec3(0.30, 0.36, 0.44),
);

// The colours of values from 0 to 1, at equal distances: each begins where the previous one ends.
// Software adapters would copy an array of them for every pixel.
fn ramp(value: f32) -> vec3<f32> {
    let at = clamp(value, 0.0, 1.0) * 7.0;
    var color = vec3(0.058, 0.0, 0.089);
    color = mix(color, vec3(0.061, 0.032, 0.209), saturate(at));
    color = mix(color, vec3(0.037, 0.107, 0.266), saturate(at - 1.0));
    color = mix(color, vec3(0.02, 0.212, 0.27), saturate(at - 2.0));
    color = mix(color, vec3(0.014, 0.356, 0.242), saturate(at - 3.0));
    color = mix(color, vec3(0.068, 0.533, 0.153), saturate(at - 4.0));
    color = mix(color, vec3(0.352, 0.701, 0.041), saturate(at - 5.0));
    color = mix(color, vec3(0.982, 0.799, 0.019), saturate(at - 6.0));
    return color;
}

// ---- Background: paper, darker towards the corners, drawn where nothing else is.

@vertex fn background_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 1.0, 1.0);
}

fn background(pixel: vec2<f32>) -> vec3<f32> {
    let p = ((pixel - globals.tile.xy) / globals.tile.zw - vec2(0.5, 0.42)) * vec2(1.0, 1.15);
    return mix(paper(), shade(), min(2.1 * dot(p, p), 1.0));
}

// Noise of up to half a step of an 8-bit channel, so that the gradient shows no bands.
fn dither(pixel: vec2<f32>) -> f32 {
    return (fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

@fragment fn background_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4(background(pixel.xy) + dither(pixel.xy), 1.0);
}

// ---- Light: a lamp, the sky, and a faint light from the eye, so that nothing is black.

fn lit(color: vec3<f32>, n: vec3<f32>, world: vec3<f32>, gloss: f32, sheen: f32) -> vec3<f32> {
    let eye = normalize(globals.eye.xyz - world);
    let lamp = globals.light.xyz;
    let facing = dot(n, lamp);
    let key = max(facing * 0.9 + 0.1, 0.0);
    let sky = 0.5 + 0.5 * n.y;
    let head = max(dot(n, eye), 0.0);
    let bright = 1.2 * key * vec3(1.0, 0.97, 0.92) + 0.22 * sky * vec3(0.82, 0.9, 1.0) + 0.16 * head + 0.04;
    // Powers of 48 and of 3.5.
    let mirrored = max(dot(n, normalize(lamp + eye)), 0.0);
    let squared = mirrored * mirrored;
    let fourth = squared * squared;
    let sixteenth = (fourth * fourth) * (fourth * fourth);
    let spark = gloss * sixteenth * sixteenth * sixteenth * step(0.0, facing);
    let edge = max(1.0 - head, 0.0);
    let rim = sheen * edge * edge * edge * sqrt(edge) * (0.35 + 0.65 * sky);
    return color * bright + spark + rim * mix(color, vec3(1.0), 0.45);
}

// ---- Mesh: smooth and two-sided. The normal of a point is the sum of the cross products of two
// sides of each of its triangles. The length of a cross product is twice the area of its triangle,
// so that normals are weighted by area.

struct Mesh {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    // Colours outside and inside, and the finish.
    @location(2) @interpolate(flat) outside: vec3<f32>,
    @location(3) @interpolate(flat) inside: vec3<f32>,
    @location(4) @interpolate(flat) finish: vec3<f32>,
    // Value from 0 to 1, where the surface is coloured by one; -1 elsewhere.
    @location(5) value: f32,
};

// Finishes of surfaces: gloss, sheen, and how much light comes through.
const CLOTH = vec3(0.07, 0.35, 0.0);
const JELLY = vec3(0.55, 0.5, 1.0);
const STEEL = vec3(0.5, 0.25, 0.0);
const CHART = vec3(0.0, 0.1, 0.0);

// The normal of point i, not of unit length.
fn mesh_normal(i: u32) -> vec3<f32> {
    let p = point(i).xyz;
    let end = textureLoad(first, item(i + 1u), 0).x;
    var n = vec3(0.0);
    for (var k = textureLoad(first, item(i), 0).x; k < end; k++) {
        let others = textureLoad(around, item(k), 0).xy;
        n += cross(point(others.x).xyz - p, point(others.y).xyz - p);
    }
    return n;
}

@vertex fn mesh_vertex(@builtin(vertex_index) i: u32) -> Mesh {
    let here = point(i);
    let p = here.xyz;
    let n = mesh_normal(i);
    var out: Mesh;
    out.clip = globals.view_proj * vec4(p, 1.0);
    out.world = p;
    out.normal = n;
    let look = u32(max(here.w, 0.0));
    var outside = OUTSIDE;
    var inside = INSIDE;
    out.outside = outside[look];
    out.inside = inside[look];
    out.finish = select(select(CLOTH, JELLY, look >= 4u), STEEL, look == 8u);
    out.value = select(-1.0, -1.0 - here.w, here.w < 0.0);
    return out;
}

// The light of the sky that a smooth surface mirrors, by Schlick's approximation of Fresnel's
// equations.
fn mirrored_sky(n: vec3<f32>, eye: vec3<f32>) -> vec3<f32> {
    let grazing = 1.0 - max(dot(n, eye), 0.0);
    let squared = grazing * grazing;
    let sky = mix(shade(), vec3(1.0), smoothstep(-0.3, 0.9, reflect(-eye, n).y)) * mix(1.0, 0.4, globals.depth.w);
    return (0.04 + 0.96 * squared * squared * grazing) * sky;
}

// The light of a surface. Jelly also transmits light from the other side: more along the outline,
// where it is thin, and where the lamp is opposite the eye.
fn finished(color: vec3<f32>, finish: vec3<f32>, n: vec3<f32>, world: vec3<f32>) -> vec3<f32> {
    let eye = normalize(globals.eye.xyz - world);
    let lamp = globals.light.xyz;
    let thin = 1.0 - max(dot(n, eye), 0.0);
    let through = 0.30 + 0.45 * thin * thin + 0.35 * max(dot(-lamp, eye), 0.0) + 0.2 * max(-dot(n, lamp), 0.0);
    let own = mix(1.0, 0.6, finish.z) * color;
    let inner = finish.z * (through * color + 0.25 * mirrored_sky(n, eye));
    return lit(own, n, world, finish.x, finish.y) + inner;
}

// The colour of a value, with a thin dark line at each tenth of the scale. `change` is its fwidth,
// which must be computed in uniform control flow.
fn banded(value: f32, change: f32) -> vec3<f32> {
    let tenths = 10.0 * value;
    let width = max(10.0 * change, 1e-5);
    let off = abs(tenths - round(tenths)) / width / globals.depth.z;
    let inside = step(0.5, tenths) * step(tenths, 9.5);
    let line = (1.0 - smoothstep(0.5, 1.2, off)) * inside * (1.0 - smoothstep(0.1, 0.3, width));
    return mix(ramp(value), INK, 0.55 * line);
}

// The light of a surface that is coloured by a value, if it has one. It is computed once, because
// software adapters execute every branch.
fn valued(value: f32, change: f32, color: vec3<f32>, finish: vec3<f32>, n: vec3<f32>, world: vec3<f32>) -> vec4<f32> {
    let has_value = value >= 0.0;
    let shown = select(color, banded(value, change), has_value);
    return vec4(finished(shown, select(finish, CHART, has_value), n, world), 1.0);
}

@fragment fn mesh_fragment(in: Mesh, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    // A degenerate triangle has no normal, which must not become NaN.
    let n = in.normal / max(length(in.normal), 1e-20) * select(-1.0, 1.0, front);
    let color = select(in.inside, in.outside, front);
    return valued(in.value, fwidth(in.value), color, in.finish, n, in.world);
}

// ---- Liquid: a surface with its own normals.

// The fourth number of a corner is the value that colours it, or -2 less its depth, from -1 to 1.
@vertex fn liquid_vertex(@location(0) corner: vec4<f32>, @location(1) normal: vec3<f32>) -> Ball {
    var out: Ball;
    out.world = corner.xyz;
    out.clip = globals.view_proj * vec4(corner.xyz, 1.0);
    out.normal = normal;
    let depth = -2.0 - corner.w;
    out.color = mix(mix(SHALLOW, SPRAY, saturate(-depth)), DEEP, saturate(depth));
    out.value = vec4(corner.w, 0.0, 0.0, step(corner.w, -0.5));
    return out;
}

@vertex fn liquid_shadow_vertex(@location(0) corner: vec4<f32>, @location(1) normal: vec3<f32>) -> Shadow {
    return shadow(corner.xyz);
}

@vertex fn liquid_contact_vertex(@location(0) corner: vec4<f32>, @location(1) normal: vec3<f32>) -> Shadow {
    return contact(corner.xyz, normal);
}

// Water: the background seen through it, bent by its surface and the bluer the more of it there is,
// the light that it scatters, and the sky and the lamp that it mirrors.
fn water(color: vec3<f32>, n: vec3<f32>, world: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let eye = normalize(globals.eye.xyz - world);
    let facing = max(dot(n, eye), 0.0);
    let bend = (globals.view_proj * vec4(n, 0.0)).xy * vec2(-0.12, 0.12) * globals.tile.w;
    let through = background(pixel + bend) * mix(vec3(0.30, 0.66, 0.82), color, facing);
    let scattered = color * (0.1 + 0.45 * max(dot(n, globals.light.xyz), 0.0));
    let spark = pow(max(dot(n, normalize(globals.light.xyz + eye)), 0.0), 90.0);
    return through + scattered + mirrored_sky(n, eye) + vec3(0.9 * spark);
}

@fragment fn liquid_fragment(in: Ball) -> @location(0) vec4<f32> {
    let n = in.normal / max(length(in.normal), 1e-20);
    let value = ball_value(in.value);
    let change = fwidth(length(in.value.xyz));
    if value >= 0.0 { return vec4(finished(banded(value, change), CHART, n, in.world), 1.0); }
    return vec4(water(in.color, n, in.world, in.clip.xy), 1.0);
}

// ---- Balls: particles, pins and spherical obstacles.

struct Ball {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec3<f32>,
    // Vector whose length, from 0 to 1, colours the ball; the fourth number is 1 for its own
    // colour.
    @location(3) value: vec4<f32>,
};

// The value of a ball, or -1.
fn ball_value(value: vec4<f32>) -> f32 { return select(length(value.xyz), -1.0, value.w >= 0.5); }

@vertex fn ball_vertex(
    @location(0) unit: vec3<f32>, @location(1) ball: vec4<f32>, @location(2) color: vec4<f32>
) -> Ball {
    var out: Ball;
    out.world = ball.xyz + ball.w * unit;
    out.clip = globals.view_proj * vec4(out.world, 1.0);
    out.normal = unit;
    out.color = inked(color.rgb);
    out.value = vec4(0.0, 0.0, 0.0, 1.0);
    return out;
}

@fragment fn ball_fragment(in: Ball) -> @location(0) vec4<f32> {
    let change = fwidth(length(in.value.xyz));
    return valued(ball_value(in.value), change, in.color, STEEL, normalize(in.normal), in.world);
}

// ---- Solids: boxes with round edges, which are the pieces of a ball, moved apart.

struct Solid {
    @location(0) unit: vec3<f32>,
    // The piece that the corner belongs to, as -1 or 1 along each axis.
    @location(1) piece: vec3<f32>,
    @location(2) center: vec4<f32>,
    // Directions of the sides, each with its half extent (m).
    @location(3) x: vec4<f32>,
    @location(4) y: vec4<f32>,
    @location(5) z: vec4<f32>,
    @location(6) color: vec4<f32>,
    // Values of the corners.
    @location(7) v0: vec4<f32>, @location(8) v1: vec4<f32>,
    @location(9) v2: vec4<f32>, @location(10) v3: vec4<f32>,
    @location(11) v4: vec4<f32>, @location(12) v5: vec4<f32>,
    @location(13) v6: vec4<f32>, @location(14) v7: vec4<f32>,
};

fn solid_normal(in: Solid) -> vec3<f32> {
    return mat3x3(in.x.xyz, in.y.xyz, in.z.xyz) * in.unit;
}

fn solid_position(in: Solid) -> vec3<f32> {
    let middle = mat3x3(in.x.xyz, in.y.xyz, in.z.xyz) * (in.piece * vec3(in.x.w, in.y.w, in.z.w));
    return in.center.xyz + middle + in.center.w * solid_normal(in);
}

@vertex fn solid_vertex(in: Solid) -> Ball {
    var out: Ball;
    out.world = solid_position(in);
    out.clip = globals.view_proj * vec4(out.world, 1.0);
    out.normal = solid_normal(in);
    out.color = inked(in.color.rgb);
    var values = array(in.v0, in.v1, in.v2, in.v3, in.v4, in.v5, in.v6, in.v7);
    let upper = vec3<u32>(in.piece > vec3(0.0));
    out.value = values[upper.x + 2u * upper.y + 4u * upper.z];
    return out;
}

@vertex fn solid_shadow_vertex(in: Solid) -> Shadow {
    return shadow(solid_position(in));
}

@vertex fn solid_contact_vertex(in: Solid) -> Shadow {
    return contact(solid_position(in), solid_normal(in));
}
