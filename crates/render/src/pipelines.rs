//! Render pipelines: the shader and the vertex data of each kind of object, and how it is combined
//! with the picture so far; and the colours of values.

use wgpu::{
    CompareFunction, PrimitiveTopology, ShaderStages, StencilOperation, TextureSampleType,
    VertexStepMode,
};

use crate::gpu::DEPTH;
use crate::picture::{Ball, Corner, Line, Solid, Spring};

/// The source of the shaders.
pub(crate) const SOURCE: &str =
    concat!(include_str!("scene.wgsl"), include_str!("floor.wgsl"), include_str!("lines.wgsl"));

/// The pipelines, one for each kind of object.
pub(crate) struct Pipelines {
    pub(crate) background: wgpu::RenderPipeline,
    pub(crate) floor: wgpu::RenderPipeline,
    /// The floor, seen from below.
    pub(crate) floor_below: wgpu::RenderPipeline,
    /// Meshes, liquids, balls and solids.
    pub(crate) surfaces: [wgpu::RenderPipeline; 4],
    /// Their shadows, and those where they touch the floor.
    pub(crate) shadows: [wgpu::RenderPipeline; 4],
    pub(crate) contacts: [wgpu::RenderPipeline; 4],
    /// Wires, springs and lines, and their shadows.
    pub(crate) lines: [wgpu::RenderPipeline; 3],
    pub(crate) line_shadows: [wgpu::RenderPipeline; 3],
}

/// Creates the layout of the bind group of all pipelines: the globals, and the particles with their
/// triangles.
pub(crate) fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    };
    let globals = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let list = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let points = list(TextureSampleType::Float { filterable: false });
    let numbers = list(TextureSampleType::Uint);
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("particles"),
        entries: &[
            entry(0, ShaderStages::VERTEX_FRAGMENT, globals),
            entry(1, ShaderStages::VERTEX, points),
            entry(2, ShaderStages::VERTEX, numbers),
            entry(3, ShaderStages::VERTEX, numbers),
        ],
    })
}

/// How a pipeline combines its pixels with the picture so far.
#[derive(Clone, Copy, PartialEq)]
enum Layer {
    /// Drawn where nothing else is.
    Back,
    /// Opaque, and marked in the stencil where it is seen.
    Floor,
    /// Drawn where the floor is seen, if it is darker than the picture so far.
    Shadow,
    /// Opaque.
    Solid,
    /// Blended over the picture behind it.
    Over,
}

impl Pipelines {
    pub(crate) fn new(
        device: &wgpu::Device,
        source: &str,
        layout: &wgpu::BindGroupLayout,
        color: wgpu::TextureFormat,
        samples: u32,
    ) -> Self {
        let (shader, layout) = shaders(device, source, layout);
        // Shaders are given by the first parts of their names.
        let pipeline = |vertex: &str, fragment: &str, topology, layer, buffers: &[_]| {
            let buffers: Vec<Option<wgpu::VertexBufferLayout>> =
                buffers.iter().cloned().map(Some).collect();
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(vertex),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(&format!("{vertex}_vertex")),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &buffers,
                },
                primitive: wgpu::PrimitiveState { topology, ..Default::default() },
                depth_stencil: Some(depth_stencil(layer)),
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(&format!("{fragment}_fragment")),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: color,
                        blend: blend(layer),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let unit = wgpu::vertex_attr_array![0 => Float32x3];
        let ball = wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4];
        let corner = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let solid = wgpu::vertex_attr_array![
            2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4,
            7 => Float32x4, 8 => Float32x4, 9 => Float32x4, 10 => Float32x4,
            11 => Float32x4, 12 => Float32x4, 13 => Float32x4, 14 => Float32x4
        ];
        let drop = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x3];
        let ends = wgpu::vertex_attr_array![0 => Uint32x2];
        let spring = wgpu::vertex_attr_array![0 => Uint32x2, 1 => Float32, 2 => Float32x3];
        let line = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4];
        let balls = [
            stream(VertexStepMode::Vertex, &unit, size_of::<[f32; 3]>()),
            stream(VertexStepMode::Instance, &ball, size_of::<Ball>()),
        ];
        let solids = [
            stream(VertexStepMode::Vertex, &corner, size_of::<[[f32; 3]; 2]>()),
            stream(VertexStepMode::Instance, &solid, size_of::<Solid>()),
        ];
        let liquid = [stream(VertexStepMode::Vertex, &drop, size_of::<Corner>())];
        let instances = |attributes, size| [stream(VertexStepMode::Instance, attributes, size)];
        let wires = instances(&ends[..], size_of::<[u32; 2]>());
        let springs = instances(&spring[..], size_of::<Spring>());
        let lines = instances(&line[..], size_of::<Line>());
        let surfaces = [
            ("mesh", "mesh", &[][..]),
            ("liquid", "liquid", &liquid[..]),
            ("ball", "ball", &balls[..]),
            ("solid", "ball", &solids[..]),
        ];
        let lines = [("wire", &wires[..]), ("spring", &springs[..]), ("line", &lines[..])];
        let list = PrimitiveTopology::TriangleList;
        let strip = PrimitiveTopology::TriangleStrip;
        let cast = |what: &str| {
            surfaces.map(|(kind, _, buffers)| {
                pipeline(&format!("{kind}_{what}"), "shadow", list, Layer::Shadow, buffers)
            })
        };
        Self {
            background: pipeline("background", "background", list, Layer::Back, &[]),
            floor: pipeline("floor", "floor", strip, Layer::Floor, &[]),
            floor_below: pipeline("floor", "floor_below", strip, Layer::Over, &[]),
            surfaces: surfaces.map(|(kind, fragment, buffers)| {
                pipeline(kind, fragment, list, Layer::Solid, buffers)
            }),
            shadows: cast("shadow"),
            contacts: cast("contact"),
            lines: lines.map(|(kind, ends)| pipeline(kind, "line", strip, Layer::Over, ends)),
            line_shadows: lines.map(|(kind, ends)| {
                let shadow = format!("{kind}_shadow");
                pipeline(&shadow, "line_shadow", strip, Layer::Shadow, ends)
            }),
        }
    }
}

