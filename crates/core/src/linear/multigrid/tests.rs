//! Multigrid on random networks, chains, cloths and jellies.

use super::super::tests::{chain, cloth, jelly, residual, right_hand_side};
use super::super::{Multigrid, Solver, Tangent};
use crate::random::SplitMix;
use crate::spring::{Spring, SpringKind, SpringLaw};
use crate::{Network, Path, Vector3};

/// Returns springs between random particles near one another, of stiffness over four orders, some
/// of them damped; some particles are heavy, some pinned, and some have no spring.
fn thicket(seed: u64, particles: usize) -> (Network, Vec<f64>) {
    let mut random = SplitMix(seed);
    let masses = (0..particles).map(|_| libm::exp(random.between(-7.0, 1.0)));
    let mut network = Network::new(masses.collect()).unwrap();
    let x: Vec<f64> = (0..3 * particles).map(|_| random.between(0.0, 1.0)).collect();
    let at = |i: usize| Vector3::new(x[i], x[particles + i], x[2 * particles + i]);
    for i in (0..particles).filter(|i| i % 17 != 3) {
        for j in (i + 1..particles).filter(|j| j % 17 != 3) {
            let length = (at(i) - at(j)).norm();
            if length > 1.6 / (particles as f64).cbrt() {
                continue;
            }
            let stiffness = libm::exp(random.between(0.0, 9.0));
            let law = SpringLaw::new(stiffness, 0.9 * length, 1e-3 * stiffness).unwrap();
            let kind = SpringKind::Structural;
            network.add_spring(Spring { kind, i, j, law }).unwrap();
        }
    }
    for i in (0..particles).step_by(29) {
        network.pin(i, Path::Still(at(i))).unwrap();
    }
    (network, x)
}

fn cases() -> Vec<(Network, Vec<f64>)> {
    let side = if cfg!(miri) { 6 } else { 20 };
    vec![
        cloth(side, 1e4),
        jelly(side / 2, 1e4),
        chain(5 * side, 1e4),
        thicket(1, 10 * side),
        thicket(2, 11 * side),
        thicket(3, 2),
    ]
}

#[test]
#[cfg_attr(miri, ignore = "libm takes roots in assembly")]
fn solves_the_same_with_it_in_fewer_iterations() {
    for (number, (network, x)) in cases().into_iter().enumerate() {
        let b = right_hand_side(&network);
        let mut solver = Solver::new(&network);
        solver.direct_always = Some(false);
        let _ = solver.assemble(&network, (0.0, 0.05), &x, true);
        let [alone, with] = [false, true].map(|multigrid| {
            solver.multigrid_always = Some(multigrid);
            let mut found = vec![0.0; b.len()];
            let (work, reported) = solver.solve(&network, &b, &mut found, 1e-10);
            let true_residual = residual(&network, &solver.tangent, &b, &found);
            assert!(reported.unwrap() <= 1e-10 && true_residual < 1.01e-10);
            (work.iterations, found)
        });
        // Of a chain, and of few particles, there is little to gain.
        let most = [0.33, 0.4, 1.0, 0.85, 0.85, 1.0][number];
        let ratio = with.0 as f64 / alone.0 as f64;
        assert!(ratio <= most, "case {number}: {} {}", with.0, alone.0);
        let size = alone.1.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for (with, alone) in with.1.iter().zip(&alone.1) {
            assert!((with - alone).abs() < 1e-6 * size, "case {number}");
        }
    }
}

/// Returns the motion of aggregates for a residual.
fn motion(multigrid: &mut Multigrid, r: &[f64]) -> Vec<f64> {
    let product = multigrid.solve(r);
    let n = r.len() / 3;
    let all: Vec<_> = (0..n).map(|i| multigrid.solution(i)).collect();
    let motion: Vec<f64> = (0..3 * n).map(|k| all[k % n][k / n]).collect();
    assert!((product - dot(r, &motion)).abs() <= 1e-6 * product.abs());
    motion
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn it_is_symmetric_and_positive_and_leaves_pinned_particles() {
    for (number, (network, x)) in cases().into_iter().enumerate() {
        let mut tangent = Tangent::new(&network);
        tangent.assemble(&network, (0.0, 0.05), &x, true);
        let mut multigrid = Multigrid::new(&tangent);
        assert!(multigrid.prepare(&tangent) && !multigrid.prepare(&tangent));
        assert_eq!(multigrid.levels.is_empty(), number == 5);
        let r = right_hand_side(&network);
        let s: Vec<f64> = r.iter().map(|r| r * r * r).collect();
        let [of_r, of_s] = [&r, &s].map(|a| motion(&mut multigrid, a));
        let (a, b) = (dot(&of_r, &s), dot(&of_s, &r));
        let size = dot(&of_r, &r).sqrt() * dot(&of_s, &s).sqrt();
        // Shares are stored in single precision.
        assert!((a - b).abs() <= 1e-12 * size, "case {number}: {a} {b}");
        assert!(number == 5 || dot(&of_r, &r) > 0.0 && dot(&of_s, &s) > 0.0);
        let n = network.particles();
        for (k, moved) in of_r.iter().enumerate() {
            assert!(*moved == 0.0 || !network.is_pinned(k % n));
        }
    }
}

#[test]
fn it_follows_what_is_torn_and_what_is_pinned() {
    let (mut network, x) = cloth(12, 1e4);
    let mut tangent = Tangent::new(&network);
    tangent.assemble(&network, (0.0, 0.05), &x, true);
    let multigrid = Multigrid::new(&tangent);
    tangent.assemble(&network, (0.0, 0.02), &x, false);
    assert!(multigrid.fits(&tangent));
    network.pin(40, Path::Still(Vector3::zeros())).unwrap();
    tangent.assemble(&network, (0.0, 0.05), &x, true);
    assert!(!multigrid.fits(&tangent));
    let multigrid = Multigrid::new(&tangent);
    network.break_springs(&[[50, 51]]).unwrap();
    tangent.assemble(&network, (0.0, 0.05), &x, true);
    assert!(!multigrid.fits(&tangent));
}

#[test]
#[cfg_attr(miri, ignore = "takes long")]
fn any_number_of_threads_finds_the_same_bits() {
    let (network, x) = cloth(97, 1e5);
    let b = right_hand_side(&network);
    let found = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut solver = Solver::new(&network);
            solver.direct_always = Some(false);
            let _ = solver.assemble(&network, (0.0, 0.05), &x, true);
            let mut found = vec![0.0; b.len()];
            let (work, _) = solver.solve(&network, &b, &mut found, 1e-6);
            assert!(solver.multigrid.is_some() && work.iterations > 10);
            found
        })
    });
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
}
