//! Solutions of the linear systems of implicit steps, and their prices.

use std::hint::black_box;
use std::time::{Duration, Instant};

use super::tangent::add_block;
use super::*;
use crate::contact::Skin;
use crate::random::SplitMix;
use crate::spring::{Spring, SpringKind, SpringLaw};
use crate::{GeneralCoupling, Grid, Network, Path, Sheet, Touch, Vector3};

/// Returns a flat square of springs of one stiffness, a corner pinned and everything a little out
/// of place.
pub(super) fn cloth(side: usize, stiffness: f64) -> (Network, Vec<f64>) {
    let grid = Grid::new(side, side).unwrap();
    let spacing = 1.0 / (side - 1) as f64;
    let mut network = Network::new(vec![1.0 / grid.particles() as f64; grid.particles()]).unwrap();
    network
        .add(Sheet::new(grid, spacing, [stiffness, stiffness, 0.25 * stiffness], 0.0).unwrap())
        .unwrap();
    let n = grid.particles();
    let mut random = SplitMix(7);
    let mut x = vec![0.0; 3 * n];
    for k in 0..n {
        (x[k], x[2 * n + k]) = ((k % side) as f64 * spacing, (k / side) as f64 * spacing);
        for axis in 0..3 {
            x[axis * n + k] += 0.05 * spacing * random.between(-1.0, 1.0);
        }
    }
    for corner in [0, side - 1] {
        let at = Vector3::new(x[corner], x[n + corner], x[2 * n + corner]);
        network.pin(corner, Path::Still(at)).unwrap();
    }
    (network, x)
}

/// Returns a line of springs, its first particle pinned.
pub(super) fn chain(count: usize, stiffness: f64) -> (Network, Vec<f64>) {
    let mut network = Network::new(vec![1.0 / count as f64; count]).unwrap();
    let spacing = 1.0 / count as f64;
    let law = SpringLaw::new(stiffness, spacing, 0.0).unwrap();
    for i in 0..count - 1 {
        let (kind, j) = (SpringKind::Structural, i + 1);
        network.add_spring(Spring { kind, i, j, law }).unwrap();
    }
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    let mut random = SplitMix(3);
    let x = (0..3 * count)
        .map(|k| if k < count { k as f64 * spacing } else { 0.0 } + 0.05 * spacing * random.between(-1.0, 1.0))
        .collect();
    (network, x)
}

/// Returns a cube of single springs between neighbours in all directions, a corner pinned.
pub(super) fn jelly(side: usize, stiffness: f64) -> (Network, Vec<f64>) {
    let n = side * side * side;
    let mut network = Network::new(vec![1.0 / n as f64; n]).unwrap();
    let spacing = 1.0 / (side - 1) as f64;
    let place = |i: usize| [i % side, i / side % side, i / side / side];
    for i in 0..n {
        for (dx, dy, dz) in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1)] {
            let j = i + dx + side * (dy + side * dz);
            let [p, d] = [place(i), [dx, dy, dz]];
            if (0..3).all(|axis| p[axis] + d[axis] < side) {
                let length = spacing * ((dx + dy + dz) as f64).sqrt();
                let law = SpringLaw::new(stiffness, length, 0.0).unwrap();
                let kind = SpringKind::Structural;
                network.add_spring(Spring { kind, i, j, law }).unwrap();
            }
        }
    }
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    let mut random = SplitMix(9);
    let at = |k: usize| place(k % n)[k / n] as f64 * spacing;
    let x = (0..3 * n).map(|k| at(k) + 0.05 * spacing * random.between(-1.0, 1.0));
    (network, x.collect())
}

pub(super) fn right_hand_side(network: &Network) -> Vec<f64> {
    let n = network.particles();
    let mut random = SplitMix(5);
    (0..3 * n)
        .map(|k| {
            let b = random.between(-1.0, 1.0);
            if network.is_pinned(k % n) { 0.0 } else { b }
        })
        .collect()
}

pub(super) fn residual(network: &Network, tangent: &Tangent, b: &[f64], x: &[f64]) -> f64 {
    let mut product = vec![0.0; b.len()];
    tangent.product(network, x, &mut product);
    let norm = |a: &mut dyn Iterator<Item = f64>| a.map(|a| a * a).sum::<f64>().sqrt();
    norm(&mut b.iter().zip(&product).map(|(b, p)| b - p)) / norm(&mut b.iter().copied())
}