/// Creates the module of the shaders, and the layout of all pipelines.
fn shaders(
    device: &wgpu::Device,
    source: &str,
    layout: &wgpu::BindGroupLayout,
) -> (wgpu::ShaderModule, wgpu::PipelineLayout) {
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("scene"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("scene"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    (shader, layout)
}

/// Returns the layout of a buffer of vertices or instances of that length (bytes).
fn stream(
    step_mode: VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
    stride: usize,
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: stride as u64, step_mode, attributes }
}

/// Returns how a layer is combined with the picture so far, unless it replaces it.
fn blend(layer: Layer) -> Option<wgpu::BlendState> {
    let darkest = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Min,
    };
    match layer {
        Layer::Back | Layer::Floor | Layer::Solid => None,
        Layer::Shadow => Some(wgpu::BlendState { color: darkest, alpha: darkest }),
        Layer::Over => Some(wgpu::BlendState::ALPHA_BLENDING),
    }
}

/// Returns the depth and stencil tests of a layer.
fn depth_stencil(layer: Layer) -> wgpu::DepthStencilState {
    let face = |compare, pass_op| wgpu::StencilFaceState {
        compare,
        fail_op: StencilOperation::Keep,
        depth_fail_op: StencilOperation::Keep,
        pass_op,
    };
    let face = match layer {
        Layer::Floor => face(CompareFunction::Always, StencilOperation::Replace),
        Layer::Shadow => face(CompareFunction::Equal, StencilOperation::Keep),
        Layer::Back | Layer::Solid | Layer::Over => wgpu::StencilFaceState::IGNORE,
    };
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(matches!(layer, Layer::Floor | Layer::Solid)),
        depth_compare: Some(match layer {
            Layer::Shadow => CompareFunction::Always,
            _ => CompareFunction::LessEqual,
        }),
        stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff },
        bias: wgpu::DepthBiasState::default(),
    }
}

/// Colours at equal distances, as linear red, green and blue. The shader has the same list.
const RAMP: [[f32; 3]; 8] = [
    [0.058, 0.0, 0.089],
    [0.061, 0.032, 0.209],
    [0.037, 0.107, 0.266],
    [0.02, 0.212, 0.27],
    [0.014, 0.356, 0.242],
    [0.068, 0.533, 0.153],
    [0.352, 0.701, 0.041],
    [0.982, 0.799, 0.019],
];

/// Returns the colour of a value from 0 to 1, as linear red, green and blue, then 1. Values beyond
/// the ends have the colours of the ends.
///
/// ```
/// let [low, high] = [0.0, 1.0].map(a3_render::ramp);
/// assert!(low != high && low[3] == 1.0);
/// ```
#[must_use]
pub fn ramp(value: f32) -> [f32; 4] {
    let last = RAMP.len() - 1;
    let at = value.clamp(0.0, 1.0) * last as f32;
    let below = (at as usize).min(last - 1);
    let share = at - below as f32;
    let [from, to] = [RAMP[below], RAMP[below + 1]];
    let mixed = |k: usize| from[k] + share * (to[k] - from[k]);
    [mixed(0), mixed(1), mixed(2), 1.0]
}

/// Returns the fourth number of a point whose surface is coloured by a value from 0 to 1, instead
/// of the number of a look.
#[must_use]
pub fn shaded_by(value: f32) -> f32 {
    -1.0 - value.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shader_has_the_same_colours() {
        let stops = RAMP.map(|[r, g, b]| format!("vec3({r:?}, {g:?}, {b:?})"));
        let mut rest = SOURCE;
        for stop in &stops {
            let (_, after) = rest.split_once(stop).unwrap_or_else(|| panic!("{stop}"));
            rest = after;
        }
    }

    #[test]
    fn values_have_colours_between_the_stops_ever_brighter() {
        assert_eq!(ramp(0.0)[..3], RAMP[0]);
        assert_eq!(ramp(7.0)[..3], RAMP[RAMP.len() - 1]);
        assert_eq!(ramp(-1.0), ramp(0.0));
        let bright = |k: i32| {
            let [r, g, b, _] = ramp(k as f32 / 100.0);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..100).all(|k| bright(k) < bright(k + 1)));
        assert_eq!([shaded_by(0.25), shaded_by(9.0)], [-1.25, -2.0]);
    }
}
