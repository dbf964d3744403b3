//! The renderer: data that all pictures of one topology share, the order in which parts are drawn,
//! and views, which are the place of each picture in the target and the buffers of its contents.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages, TextureFormat};

use crate::buffers::{Instances, List, Mesh, Shape, buffer, rounded_box, sphere};
use crate::gpu::Gpu;
use crate::picture::{Picture, Style, Tile, Topology};
use crate::pipelines::{Pipelines, SOURCE, layout};

/// Number of strips of the floor, and of squares in each, as in `floor.wgsl`.
const FLOOR_STRIPS: u32 = 16;
/// The mark in the stencil of pixels in which the floor is seen.
const ON_FLOOR: u32 = 1;

/// Draws [`Picture`]s of one scene.
pub struct Renderer {
    pipelines: Pipelines,
    layout: wgpu::BindGroupLayout,
    /// Spheres with few, more and many triangles.
    spheres: [Shape; 3],
    rounded_box: Shape,
    mesh: Mesh,
    /// The views; their number is the largest number drawn at once.
    views: Vec<View>,
    /// The number of views that were prepared last.
    prepared: usize,
}

impl Renderer {
    /// Creates a renderer for targets of this format and number of samples.
    #[must_use]
    pub fn new(gpu: &Gpu, color: wgpu::TextureFormat, samples: u32, topology: &Topology) -> Self {
        Self::with_source(gpu, SOURCE, color, samples, topology)
    }

    fn with_source(
        gpu: &Gpu,
        source: &str,
        color: wgpu::TextureFormat,
        samples: u32,
        topology: &Topology,
    ) -> Self {
        let layout = layout(&gpu.device);
        Self {
            pipelines: Pipelines::new(&gpu.device, source, &layout, color, samples),
            spheres: [4, 8, 40].map(|rings| Shape::new(gpu, "sphere", sphere(rings))),
            rounded_box: Shape::new(gpu, "rounded box", rounded_box(10)),
            mesh: Mesh::new(gpu, topology),
            views: vec![],
            prepared: 0,
            layout,
        }
    }

    /// Replaces the topology of all pictures by that of another scene.
    pub fn set_topology(&mut self, gpu: &Gpu, topology: &Topology) {
        self.mesh = Mesh::new(gpu, topology);
        self.views.clear();
        self.prepared = 0;
    }

    /// Replaces the topology of picture k only, for cloth that is torn in it. If the number of
    /// particles differs, that of all pictures is replaced.
    pub fn set_topology_of(&mut self, gpu: &Gpu, k: usize, topology: &Topology) {
        if topology.points != self.mesh.points {
            self.set_topology(gpu, topology);
        }
        while self.views.len() <= k {
            self.views.push(View::new(gpu, &self.layout, &self.mesh));
        }
        self.views[k] = View::new(gpu, &self.layout, &Mesh::new(gpu, topology));
    }

    /// Sends pictures to the GPU, each for its own part of the target.
    ///
    /// # Panics
    /// Panics if the numbers of particles of a picture and of the topology differ.
    pub fn prepare(&mut self, gpu: &Gpu, pictures: &[(Picture, Tile)]) {
        while self.views.len() < pictures.len() {
            self.views.push(View::new(gpu, &self.layout, &self.mesh));
        }
        for ((picture, tile), view) in pictures.iter().zip(&mut self.views) {
            assert_eq!(
                picture.points.len(),
                self.mesh.points,
                "particles of the picture and of the topology"
            );
            view.prepare(gpu, picture, *tile);
        }
        self.prepared = pictures.len();
    }

    /// Draws the prepared pictures.
    pub fn draw(&self, pass: &mut wgpu::RenderPass) {
        for view in &self.views[..self.prepared] {
            let tile = view.frame.tile;
            let [x, y, width, height] =
                [tile.x, tile.y, tile.width, tile.height].map(|side| side as f32);
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
            self.draw_view(pass, view);
        }
    }

