//! A small scene with all kinds of objects.
#![allow(dead_code, missing_docs, reason = "each test file uses its part")]

use std::io::Write;

use a3_render::{Ball, Camera, Corner, Gpu, Line, Picture, Solid, Spring, Style, Topology};

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
        let mut topology = Topology {
            points: (N * N) as usize,
            ..Topology::default()
        };
        let mut points = vec![];
        for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
            let (u, v) = (j as f32 / (N - 1) as f32, i as f32 / (N - 1) as f32);
            points.push([
                2.0 * u - 1.0,
                1.9 - 1.5 * v,
                0.25 * (9.0 * u).sin() + 0.5 * v * v,
                0.0,
            ]);
            let k = i * N + j;
            if j + 1 < N {
                topology.wires.push([k, k + 1]);
            }
            if i + 1 < N {
                topology.wires.push([k, k + N]);
            }
            let spring = |other: u32, width: f32, color: [f32; 3]| Spring {
                ends: [k, other],
                width,
                color,
            };
            if j + 2 < N {
                topology.springs.push(spring(k + 2, 4.0, [0.3, 0.1, 0.55]));
            }
            if j + 1 < N {
                topology
                    .springs
                    .push(spring(k + 1, 1.6, [0.95, 0.42, 0.02]));
            }
            if i + 1 < N && j + 1 < N {
                topology
                    .springs
                    .push(spring(k + N + 1, 1.6, [0.0, 0.33, 0.36]));
                topology
                    .triangles
                    .extend([[k, k + N, k + 1], [k + 1, k + N, k + N + 1]]);
            }
        }
        let ball = Ball {
            center: [0.9, 0.4, 0.9],
            radius: 0.4,
            color: [0.1, 0.3, 0.5, 1.0],
        };
        let pin = Ball {
            center: [-1.0, 1.9, 0.0],
            radius: 0.06,
            color: [0.02, 0.02, 0.05, 1.0],
        };
        let line = Line::new(
            [-1.4, 0.2, 0.4],
            [-0.9, 1.0, 0.9],
            5.0,
            [0.9, 0.4, 0.0, 1.0],
        );
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

    pub fn picture(&self, style: Style) -> Picture<'_> {
        Picture {
            camera: self.camera,
            style,
            scale: 1.0,
            points: &self.points,
            balls: &self.balls,
            solids: &self.solids,
            lines: &self.lines,
            liquid: a3_render::Liquid {
                corners: &self.liquid.0,
                triangles: &self.liquid.1,
            },
            floor: Some(a3_render::Floor {
                height: 0.0,
                solid: true,
            }),
            transparent: false,
            dark: self.dark,
        }
    }
}
