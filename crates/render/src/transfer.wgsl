// Copies a picture of linear light into a target whose bytes are written without conversion, and
// text unchanged.

@group(0) @binding(0) var picture: texture_2d<f32>;

@vertex fn transfer_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment fn transfer_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    let light = textureLoad(picture, vec2<i32>(pixel.xy), 0);
    // IEC 61966-2-1.
    let bright = 1.055 * pow(light.rgb, vec3(1.0 / 2.4)) - 0.055;
    return vec4(select(bright, 12.92 * light.rgb, light.rgb <= vec3(0.0031308)), light.a);
}

@fragment fn layer_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(picture, vec2<i32>(pixel.xy), 0);
}
