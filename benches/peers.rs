//! A folding cloth, in comparison with other simulators: `cargo bench --bench peers -- a.pc2 b.pc2`
//! times the scene `peers/folding.toml` and counts the crossings in each of its frames, and in
//! those of the files that the Python scripts in `peers/` write.

#![allow(missing_docs, reason = "a benchmark has no items that others use")]

use std::path::Path;
use std::{env, fs};

use a3_core::{Control, Network, Simulation, Vertex, integrators};
use a3_scenes::Description;

/// Frames per second, frames, and the first frame that is timed, as in `peers/folding.py`.
const RATE: f64 = 60.0;
const FRAMES: u32 = 90;
const FIRST: u32 = 8;

/// Counts over the frames of a run.
#[derive(Debug, Default)]
struct Count {
    /// Edges that pass through triangles, summed over the frames.
    crossings: usize,
    /// Frames with such an edge.
    frames: usize,
    /// Particles below the floor, summed over the frames.
    below: usize,
}

impl Count {
    /// Adds a frame with particles at x (m), n x 3.
    fn add(&mut self, network: &Network, x: &[f64]) {
        let crossed = network.crossed(0.0, x);
        let of_floor = |vertices: &[Vertex]| matches!(vertices, [Vertex::Obstacle(_), ..]);
        let below = crossed.iter().filter(|pair| of_floor(&pair.second)).count();
        self.below += below;
        self.crossings += crossed.len() - below;
        self.frames += usize::from(crossed.len() > below);
    }
}

/// The scene as a simulation.
fn folding(method: &str, steps: u32) -> Simulation {
    let setup = Description::parse(include_str!("peers/folding.toml"))
        .and_then(|scene| scene.build(None, &mut |_| unreachable!("no file is named")))
        .unwrap();
    let method = integrators::find(method).unwrap();
    let step = Control::Step(1.0 / (RATE * f64::from(steps)));
    Simulation::new(setup.scene, method, step).unwrap()
}

/// Processor time of the threads of this program (ms), on Linux.
fn spent() -> f64 {
    let Ok(threads) = fs::read_dir("/proc/self/task") else {
        return f64::NAN;
    };
    let one = |path| fs::read_to_string(path).ok()?.split(' ').next()?.parse::<f64>().ok();
    let times = threads.filter_map(|thread| one(thread.ok()?.path().join("schedstat")));
    1e-6 * times.sum::<f64>()
}

/// Times a number of frames of a method, and counts crossings.
fn time(method: &str, steps: u32, frames: u32) {
    let mut simulation = folding(method, steps);
    let (mut times, mut count) = (Vec::new(), Count::default());
    for _ in 0..frames {
        let begun = spent();
        simulation.take_steps(steps.into()).unwrap();
        times.push(spent() - begun);
        let n = simulation.particles();
        count.add(simulation.model().network().unwrap(), &simulation.state()[..3 * n]);
    }
    let later = &times[(FIRST as usize).min(times.len() - 1)..];
    let mean = later.iter().sum::<f64>() / later.len() as f64;
    let most = later.iter().copied().fold(0.0, f64::max);
    println!("{method} {steps}: {mean:.1} ms a frame, at most {most:.1} ms, {count:?}");
}

/// Counts crossings in the frames of a PC2 file.
fn read(network: &Network, path: &Path) {
    let bytes = fs::read(path).unwrap();
    let points = u32::from_le_bytes(bytes[16..20].try_into().unwrap()) as usize;
    assert_eq!(points, network.particles(), "the file has the particles of the scene");
    let (numbers, _) = bytes[32..].as_chunks::<4>();
    let mut count = Count::default();
    for frame in numbers.chunks_exact(3 * points) {
        let column = |k| frame.iter().skip(k).step_by(3).map(|b| f32::from_le_bytes(*b).into());
        let x: Vec<f64> = (0..3).flat_map(column).collect();
        count.add(network, &x);
    }
    println!("{}: {count:?}", path.display());
}

fn main() {
    let words: Vec<_> = env::args().skip(1).collect();
    let given = |option: &str| words.iter().any(|word| word == option);
    let simulation = folding("i", 1);
    for path in words.iter().map(Path::new) {
        if path.extension().is_some_and(|extension| extension == "pc2") {
            read(simulation.model().network().unwrap(), path);
        }
    }
    let measured = given("--bench") && !given("--test");
    for (method, steps) in [("i", 1), ("i", 10), ("v", 32)] {
        time(method, steps, if measured { FRAMES } else { 2 });
    }
}
