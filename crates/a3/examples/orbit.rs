//! A system of one's own, its chart and its picture: a satellite on a closed orbit about the earth
//! and the moon (Arenstorf's; Hairer, Norsett, Wanner, *Solving Ordinary Differential Equations I*,
//! 1993, II.0).
//!
//! `cargo run -p a3-simulator --example orbit -- docs/pictures`

use std::error::Error;

use a3::ChartOptions;
use a3_core::{Ode, Scene, Simulation, integrators};
use a3_render::{Ball, Camera, Gpu, Line, OFFSCREEN_FORMAT, Offscreen, Picture, Renderer};

/// Mass of the moon over that of both.
const MOON: f64 = 0.012_277_471;
/// Period of the orbit, in months over 2 pi.
const PERIOD: f64 = 17.065_216_560_157_96;
/// State at the start, in distances of the moon: x, y, x', y'.
const START: [f64; 4] = [0.994, 0.0, 0.0, -2.001_585_106_379_082_5];

/// Writes the motion of the satellite in the plane of earth and moon, in axes that turn with them.
fn satellite(_t: f64, y: &[f64], dydt: &mut [f64]) {
    let [earth, moon] = [y[0] + MOON, y[0] + MOON - 1.0];
    let pull = |mass: f64, x: f64| mass / x.hypot(y[1]).powi(3);
    let [to_earth, to_moon] = [pull(1.0 - MOON, earth), pull(MOON, moon)];
    dydt[..2].copy_from_slice(&y[2..]);
    dydt[2] = y[0] + 2.0 * y[3] - to_earth * earth - to_moon * moon;
    dydt[3] = y[1] - 2.0 * y[2] - (to_earth + to_moon) * y[1];
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    let scene = Scene::new("Arenstorf's orbit", Ode::new(4, satellite)?, START.to_vec());
    let (mut methods, mut lines) = (vec![], vec![]);
    // Both fixed steps of the picture take 24 000 evaluations.
    for (name, value, color) in [
        ("heun", PERIOD / 12e3, [0.2, 0.2, 0.2, 1.0]),
        ("rk4", PERIOD / 6e3, [0.67, 0.11, 0.0, 1.0]),
        ("dopri5", 1e-6, [0.0, 0.17, 0.45, 1.0]),
    ] {
        let method = integrators::find(name).ok_or("no such method")?;
        methods.push(method);
        let mut run = Simulation::new(scene.clone(), method, method.control(value))?;
        let place = |run: &Simulation| [run.state()[0] as f32, run.state()[1] as f32, 0.0];
        let mut from = place(&run);
        for k in 1..=3000 {
            run.advance_to(PERIOD * f64::from(k) / 3000.0)?;
            lines.push(Line::new(from, place(&run), 3.0, color));
            from = place(&run);
        }
    }
    let until = Some(PERIOD);
    let options = ChartOptions { until, ..ChartOptions::default() };
    let chart = a3::chart(&scene, &methods, &options, &())?;
    let chart = chart.figure(800, 560)?.png(1.5)?;
    std::fs::write(format!("{folder}/orbit-chart.png"), chart)?;

    // Five times as large as they are.
    let globe = |x: f64, radius, color| Ball { center: [x as f32, 0.0, 0.0], radius, color };
    let picture = Picture {
        lines: &lines,
        balls: &[
            globe(-MOON, 0.083, [0.03, 0.17, 0.5, 1.0]),
            globe(1.0 - MOON, 0.0225, [0.3, 0.3, 0.3, 1.0]),
        ],
        ..Picture::new(Camera::look_at([-0.1, 0.0, 3.2], [-0.1, 0.0, 0.0]))
    };
    let gpu = pollster::block_on(Gpu::headless())?;
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let empty = a3_render::Topology::default();
    let mut renderer = Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &empty);
    let (width, height) = (960, 800);
    let pixels = Offscreen::new(&gpu, (width, height))?.render(&gpu, &mut renderer, &picture)?;
    let (file, color) = (format!("{folder}/orbit.png"), image::ColorType::Rgba8);
    Ok(image::save_buffer(file, &pixels, width, height, color)?)
}
