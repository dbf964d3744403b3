//! Views: the place of each picture in the target, and the buffers of its contents.

use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages, TextureFormat};

use crate::buffers::{Instances, List, Mesh, buffer};
use crate::gpu::Gpu;
use crate::picture::{Picture, Style, Tile};

/// The direction towards the light: from above, over the left shoulder.
const LIGHT: [f32; 3] = [-0.62, 0.78, 0.42];
/// The radius of the floor: its least value in units of length, and its ratio to the distance of
/// the eye from the target.
const FLOOR_REACH: (f32, f32) = (14.0, 1.4);
/// The height above the floor, in units of length, below which surfaces have a contact shadow, as
/// in `floor.wgsl`.
const CONTACT_REACH: f32 = 0.22;
/// The radii, in units of length, from which on balls are drawn with more triangles.
const DETAIL_RADII: [f32; 2] = [0.03, 0.25];

/// The uniforms of the shaders, as `scene.wgsl` declares them.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Globals {
    view_projection: [[f32; 4]; 4],
    eye: [f32; 4],
    light: [f32; 4],
    tile: [f32; 4],
    floor: [f32; 4],
    depth: [f32; 4],
}

/// The buffers of a picture.
pub(crate) struct View {
    globals: wgpu::Buffer,
    points: List,
    pub(crate) bind: wgpu::BindGroup,
    pub(crate) balls: Instances,
    pub(crate) solids: Instances,
    pub(crate) lines: Instances,
    /// Vertices and triangles of a liquid.
    pub(crate) liquid: [Instances; 2],
    pub(crate) mesh: Mesh,
    pub(crate) frame: Frame,
}

/// A side of the floor.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Above,
    Below,
}

/// The properties of the last prepared picture that draw calls depend on.
#[derive(Clone, Copy, Default)]
pub(crate) struct Frame {
    pub(crate) tile: Tile,
    /// The side from which the floor is seen, if it is drawn.
    pub(crate) floor: Option<Side>,
    /// Whether anything is near enough to the floor for a contact shadow.
    pub(crate) touches_floor: bool,
    /// Whether the background is drawn.
    pub(crate) background: bool,
    /// The style that is drawn: wires if there is no surface.
    pub(crate) style: Style,
    /// The numbers of small balls, of small and medium ones, and of all.
    pub(crate) balls: [u32; 3],
    /// The number of solids.
    pub(crate) solids: u32,
    /// The number of lines.
    pub(crate) lines: u32,
    /// The number of corners of all triangles of a liquid.
    pub(crate) liquid: u32,
}

