//! Steps of every method.

use std::hint::black_box;

use a3_core::{Mechanics, Scene, integrators};
use criterion::{BenchmarkGroup, Criterion, Throughput, measurement::WallTime};

use super::{SIDES, cloth, network};

/// A step of every method on every scene that it supports.
pub fn on_scenes(c: &mut Criterion) {
    for entry in a3_scenes::SCENES {
        let mut group = c.benchmark_group(format!("step/{}", entry.name));
        let scene = entry.build(None).unwrap().scene;
        for method in integrators::METHODS {
            step(&mut group, &scene, method);
        }
        group.finish();
    }
}

/// A step of every method on both cloths, of every size.
pub fn by_size(c: &mut Criterion) {
    for (name, side) in ["cloth", "mit"].into_iter().flat_map(|name| SIDES.map(|side| (name, side)))
    {
        let mut group = c.benchmark_group(format!("step/{name} {side}x{side}"));
        let scene = cloth(name, side);
        group.throughput(Throughput::Elements((side * side) as u64));
        let mut f = vec![0.0; scene.state.len() / 2];
        let (x, v) = scene.state.split_at(f.len());
        group.bench_function("forces", |b| {
            b.iter(|| network(&scene).forces(0.0, black_box(x), black_box(v), &mut f));
        });
        for method in integrators::METHODS {
            step(&mut group, &scene, method);
            adaptive_step(&mut group, &scene, method);
        }
        group.finish();
    }
}

/// A step of an adaptive method, with its error estimate.
fn adaptive_step(
    group: &mut BenchmarkGroup<'_, WallTime>,
    scene: &Scene,
    method: &integrators::Method,
) {
    let system = scene.model.system();
    let tolerance = integrators::Tolerance::new(1.0).unwrap();
    let Some(mut adaptive) =
        method.check(system).ok().and_then(|()| method.adaptive(system, tolerance))
    else {
        return;
    };
    let mut y = scene.state.clone();
    group.bench_function(format!("{} adaptive", method.name), |b| {
        b.iter(|| {
            adaptive.try_first(1e-9);
            adaptive.advance(system, 0.0, f64::INFINITY, black_box(&mut y)).unwrap()
        });
    });
}

/// A step of a fixed length.
pub fn step(group: &mut BenchmarkGroup<'_, WallTime>, scene: &Scene, method: &integrators::Method) {
    let system = scene.model.system();
    let Ok(mut integrator) = method.integrator(system) else {
        return;
    };
    let mut y = scene.state.clone();
    group.bench_function(method.name, |b| {
        // The step is so small that the state hardly changes over all steps.
        b.iter(|| integrator.step(system, 0.0, 1e-12, black_box(&mut y)).unwrap());
    });
}