    /// Draws one view into the current viewport.
    fn draw_view(&self, pass: &mut wgpu::RenderPass, view: &View) {
        let (p, frame) = (&self.pipelines, view.frame);
        pass.set_bind_group(0, &view.bind, &[]);
        // Opaque objects come first, so that no pixel is shaded twice, and blended ones last.
        self.draw_surfaces(pass, view, &p.surfaces, true);
        if frame.floor == Some(Side::Above) {
            pass.set_stencil_reference(ON_FLOOR);
            pass.set_pipeline(&p.floor);
            pass.draw(0..2 * FLOOR_STRIPS + 2, 0..FLOOR_STRIPS);
        }
        if frame.background {
            pass.set_pipeline(&p.background);
            pass.draw(0..3, 0..1);
        }
        if frame.floor == Some(Side::Above) {
            self.draw_surfaces(pass, view, &p.shadows, false);
            draw_lines(pass, view, &p.line_shadows);
            if frame.touches_floor {
                self.draw_surfaces(pass, view, &p.contacts, false);
            }
        }
        draw_lines(pass, view, &p.lines);
        if frame.floor == Some(Side::Below) {
            pass.set_pipeline(&p.floor_below);
            pass.draw(0..2 * FLOOR_STRIPS + 2, 0..FLOOR_STRIPS);
        }
    }

    /// Draws meshes, with sharp edges or as a whole, liquid, balls and solids with these pipelines.
    fn draw_surfaces(
        &self,
        pass: &mut wgpu::RenderPass,
        view: &View,
        [mesh, liquid, ball, solid]: &[wgpu::RenderPipeline; 4],
        sharp: bool,
    ) {
        if view.frame.style == Style::Shaded {
            pass.set_pipeline(mesh);
            view.mesh.draw(pass, sharp);
        }
        if view.frame.liquid > 0 {
            pass.set_pipeline(liquid);
            view.draw_liquid(pass);
        }
        pass.set_pipeline(ball);
        let mut start = 0;
        for (shape, end) in self.spheres.iter().zip(view.frame.balls) {
            shape.draw(pass, &view.balls, start..end);
            start = end;
        }
        pass.set_pipeline(solid);
        let shape = &self.rounded_box;
        shape.draw(pass, &view.solids, 0..view.frame.solids);
    }
}

/// Draws wires or springs, and the lines of all styles, with these pipelines.
fn draw_lines(
    pass: &mut wgpu::RenderPass,
    view: &View,
    [wire, spring, line]: &[wgpu::RenderPipeline; 3],
) {
    let (mesh, frame) = (&view.mesh, view.frame);
    let of_style = match frame.style {
        Style::Shaded => None,
        Style::Wireframe => Some((wire, &mesh.wires, mesh.wire_count)),
        Style::Springs => Some((spring, &mesh.springs, mesh.spring_count)),
    };
    let of_all = (line, &view.lines.buffer, frame.lines);
    for (pipeline, buffer, count) in of_style.into_iter().chain([of_all]) {
        if count > 0 {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..4, 0..count);
        }
    }
}

impl Shape {
    fn draw(&self, pass: &mut wgpu::RenderPass, instances: &Instances, range: Range<u32>) {
        if !range.is_empty() {
            pass.set_vertex_buffer(0, self.corners.slice(..));
            pass.set_vertex_buffer(1, instances.buffer.slice(..));
            pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint16);
            pass.draw_indexed(0..self.indices, 0, range);
        }
    }
}

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
struct View {
    globals: wgpu::Buffer,
    points: List,
    bind: wgpu::BindGroup,
    balls: Instances,
    solids: Instances,
    lines: Instances,
    /// Vertices and triangles of a liquid.
    liquid: [Instances; 2],
    mesh: Mesh,
    frame: Frame,
}

/// A side of the floor.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Above,
    Below,
}