impl View {
    pub(crate) fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, mesh: &Mesh) -> Self {
        let device = &gpu.device;
        let size = size_of::<Globals>();
        let globals = buffer(device, "globals", BufferUsages::UNIFORM, size);
        let places = mesh.points + mesh.splits.len();
        let points = List::new(device, "points", TextureFormat::Rgba32Float, places);
        let lists = [&points, &mesh.first, &mesh.around];
        let lists = lists.map(|list| wgpu::BindingResource::TextureView(&list.view));
        let all = [globals.as_entire_binding()].into_iter().chain(lists);
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = (0..).zip(all).map(entry).collect();
        Self {
            bind: device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("particles"),
                layout,
                entries: &entries,
            }),
            balls: Instances::new(device, "balls", BufferUsages::VERTEX),
            solids: Instances::new(device, "solids", BufferUsages::VERTEX),
            lines: Instances::new(device, "lines", BufferUsages::VERTEX),
            liquid: [
                Instances::new(device, "liquid", BufferUsages::VERTEX),
                Instances::new(device, "liquid's triangles", BufferUsages::INDEX),
            ],
            frame: Frame::default(),
            mesh: mesh.clone(),
            globals,
            points,
        }
    }

    /// Sends a picture to the GPU, to be drawn in this part of the target.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, picture: &Picture, tile: Tile) {
        let queue = &gpu.queue;
        if self.mesh.splits.is_empty() {
            self.points.write(gpu, picture.points);
        } else {
            let splits = self.mesh.splits.iter().map(|i| picture.points[*i as usize]);
            let places: Vec<_> = picture.points.iter().copied().chain(splits).collect();
            self.points.write(gpu, &places);
        }
        let mut balls = picture.balls.to_vec();
        balls.sort_by(|a, b| a.radius.total_cmp(&b.radius));
        self.balls.write(gpu, &balls);
        self.solids.write(gpu, picture.solids);
        self.lines.write(gpu, picture.lines);
        let [corners, triangles] = &mut self.liquid;
        corners.write(gpu, picture.liquid.corners);
        triangles.write(gpu, picture.liquid.triangles);
        let globals = globals(picture, tile);
        let unit = picture.camera.unit();
        let below = |radius: f32| balls.partition_point(|ball| ball.radius < radius * unit) as u32;
        let [small, medium] = DETAIL_RADII.map(below);
        queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&globals));
        self.frame = Frame {
            tile,
            floor: picture.floor.filter(|_| !picture.transparent).map(|floor| {
                if picture.camera.eye().y > floor.height {
                    Side::Above
                } else {
                    Side::Below
                }
            }),
            touches_floor: picture
                .floor
                .is_some_and(|floor| lowest(picture) < floor.height + CONTACT_REACH * unit),
            background: !picture.transparent,
            style: match picture.style {
                Style::Shaded if self.mesh.indices == 0 => Style::Wireframe,
                style => style,
            },
            balls: [small, medium, balls.len() as u32],
            solids: picture.solids.len() as u32,
            lines: picture.lines.len() as u32,
            liquid: 3 * picture.liquid.triangles.len() as u32,
        };
    }
}

impl View {
    /// Draws the triangles of a liquid with the pipeline that is set.
    pub(crate) fn draw_liquid(&self, pass: &mut wgpu::RenderPass) {
        let [corners, triangles] = &self.liquid;
        pass.set_vertex_buffer(0, corners.buffer.slice(..));
        pass.set_index_buffer(triangles.buffer.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.frame.liquid, 0, 0..1);
    }
}

/// Returns the height of the lowest particle, ball or solid (m).
fn lowest(picture: &Picture) -> f32 {
    let points = picture.points.iter().map(|p| p[1]);
    let balls = picture.balls.iter().map(|it| it.center[1] - it.radius);
    let solids = picture.solids.iter().map(|solid| {
        let below = solid.axes.iter().map(|axis| (axis[1] * axis[3]).abs());
        solid.center[1] - solid.radius - below.sum::<f32>()
    });
    let all = points.chain(balls).chain(solids);
    all.fold(f32::INFINITY, f32::min)
}

/// Returns the uniforms for a picture in this part of the target.
fn globals(picture: &Picture, tile: Tile) -> Globals {
    let eye = picture.camera.eye();
    let target = picture.camera.target();
    let marks = f32::from(u8::from(picture.floor.is_some_and(|floor| !floor.solid)));
    let length = LIGHT.iter().map(|l| l * l).sum::<f32>().sqrt();
    let distances = picture.points.iter().map(|p| {
        let squares = [0, 1, 2].map(|axis| (p[axis] - eye[axis]).powi(2));
        (squares[0] + squares[1] + squares[2]).sqrt()
    });
    let (near, far) = distances.fold((f32::INFINITY, 0.0f32), |(near, far), d| {
        (near.min(d), far.max(d))
    });
    Globals {
        view_projection: picture.camera.view_projection(tile.aspect()).into(),
        eye: [eye.x, eye.y, eye.z, picture.camera.unit()],
        light: [
            LIGHT[0] / length,
            LIGHT[1] / length,
            LIGHT[2] / length,
            marks,
        ],
        tile: [tile.x, tile.y, tile.width, tile.height].map(|side| side as f32),
        floor: [
            picture.floor.map_or(0.0, |floor| floor.height),
            (FLOOR_REACH.0 * picture.camera.unit()).max(FLOOR_REACH.1 * (eye - target).norm()),
            target.x,
            target.z,
        ],
        depth: [near, far, picture.scale, f32::from(u8::from(picture.dark))],
    }
}
