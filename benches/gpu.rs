//! Milliseconds a frame of each built-in scene on the graphics adapter that is there, off screen
//! and read back, in two sizes: composing the picture, drawing it, and fetching its pixels.

use std::time::Instant;

use a3_core::{Control, Simulation, integrators};
use a3_media::painter::Painter;
use a3_media::show::{Manner, Show};
use a3_render::Gpu;

/// Sizes of pictures (px).
const SIZES: [(u32, u32); 2] = [(1280, 720), (3840, 2160)];
/// The time for which each scene is drawn (s).
const SECONDS: f64 = 0.5;

fn main() {
    let gpu = match pollster::block_on(Gpu::headless()) {
        Ok(gpu) => gpu,
        Err(why) if std::env::var_os("A3_REQUIRE_GPU").is_some() => panic!("{why}"),
        Err(why) => return eprintln!("no times: {why}"),
    };
    // Cargo's tests of benchmarks draw one small frame of each scene.
    let tests = std::env::args().any(|arg| arg == "--test");
    let sizes = if tests { &SIZES[..1] } else { &SIZES };
    print!("{}\nms a frame", gpu.name());
    for (width, height) in sizes {
        print!("  {width} x {height}");
    }
    println!();
    for entry in a3_scenes::SCENES {
        let setup = entry.build(None).expect("built-in scenes are whole");
        let heun = integrators::find("heun").expect("a method of the table");
        let run = Simulation::new(setup.scene, heun, Control::Step(1e-3)).expect("Heun serves all");
        let mut show = Show::new(setup.presentation, Manner::default());
        print!("{:16}", entry.name);
        for size in sizes {
            let time = frame(&mut show, &run, *size, if tests { 0.0 } else { SECONDS });
            print!("  {:8.2}", 1e3 * time);
        }
        println!();
    }
}

/// Returns the least time of a frame of this size (px), drawn again and again for some seconds (s).
fn frame(show: &mut Show, run: &Simulation, size: (u32, u32), seconds: f64) -> f64 {
    let mut painter = Painter::new(show, run, size, None).expect("the adapter has this size");
    let began = Instant::now();
    let mut least = f64::INFINITY;
    loop {
        let frame = Instant::now();
        painter.draw(show, run).expect("the adapter draws");
        least = least.min(frame.elapsed().as_secs_f64());
        if began.elapsed().as_secs_f64() >= seconds {
            return least;
        }
    }
}
