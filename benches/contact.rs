//! Cost of the contact of surfaces per frame: `cargo bench --bench contact -- verlet/64` runs a
//! part.
//!
//! A cloth falls on the floor edge first and folds. The result is the mean time of the frames (1/60
//! s) in which the cloth folds: of a frame with contact, less the same steps from the same state
//! without it.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

use std::time::{Duration, Instant};

use a3_core::{Checkpoint, Control, Simulation, integrators};
use a3_scenes::Description;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

/// Frames per second.
const RATE: f64 = 60.0;

/// First frame that is timed, and the number of frames.
const FRAMES: [u32; 2] = [24, 8];

/// Cloth of that many particles per side, with a surface that can touch.
fn folding(side: usize, method: &str, step: f64) -> Simulation {
    let text = format!(
        r#"
        summary = "a cloth that folds"
        gravity = [0, -9.81, 0]
        drag_per_mass = 0.5
        floor = {{ height = 0, friction = 0.4 }}
        self_collision = true
        [[cloth]]
        grid = [{side}, {side}]
        width = 1
        density = 0.2
        stiffness = [40, 20, 0.5]
        damping_ratio = 0.1
        friction = 0.3
        right = [1, 0, 0]
        down = [0, -0.98, 0.2]
        at = [0, 1.05, 0]
        "#
    );
    let setup = Description::parse(&text)
        .unwrap()
        .build(None, &mut |_| unreachable!("no file is named"))
        .unwrap();
    let method = integrators::find(method).unwrap();
    Simulation::new(setup.scene, method, Control::Step(step)).unwrap()
}

/// Times the frames after a start, each with and without contact.
fn time([with, without]: &mut [Simulation; 2], start: &Checkpoint, steps: u32) -> Duration {
    with.restore(start).unwrap();
    let mut difference = 0.0;
    for _ in 0..FRAMES[1] {
        without.restore(&with.checkpoint()).unwrap();
        without.set_touching(false).unwrap();
        for (simulation, sign) in [(&mut *with, 1.0), (&mut *without, -1.0)] {
            let begun = Instant::now();
            simulation.take_steps(steps.into()).unwrap();
            difference += sign * begun.elapsed().as_secs_f64();
        }
    }
    Duration::from_secs_f64(difference.max(1e-9) / f64::from(FRAMES[1]))
}

fn frames(c: &mut Criterion) {
    let sides: &[usize] =
        if std::env::args().any(|word| word == "--test") { &[20] } else { &[20, 64, 128] };
    // Implicit Euler gains energy in longer steps.
    for (name, method, per_side) in [("verlet", "v", 0.5), ("implicit", "i", 1.0 / 64.0)] {
        let mut group = c.benchmark_group(name);
        for &side in sides {
            let steps = ((per_side * side as f64) as u32).max(1);
            let step = 1.0 / (RATE * f64::from(steps));
            let mut prepared = None;
            group.bench_function(BenchmarkId::from_parameter(side), |b| {
                b.iter_custom(|count| {
                    let (both, start) = prepared.get_or_insert_with(|| {
                        let mut both = [(); 2].map(|()| folding(side, method, step));
                        both[0].take_steps(u64::from(FRAMES[0] * steps)).unwrap();
                        let start = both[0].checkpoint();
                        (both, start)
                    });
                    (0..count).map(|_| time(both, start, steps)).sum()
                });
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(1))
        .measurement_time(Duration::from_millis(100));
    targets = frames
}
criterion_main!(benches);
