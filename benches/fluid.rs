//! Times of fluids with growing numbers of particles: all forces at once, and a step of Verlet's
//! method, in which the lists of neighbours are rebuilt now and then. Throughput is in particles.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

use a3_core::{Control, Mechanics, Simulation, integrators};
use a3_scenes::Description;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

/// Numbers of particles along an edge of a cube.
const SIDES: [usize; 4] = [22, 27, 34, 46];

fn fluids(c: &mut Criterion) {
    for side in SIDES {
        let edge = 0.1 * side as f64;
        let text = format!(
            "[[fluid]]
            size = [{edge}, {edge}, {edge}]
            spacing = 0.1
            at = [0, 0, 0]
            density = 1000
            sound = 20
            strain = [-1, 0.5, 0.5]"
        );
        let scene = Description::parse(&text)
            .and_then(|description| description.build(None, &mut |_| Err("no mesh".into())))
            .unwrap()
            .scene;
        let mut group = c.benchmark_group("fluid");
        group.throughput(Throughput::Elements(scene.model.particles() as u64));
        let network = scene.model.network().unwrap();
        let (x, v) = scene.state.split_at(scene.state.len() / 2);
        let mut f = vec![0.0; x.len()];
        group.bench_function(BenchmarkId::new("forces", x.len() / 3), |b| {
            b.iter(|| network.forces(0.0, black_box(x), black_box(v), &mut f));
        });
        let verlet = integrators::find("verlet").unwrap();
        let mut run = Simulation::new(scene.clone(), verlet, Control::Step(1e-3)).unwrap();
        group.bench_function(BenchmarkId::new("verlet", x.len() / 3), |b| {
            b.iter(|| run.take_steps(1).unwrap());
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(2));
    targets = fluids
}
criterion_main!(benches);