/// The properties of the last prepared picture that draw calls depend on.
#[derive(Clone, Copy, Default)]
struct Frame {
    tile: Tile,
    /// The side from which the floor is seen, if it is drawn.
    floor: Option<Side>,
    /// Whether anything is near enough to the floor for a contact shadow.
    touches_floor: bool,
    /// Whether the background is drawn.
    background: bool,
    /// The style that is drawn: wires if there is no surface.
    style: Style,
    /// The numbers of small balls, of small and medium ones, and of all.
    balls: [u32; 3],
    /// The number of solids.
    solids: u32,
    /// The number of lines.
    lines: u32,
    /// The number of corners of all triangles of a liquid.
    liquid: u32,
}

impl View {
    fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, mesh: &Mesh) -> Self {
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
    fn prepare(&mut self, gpu: &Gpu, picture: &Picture, tile: Tile) {
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
                let above = picture.camera.eye().y > floor.height;
                if above { Side::Above } else { Side::Below }
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
    fn draw_liquid(&self, pass: &mut wgpu::RenderPass) {
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
    let (near, far) =
        distances.fold((f32::INFINITY, 0.0f32), |(near, far), d| (near.min(d), far.max(d)));
    Globals {
        view_projection: picture.camera.view_projection(tile.aspect()).into(),
        eye: [eye.x, eye.y, eye.z, picture.camera.unit()],
        light: [LIGHT[0] / length, LIGHT[1] / length, LIGHT[2] / length, marks],
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

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::{Camera, OFFSCREEN_FORMAT, Offscreen};

    /// Returns the pixels, by rows, of a ridge of two slopes of different sizes, drawn with these
    /// shaders.
    fn ridge(gpu: &Gpu, source: &str) -> Vec<u8> {
        let ridge = [[-1.0, 0.0], [-0.6, 0.5], [1.0, 0.0]];
        let points = ridge.map(|[x, z]| [[x, 0.6, z, 0.0], [x, -0.6, z, 0.0]]).concat();
        let triangles = vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
        let topology = Topology { points: points.len(), triangles, ..Topology::default() };
        let samples = gpu.samples(OFFSCREEN_FORMAT);
        let mut renderer = Renderer::with_source(gpu, source, OFFSCREEN_FORMAT, samples, &topology);
        let picture =
            Picture { points: &points, ..Picture::new(Camera::look_at([0.0, 0.0, 3.0], [0.0; 3])) };
        Offscreen::new(gpu, (96, 64)).unwrap().render(gpu, &mut renderer, &picture).unwrap()
    }

    /// Shaders with wrong normals draw a different picture.
    #[test]
    fn normals_are_seen_to_be_right() {
        let gpu = match pollster::block_on(Gpu::headless()) {
            Ok(gpu) => gpu,
            Err(why) => {
                let is_needed = std::env::var_os("A3_REQUIRE_GPU").is_some();
                assert!(!is_needed, "A3_REQUIRE_GPU is set: {why}");
                // Written directly, because the test runner hides the output of a passing test.
                let _ = writeln!(std::io::stderr(), "SKIPPED, NOT TESTED: {why}");
                return;
            }
        };
        let right = ridge(&gpu, SOURCE);
        assert_eq!(ridge(&gpu, SOURCE), right);
        let sum = "n += cross(point(others.x).xyz - p, point(others.y).xyz - p);";
        let front = "select(-1.0, 1.0, front)";
        for (good, bad) in [
            ("out.normal = n;", "out.normal = -n;"),
            ("out.normal = n;", "out.normal = vec3(0.0, 0.0, 1.0);"),
            // Only one of the triangles; then all of them with equal weights.
            (sum, &sum.replace("n +=", "n =")),
            (sum, &sum.replace("cross(", "normalize(cross(").replace(");", "));")),
            (front, &format!("1.0 + 0.0 * {front} - 2.0")),
        ] {
            assert!(SOURCE.contains(good));
            let wrong = ridge(&gpu, &SOURCE.replace(good, bad));
            let errors = right.iter().zip(&wrong).map(|(a, b)| u64::from(a.abs_diff(*b)));
            let mean = errors.sum::<u64>() as f64 / right.len() as f64;
            assert!(mean > 0.4, "{bad}: mean error {mean}");
        }
    }
}