#[test]
#[cfg_attr(miri, ignore = "libm takes cube roots in assembly")]
fn iterations_and_factors_agree_and_report_the_true_residual() {
    for (network, x) in [chain(30, 1000.0), cloth(7, 300.0), jelly(5, 100.0)] {
        let b = right_hand_side(&network);
        let mut solver = Solver::new(&network);
        let _ = solver.assemble(&network, (0.0, 1.0 / 60.0), &x, true);
        let (mut by_iterations, mut by_factors) = (vec![0.0; b.len()], vec![0.0; b.len()]);
        for tolerance in [1e-3, 1e-6, 1e-12] {
            solver.direct_always = Some(false);
            let (work, reported) = solver.solve(&network, &b, &mut by_iterations, tolerance);
            let found = residual(&network, &solver.tangent, &b, &by_iterations);
            assert!(reported.unwrap() <= tolerance && work.iterations > 0);
            assert!((found - reported.unwrap()).abs() < 1e-13 + 0.01 * found);
        }
        solver.direct_always = Some(true);
        let (work, _) = solver.solve(&network, &b, &mut by_factors, 1e-12);
        assert_eq!((work.factorizations, work.iterations), (1, 0));
        assert!(residual(&network, &solver.tangent, &b, &by_factors) < 1e-12);
        for (a, b) in by_iterations.iter().zip(&by_factors) {
            assert!((a - b).abs() < 1e-9 * by_factors.iter().fold(0.0, |m: f64, b| m.max(b.abs())));
        }
        // The factor is kept for the next right-hand side.
        let (work, _) = solver.solve(&network, &b, &mut by_factors, 1e-12);
        assert_eq!(work.factorizations, 0);
    }
}

#[test]
#[cfg_attr(miri, ignore = "libm takes cube roots in assembly")]
fn what_is_pinned_stays_however_many_iterations_there_are() {
    let (network, x) = cloth(6, 1e4);
    let b = right_hand_side(&network);
    let mut tangent = Tangent::new(&network);
    tangent.assemble(&network, (0.0, 0.1), &x, true);
    let n = network.particles();
    let mut iterative = ConjugateGradients::new(n);
    for most in 0..20 {
        let mut dv = vec![1.0; 3 * n];
        let solution = iterative.solve(&network, (&tangent, None), &b, &mut dv, (0.0, most));
        assert_eq!(solution.iterations, most);
        for (k, dv) in dv.iter().enumerate() {
            assert!(!network.is_pinned(k % n) || *dv == 0.0);
        }
    }
}

/// Cloth squeezed by a tenth: at 1/60 s its matrix is indefinite, and with the clamp it is not.
#[test]
#[cfg_attr(miri, ignore = "libm takes cube roots in assembly")]
fn compressed_cloth_needs_the_clamp() {
    let (network, x) = cloth(20, 2000.0);
    let squeezed: Vec<_> = x.iter().map(|x| 0.9 * x).collect();
    let b = right_hand_side(&network);
    for clamped in [false, true] {
        let mut solver = Solver::new(&network);
        let mut dv = vec![0.0; b.len()];
        let _ = solver.assemble(&network, (0.0, 1.0 / 60.0), &squeezed, clamped);
        for direct in [false, true] {
            solver.direct_always = Some(direct);
            let (_, solved) = solver.solve(&network, &b, &mut dv, 1e-8);
            assert_eq!(solved.is_some(), clamped, "direct: {direct}, clamped: {clamped}");
        }
    }
}

/// Returns the shortest of some runs.
fn time(mut run: impl FnMut()) -> f64 {
    let (mut best, begun) = (Duration::MAX, Instant::now());
    for k in 0..1000 {
        let start = Instant::now();
        run();
        best = best.min(start.elapsed());
        if k >= 2 && begun.elapsed() > Duration::from_millis(150) {
            break;
        }
    }
    best.as_secs_f64()
}

