//! Forces of solids: by the library, and by a plain loop over tetrahedra.

#![allow(missing_docs, reason = "criterion's macros make public functions")]

use std::hint::black_box;

use a3_core::{Element, Linearized, Mechanics, Network, Vector3};
use a3_scenes::Description;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Matrix3;

const LAME: [f64; 2] = [5.769e4, 3.846e4];

/// A slightly deformed box with `side` particles along each edge, and its state.
fn solid(side: usize, model: &str, damping: f64) -> (Network, Vec<f64>) {
    let text = format!(
        "[[solid]]\ngrid = [{side}, {side}, {side}]\nsize = [1, 1, 1]\ndensity = 1000\nyoung = 1e5\n\
         poisson = 0.3\nmodel = \"{model}\"\ndamping = {damping}\nat = [0, 0, 0]"
    );
    let setup = Description::parse(&text).unwrap().build(None, &mut |_| Err(String::new()));
    let scene = setup.unwrap().scene;
    let half = scene.state.len() / 2;
    let bent = |(k, x): (usize, &f64)| x + 0.01 * (7.0 * x + k as f64).sin() / side as f64;
    let x = scene.state[..half].iter().enumerate().map(bent).collect();
    (scene.model.network().unwrap().clone(), x)
}

/// Tetrahedron at rest: its corners, the inverse of its edges, and its volume.
type Rest = ([usize; 4], Matrix3<f64>, f64);

fn rest(network: &Network, x: &[f64]) -> Vec<Rest> {
    let n = x.len() / 3;
    let tetrahedra = network.elements().iter().flat_map(|element| match element {
        Element::Solid(solid) => solid.tetrahedra().collect::<Vec<_>>(),
        _ => vec![],
    });
    let at = |i: usize| Vector3::new(x[i], x[n + i], x[2 * n + i]);
    let each = tetrahedra.map(|corners| {
        let corners = corners.map(|i| i as usize);
        let [a, b, c, d] = corners.map(at);
        let edges = Matrix3::from_columns(&[b - a, c - a, d - a]);
        (corners, edges.try_inverse().unwrap(), edges.determinant() / 6.0)
    });
    each.collect()
}

/// The baseline: a simple loop, for either energy.
fn plain(all: &[Rest], neo_hookean: bool, x: &[f64], f: &mut [f64]) {
    let n = x.len() / 3;
    let [lambda, mu] = LAME;
    f.fill(0.0);
    for (corners, inverse, volume) in all {
        let [a, b, c, d] = corners.map(|i| Vector3::new(x[i], x[n + i], x[2 * n + i]));
        let deformation = Matrix3::from_columns(&[b - a, c - a, d - a]) * inverse;
        let stress = if neo_hookean {
            let (m, l) = (4.0 / 3.0 * mu, lambda + 5.0 / 6.0 * mu);
            let [p, q, r] = [0, 1, 2].map(|k| deformation.column(k).into_owned());
            let cofactors = Matrix3::from_columns(&[q.cross(&r), r.cross(&p), p.cross(&q)]);
            let (size, volume) = (deformation.norm_squared(), p.dot(&q.cross(&r)));
            deformation * (m - m / (size + 1.0)) + cofactors * (l * (volume - 1.0) - 0.75 * m)
        } else {
            let strain = 0.5 * (deformation.transpose() * deformation - Matrix3::identity());
            deformation * (Matrix3::identity() * (lambda * strain.trace()) + strain * (2.0 * mu))
        };
        let forces = stress * inverse.transpose() * -*volume;
        for (k, i) in corners[1..].iter().enumerate() {
            for axis in 0..3 {
                f[axis * n + i] += forces[(axis, k)];
                f[axis * n + corners[0]] -= forces[(axis, k)];
            }
        }
    }
}

/// Throughput is in tetrahedra.
fn forces(c: &mut Criterion) {
    for model in ["neo-hookean", "st-venant-kirchhoff"] {
        let mut group = c.benchmark_group(format!("solid/{model}"));
        for side in [7, 21, 33] {
            let (network, x) = solid(side, model, 0.0);
            let (damped, _) = solid(side, model, 0.01);
            let all = rest(&network, &x);
            let v = vec![0.0; x.len()];
            let mut f = v.clone();
            group.throughput(Throughput::Elements(all.len() as u64));
            group.bench_function(BenchmarkId::new("vectors", side), |b| {
                b.iter(|| network.forces(0.0, black_box(&x), &v, &mut f));
            });
            group.bench_function(BenchmarkId::new("plain loop", side), |b| {
                b.iter(|| plain(&all, model == "neo-hookean", black_box(&x), &mut f));
            });
            group.bench_function(BenchmarkId::new("damped", side), |b| {
                b.iter(|| damped.forces(0.0, black_box(&x), &v, &mut f));
            });
            group.bench_function(BenchmarkId::new("differential", side), |b| {
                b.iter(|| network.force_differential(0.0, black_box(&x), &v, &x, &v, &mut f));
            });
            group.bench_function(BenchmarkId::new("couplings", side), |b| {
                b.iter(|| network.couplings(0.0, black_box(&x), true, &mut |k| _ = black_box(k)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = forces
}
criterion_main!(benches);
