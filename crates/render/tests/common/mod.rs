//! A small scene with all kinds of objects.
#![allow(dead_code, missing_docs, reason = "each test file uses its part")]

use std::io::Write;

use a3_render::{
    Ball, Camera, Corner, Floor, Gpu, Line, Liquid, OFFSCREEN_FORMAT, Offscreen, Picture, Renderer,
    Solid, Spring, Style, Tile, Topology,
};
use image::RgbaImage;

/// The adapter, or a visible message that there is none. `A3_REQUIRE_GPU` forbids to continue
/// without.
pub fn gpu() -> Option<Gpu> {
    match pollster::block_on(Gpu::headless()) {
        Ok(gpu) => Some(gpu),
        Err(why) if std::env::var_os("A3_REQUIRE_GPU").is_none() => {
            // Written directly, because the test runner hides the output of a passing test.
            let _ = writeln!(std::io::stderr(), "SKIPPED, NOT TESTED: {why}");
            None
        }
        Err(why) => panic!("A3_REQUIRE_GPU is set: {why}"),
    }
}

/// The floor of the pictures.
pub const FLOOR: Floor = Floor { height: 0.0, solid: true };

/// Creates a renderer of offscreen pictures.
pub fn renderer(gpu: &Gpu, topology: &Topology) -> Renderer {
    Renderer::new(gpu, OFFSCREEN_FORMAT, gpu.samples(OFFSCREEN_FORMAT), topology)
}

/// Draws pictures, each in its part of a target of this size (px).
pub fn draw_tiles(
    gpu: &Gpu,
    size: (u32, u32),
    topology: &Topology,
    pictures: &[(Picture, Tile)],
) -> RgbaImage {
    let (mut renderer, offscreen) = (renderer(gpu, topology), Offscreen::new(gpu, size).unwrap());
    let pixels = offscreen.render_tiles(gpu, &mut renderer, pictures, |_, _| vec![]);
    RgbaImage::from_raw(size.0, size.1, pixels.unwrap()).unwrap()
}

/// Draws a picture in a target of this size (px).
pub fn draw(gpu: &Gpu, size: (u32, u32), topology: &Topology, picture: Picture) -> RgbaImage {
    draw_tiles(gpu, size, topology, &[(picture, Tile::whole(size))])
}

/// A wavy sheet of 16 x 16 points above a floor, a ball, a line; no solids and no liquid.
pub struct Sheet {
    pub topology: Topology,
    pub points: Vec<[f32; 4]>,
    pub balls: Vec<Ball>,
    pub lines: Vec<Line>,
    pub solids: Vec<Solid>,
    pub liquid: (Vec<Corner>, Vec<[u32; 3]>),
    pub camera: Camera,
    pub dark: bool,
}

impl Sheet {
    pub fn new() -> Self {
        const N: u32 = 16;
        let mut topology = Topology { points: (N * N) as usize, ..Topology::default() };
        let mut points = vec![];
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let (u, v) = (j as f32 / (N - 1) as f32, i as f32 / (N - 1) as f32);
            points.push([2.0 * u - 1.0, 1.9 - 1.5 * v, 0.25 * (9.0 * u).sin() + 0.5 * v * v, 0.0]);
            let k = i * N + j;
            let (has_right, has_below) = (j + 1 < N, i + 1 < N);
            for (is_there, other) in [(has_right, k + 1), (has_below, k + N)] {
                topology.wires.extend(is_there.then_some([k, other]));
            }
            for (is_there, other, width, color) in [
                (j + 2 < N, k + 2, 4.0, [0.3, 0.1, 0.55]),
                (has_right, k + 1, 1.6, [0.95, 0.42, 0.02]),
                (has_right && has_below, k + N + 1, 1.6, [0.0, 0.33, 0.36]),
            ] {
                let ends = [k, other];
                topology.springs.extend(is_there.then_some(Spring { ends, width, color }));
            }
            if has_right && has_below {
                let halves = [[k, k + N, k + 1], [k + 1, k + N, k + N + 1]];
                topology.triangles.extend(halves);
            }
        }
        let ball = Ball { center: [0.9, 0.4, 0.9], radius: 0.4, color: [0.1, 0.3, 0.5, 1.0] };
        let pin = Ball { center: [-1.0, 1.9, 0.0], radius: 0.06, color: [0.02, 0.02, 0.05, 1.0] };
        let orange = [0.9, 0.4, 0.0, 1.0];
        let line = Line::new([-1.4, 0.2, 0.4], [-0.9, 1.0, 0.9], 5.0, orange);
        Self {
            topology,
            points,
            balls: vec![ball, pin],
            lines: vec![line],
            solids: vec![],
            liquid: (vec![], vec![]),
            camera: Camera::look_at([1.6, 1.9, 4.2], [0.0, 1.0, 0.2]),
            dark: false,
        }
    }

    /// Returns the sheet without its cloth, its balls and its lines, seen from the front.
    pub fn empty(eye: [f32; 3], target: [f32; 3]) -> Self {
        Self {
            topology: Topology::default(),
            points: vec![],
            balls: vec![],
            lines: vec![],
            camera: Camera::look_at(eye, target),
            ..Self::new()
        }
    }

    pub fn picture(&self, style: Style) -> Picture<'_> {
        Picture {
            style,
            points: &self.points,
            balls: &self.balls,
            solids: &self.solids,
            lines: &self.lines,
            liquid: Liquid { corners: &self.liquid.0, triangles: &self.liquid.1 },
            floor: Some(FLOOR),
            dark: self.dark,
            ..Picture::new(self.camera)
        }
    }
}