/// `cargo test --release -p a3-core solves_measured -- --ignored --nocapture`
#[test]
#[ignore = "measures"]
fn solves_measured() {
    println!(
        "case                    a w     F us  assembly/F | iter/F  iterations (guess)  PCG/F | with multigrid | factor/F  solve/F  factor price  solve price   picked  best"
    );
    for (name, (network, x)) in [
        ("chain 5", chain(5, 1e2)),
        ("chain 20", chain(20, 1e2)),
        ("chain 100", chain(100, 1e2)),
        ("chain 1000", chain(1000, 1e2)),
        ("cloth 20", cloth(20, 1e2)),
        ("cloth 64", cloth(64, 1e2)),
        ("cloth 128", cloth(128, 1e2)),
        ("cloth 256", cloth(256, 1e2)),
        ("jelly 24", jelly(24, 1e2)),
    ] {
        let b = right_hand_side(&network);
        let mut f = vec![0.0; b.len()];
        let zero = vec![0.0; b.len()];
        let force = time(|| crate::Mechanics::forces(&network, 0.0, black_box(&x), &zero, &mut f));
        for a_w in [1.0, 3.0, 10.0, 30.0, 100.0, 300.0] {
            let mut solver = Solver::new(&network);
            let _ = solver.assemble(&network, (0.0, 1.0), &x, true);
            let a = a_w / solver.stiffness().sqrt();
            let _ = solver.assemble(&network, (0.0, a), &x, true);
            let assemble = time(|| {
                let _ = solver.assemble(&network, (0.0, a), black_box(&x), true);
            });
            let mut dv = vec![0.0; b.len()];
            let tolerance = FORCING;
            solver.direct_always = Some(false);
            let [alone, with] = [false, true].map(|multigrid| {
                solver.multigrid_always = Some(multigrid);
                let [alone, with] = solver.prices(tolerance);
                let mut iterations = 0;
                let time = time(|| {
                    iterations =
                        solver.solve(&network, black_box(&b), &mut dv, tolerance).0.iterations;
                });
                let once = if multigrid { MULTIGRID[1] } else { 0.0 };
                let each = (time / force - once) / iterations as f64;
                (
                    time,
                    format!(
                        "{each:>7.2} {iterations:>5} {:>6.0} ({:>6.0})",
                        time / force,
                        alone.min(with)
                    ),
                )
            });
            solver.multigrid_always = None;
            let pcg = alone.0.min(with.0);
            solver.analyse(&network);
            let direct = solver.direct.as_mut().unwrap();
            let prices = (direct.factorisation, direct.solution);
            let factor = time(|| {
                black_box(direct.factorise(&solver.tangent));
            });
            let solve = time(|| direct.solve(black_box(&b), &mut dv));
            solver.direct_always = None;
            solver.factorised = false;
            let picked = solver.solve(&network, &b, &mut dv, tolerance).0.factorizations == 1;
            println!(
                "{name:<18} {a_w:>8} {:>8.2} {:>9.2} | {} | {} | {:>9.1} {:>8.2} {:>13.1} {:>14.1}  {}  {:.2}",
                1e6 * force,
                assemble / force,
                alone.1,
                with.1,
                factor / force,
                solve / force,
                prices.0,
                prices.1,
                if picked { "direct" } else { "cg    " },
                if picked { (factor + solve) / pcg } else { pcg / (factor + solve) },
            );
        }
    }
}

const FORCING: f64 = 1e-5;

/// A vertex within the thickness of a triangle: the product with the coupling of the four is that
/// with the blocks of each two, it has the blocks on the diagonal, and the stiffness is a bound.
#[test]
fn a_coupling_of_four_particles_is_those_of_each_two() {
    let skin = Skin { thickness: 0.1, stiffness: 50.0, damping: 0.5, ..Skin::default() };
    let mut network = Network::new(vec![0.1, 0.2, 0.3, 0.4]).unwrap();
    network.set_triangles([[1, 2, 3]]).unwrap();
    let touch = Touch { skins: vec![skin; 4], edges: vec![[0, 0]], drops: vec![], bodies: true };
    network.set_touch(Some(touch)).unwrap();
    let x = [0.3, 0.0, 1.0, 0.0, 0.05, 0.0, 0.0, 0.02, 0.2, 0.0, 0.1, 1.0];
    let mut tangent = Tangent::new(&network);
    tangent.assemble(&network, (0.0, 0.2), &x, true);
    assert!(tangent.stiffness() > 10.0, "{}", tangent.stiffness());
    let masses = tangent.masses().to_vec();
    let (mut random, mut product) = (SplitMix(3), [0.0; 12]);
    for _ in 0..20 {
        let p: [f64; 12] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        tangent.product(&network, &p, &mut product);
        let mut expected: [f64; 12] = std::array::from_fn(|k| masses[k % 4] * p[k]);
        let by_mass: f64 = expected.iter().zip(p).map(|(a, p)| a * p).sum();
        tangent.blocks(|i, j, stiffness| {
            let damping = [0.0; 9];
            let coupling = GeneralCoupling { i, j, stiffness, damping };
            add_block(&coupling, stiffness, &p, &mut expected);
        });
        for (a, b) in product.iter().zip(expected) {
            assert!((a - b).abs() < 1e-14, "{a} and {b}");
        }
        let whole: f64 = product.iter().zip(p).map(|(a, p)| a * p).sum();
        assert!((0.0..tangent.stiffness()).contains(&(whole / by_mass - 1.0)));
    }
    for k in 0..12 {
        let unit: [f64; 12] = std::array::from_fn(|i| f64::from(u8::from(i == k)));
        tangent.product(&network, &unit, &mut product);
        let own = tangent.diagonal()[k / 4][k % 4];
        assert!((product[k] - own).abs() < 1e-14, "{} and {own}", product[k]);
    }
}
