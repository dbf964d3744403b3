//! Bend springs that buckle: their force by independent formulas, and strips that bend smoothly.

use crate::common::{distance, integrate, method, scene_with_grid, size};
use a3_core::{
    Control, Coupling, Linearized, Mechanics, Model, Network, Path, Scene, Simulation, Splitting,
    Spring, SpringKind, SpringLaw, Vector3, elements::Buckling,
};
use approx::assert_relative_eq;

/// Straight strip so stiff in compression that it buckles at once.
const STRIP: Buckling = Buckling {
    i: 0,
    j: 1,
    rest_length: 0.7,
    bending: 0.2,
    compression: 1e12,
    tension: 3.0,
    damping: 0.0,
};
/// Strip that buckles when it is shortened by a tenth.
const SOFT: Buckling =
    Buckling { compression: 12.773_223_695_382_405 * STRIP.bending / (0.7 * 0.7 * 0.07), ..STRIP };

fn network(buckling: Buckling) -> Network {
    let mut network = Network::new(vec![1.0; 2]).unwrap();
    network.add_buckling(buckling).unwrap();
    network
}

/// Force that pulls the ends together (N) at the distance `length` (m).
fn pull(buckling: Buckling, length: f64) -> f64 {
    let mut f = [f64::NAN; 6];
    network(buckling).forces(0.0, &[0.3, 0.3, length, 0.0, 0.0, 0.0], &[0.0; 6], &mut f);
    assert_eq!(f, [0.0, 0.0, f[2], -f[2], 0.0, 0.0]);
    -f[2]
}

/// Pairs of L / r and the force times r^2 / `k_b`, computed with forty digits.
const CURVE: [(f64, f64); 5] = [
    (0.2, -25.554_036_506_524_22),
    (0.5, -17.547_251_317_025_06),
    (0.9, -12.773_223_695_382_405),
    (0.99, -12.072_497_306_688_2),
    (0.999, -12.007_204_940_711_222),
];

#[test]
fn the_push_of_an_arc_is_that_of_its_energy() {
    let (k, r) = (STRIP.bending, STRIP.rest_length);
    for (share, expected) in CURVE {
        let expected = expected * k / (r * r);
        assert_relative_eq!(pull(STRIP, share * r), expected, max_relative = 2e-14);
    }
    // Where the ends almost meet, the arc is a full circle.
    let circle = -4.0 * std::f64::consts::PI.powi(2) * k / (r * r);
    assert_relative_eq!(pull(STRIP, 1e-12), circle, max_relative = 1e-11);
}

#[test]
fn a_strip_is_straight_until_its_arc_would_push_less() {
    let (c, r) = (SOFT.compression, SOFT.rest_length);
    for share in [1.0, 0.999, 0.95, 0.9001] {
        assert_relative_eq!(pull(SOFT, share * r), c * (share * r - r), max_relative = 1e-12);
    }
    for share in [0.8999, 0.5, 0.2] {
        assert_eq!(pull(SOFT, share * r), pull(STRIP, share * r));
        assert!(pull(SOFT, share * r) > c * (share * r - r));
    }
    assert_relative_eq!(pull(SOFT, 0.9), 3.0 * 0.2, max_relative = 1e-12);
}

#[test]
fn the_force_is_continuous_and_grows_with_length() {
    let r = SOFT.rest_length;
    // The force is continuous where the strip buckles and at its rest length.
    for (at, slope) in [(0.9 * r, SOFT.compression), (r, SOFT.compression)] {
        for e in [1e-6, 1e-9, 1e-12] {
            let jump = pull(SOFT, at + e) - pull(SOFT, at - e);
            assert!(jump >= 0.0 && jump <= 2.0 * slope * e + 1e-12, "{jump:e}");
        }
    }
    assert_eq!(pull(SOFT, r), 0.0);
    let mut before = f64::NEG_INFINITY;
    for k in 1..=14_000 {
        let now = pull(SOFT, f64::from(k) * 1e-4 * r);
        assert!(now > before, "{k}");
        before = now;
    }
}

#[test]
fn the_derivative_of_the_energy_is_the_force() {
    let energy = |buckling, length: f64| {
        let x = [0.0, length, 0.0, 0.0, 0.0, 0.0];
        network(buckling).energy(&x, &[0.0; 6]).elastic
    };
    for of in [STRIP, SOFT] {
        for share in [0.1, 0.3, 0.6, 0.88, 0.92, 0.98, 1.1] {
            if of == STRIP && (0.88..1.0).contains(&share) {
                continue;
            }
            let (l, e) = (share * of.rest_length, 1e-5);
            let slope = (energy(of, l + e) - energy(of, l - e)) / (2.0 * e);
            assert_relative_eq!(slope, pull(of, l), max_relative = 1e-6);
        }
    }
    // The energy is continuous where the strip buckles.
    let jump = energy(SOFT, 0.63 + 1e-9) - energy(SOFT, 0.63 - 1e-9);
    assert_relative_eq!(jump, 2e-9 * pull(SOFT, 0.63), max_relative = 1e-5);
    assert_eq!(energy(SOFT, SOFT.rest_length), 0.0);
}

/// Two masses conserve energy while the strip between them is straight, bent and stretched.
#[test]
fn energy_is_conserved() {
    let network = network(SOFT);
    let start = [0.0, 0.7, 0.0, 0.01, 0.0, 0.0, 2.5, 0.0, 0.0, 0.0, 0.0, 0.4];
    let energy = |y: &[f64]| network.energy(&y[..6], &y[6..]);
    let before = energy(&start).total();
    for (name, most) in [("verlet", 2e-3), ("rk4", 1e-5)] {
        let mut y = start.to_vec();
        let (mut bent, mut drift): (f64, f64) = (1.0, 0.0);
        for _ in 0..100 {
            y = integrate(&network, method(name), &y, 0.0005, 100);
            let length = (0..3).map(|a| (y[2 * a] - y[2 * a + 1]).powi(2)).sum::<f64>();
            bent = bent.min(length.sqrt() / 0.7);
            drift = drift.max((energy(&y).total() - before).abs() / before);
        }
        println!("{name}: {drift:e}, down to {bent} of its length");
        assert!(bent < 0.7 && drift < most, "{name}: {drift:e}");
    }
}

#[test]
fn couplings_are_the_symmetric_part_of_the_differential() {
    for (share, damping) in [(0.3, 0.0), (0.85, 0.0), (0.95, 0.0), (1.2, 0.0), (0.5, 0.4)] {
        let network = network(Buckling { damping, ..SOFT });
        let l = share * 0.7;
        let x = [0.0, 0.6 * l, 0.0, 0.8 * l, 0.0, 0.0];
        let (d, zero) = ([0.3, -0.2, 0.5, 0.7, -0.1, 0.4], [0.0; 6]);
        let (dx, dv) = if damping > 0.0 { (&zero, &d) } else { (&d, &zero) };
        let mut df = vec![0.0; 6];
        network.force_differential(0.0, &x, &zero, dx, dv, &mut df);
        let mut sum = vec![0.0; 6];
        let mut count = 0;
        network.couplings(0.0, &x, false, &mut |coupling| {
            let Coupling::Axial(c) = coupling else { panic!("springs act along their length") };
            count += 1;
            assert!(c.along >= 0.0);
            let e: [f64; 3] = std::array::from_fn(|a| d[2 * a] - d[2 * a + 1]);
            let along = (0..3).map(|a| e[a] * c.direction[a]).sum::<f64>();
            for a in 0..3 {
                let turned = along * c.direction[a];
                let force = if damping > 0.0 {
                    c.damping * turned
                } else {
                    c.along * turned + c.across * (e[a] - turned)
                };
                sum[2 * a] -= force;
                sum[2 * a + 1] += force;
            }
        });
        assert_eq!(count, 1);
        assert!(distance(&df, &sum) <= 1e-13 * size(&df), "{share}");
    }
}

const PARTICLES: usize = 11;
const SPACING: f64 = 0.1;

/// Slightly bent strip of 1 m, whose ends are held and move together to a distance of 0.7 m within
/// 5 s.
fn strip() -> Scene {
    let mut network = Network::new(vec![0.01; PARTICLES]).unwrap();
    for i in 0..PARTICLES - 1 {
        network
            .add_spring(Spring {
                kind: SpringKind::Structural,
                i,
                j: i + 1,
                law: SpringLaw::new(2000.0, SPACING, 0.5).unwrap(),
            })
            .unwrap();
    }
    for i in 0..PARTICLES - 2 {
        network
            .add_buckling(Buckling {
                i,
                j: i + 2,
                rest_length: 2.0 * SPACING,
                bending: 0.001,
                compression: 1200.0,
                tension: 0.0,
                damping: 0.02,
            })
            .unwrap();
    }
    network.set_drag(0.05).unwrap();
    let mut state = vec![0.0; 6 * PARTICLES];
    for i in 0..PARTICLES {
        state[i] = (i as f64 - 5.0) * SPACING;
        state[PARTICLES + i] = 0.05 * (1.0 - (state[i] / 0.5).powi(2));
    }
    for (i, to) in [(0, -0.35), (PARTICLES - 1, 0.35)] {
        let path = Path::Line {
            from: Vector3::new(state[i], 0.0, 0.0),
            to: Vector3::new(to, 0.0, 0.0),
            start: 0.0,
            end: 5.0,
        };
        network.pin(i, path).unwrap();
        state[3 * PARTICLES + i] = path.at(0.0).velocity.x;
    }
    Scene::new("strip", Model::Network(Box::new(network)), state)
}

/// Angles (rad) by which the strip bends in the plane at each particle except the ends.
fn turns(run: &Simulation) -> Vec<f64> {
    let way = |i: usize| run.position(i + 1) - run.position(i);
    (0..PARTICLES - 2)
        .map(|i| {
            let (a, b) = (way(i), way(i + 1));
            (a.x * b.y - a.y * b.x).atan2(a.dot(&b))
        })
        .collect()
}

#[test]
fn a_compressed_strip_buckles_to_one_side_in_a_smooth_arch() {
    let mut shapes = vec![];
    for (name, step) in
        [("implicit", 0.01), ("tr-bdf2", 0.005), ("rk4", 0.0005), ("verlet", 0.0005)]
    {
        let mut run = Simulation::new(strip(), method(name), method(name).control(step)).unwrap();
        let mut roughest: f64 = 0.0;
        while run.time() < 8.0 {
            run.take_steps(1).unwrap();
            let turns = turns(&run);
            let change = turns.windows(2).map(|w| (w[1] - w[0]).abs());
            let rough = change.fold(0.0, f64::max);
            // The strip still oscillates after the jerk at the start.
            assert!(rough < 0.7, "{name}: {rough}");
            if run.time() > 2.0 {
                roughest = roughest.max(rough);
            }
        }
        let turns = turns(&run);
        println!("{name}: roughest {roughest:.3}, top {:.4}, turns {turns:.3?}", run.position(5).y);
        // The compressed strip bows upwards everywhere, and most in the middle.
        assert!(turns.iter().all(|turn| *turn < -0.1 && *turn > -0.4), "{name}");
        assert!(turns[..5].is_sorted_by(|a, b| a >= b), "{name}");
        // The strip bows smoothly and does not fold.
        assert!(roughest < 0.1, "{name}: {roughest}");
        assert!(run.velocities().iter().all(|v| v.abs() < 1e-4), "{name}");
        shapes.push(run.position(5).y);
    }
    for top in &shapes {
        // Height of Euler's elastica of length 1 m over a span of 0.7 m, by elliptic integrals.
        assert_relative_eq!(*top, shapes[0], max_relative = 1e-3);
        assert_relative_eq!(*top, 0.314_312_613, max_relative = 0.01);
    }
}

#[test]
fn a_strip_runs_again_to_the_bit() {
    let run = || {
        let mut run = Simulation::new(strip(), method("implicit"), Control::Step(0.01)).unwrap();
        run.advance_to(1.5).unwrap();
        run.state().to_vec()
    };
    assert!(run() == run());
}

#[test]
fn strips_are_springs_to_those_who_ask() {
    let mut network = network(STRIP);
    assert_eq!(network.forces_in_use(), ["buckling"]);
    assert_eq!(network.buckling().collect::<Vec<_>>(), [STRIP]);
    let listed: Vec<_> = network.springs_of(1).collect();
    assert_eq!((listed.len(), listed[0].kind), (1, SpringKind::Bend));
    assert_eq!(listed[0].law.rest_length, STRIP.rest_length);
    assert!(!network.kick_reads_velocity());
    let damped = Buckling { damping: 0.1, ..STRIP };
    network.add_buckling(damped).unwrap();
    assert!(network.kick_reads_velocity());
    assert_eq!(network.forces_in_use(), ["buckling", "spring damping"]);
    network.scale_springs(4.0, 2.0).unwrap();
    let stiffer = network.buckling().next().unwrap();
    assert_eq!(stiffer.bending, 4.0 * STRIP.bending);
    assert_eq!(pull(stiffer, 0.3), 4.0 * pull(STRIP, 0.3));
}

/// Strips act on the particles of a sheet, which is then stepped without sweeps.
#[test]
fn a_sheet_may_have_strips() {
    let scene = scene_with_grid("mit", 5, 6);
    let mut network = scene.model.network().unwrap().clone();
    let (x, v) = scene.state.split_at(scene.state.len() / 2);
    let (mut without, mut with) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    network.forces(0.0, x, v, &mut without);
    let strip = Buckling { i: 7, j: 9, rest_length: 3.0, ..STRIP };
    network.add_buckling(strip).unwrap();
    network.forces(0.0, x, v, &mut with);
    let change: Vec<f64> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
    let length = (0..3).map(|a| (x[30 * a + 7] - x[30 * a + 9]).powi(2));
    let alone = Buckling { i: 0, j: 1, ..strip };
    let expected = pull(alone, length.sum::<f64>().sqrt()).abs();
    assert!(expected > 0.1);
    for i in 0..30 {
        let size = (0..3).map(|a| change[30 * a + i].powi(2)).sum::<f64>();
        let held = if i == 7 || i == 9 { expected } else { 0.0 };
        assert_relative_eq!(size.sqrt(), held, epsilon = 1e-10);
    }
    assert!(Mechanics::rows(&network).is_none());
}

#[test]
fn strips_that_make_no_sense_are_refused() {
    let mut network = Network::new(vec![1.0; 2]).unwrap();
    for wrong in [
        Buckling { j: 2, ..STRIP },
        Buckling { j: 0, ..STRIP },
        Buckling { rest_length: 0.0, ..STRIP },
        Buckling { bending: 0.0, ..STRIP },
        Buckling { bending: f64::NAN, ..STRIP },
        Buckling { compression: f64::INFINITY, ..STRIP },
        Buckling { tension: -1.0, ..STRIP },
        Buckling { damping: -1.0, ..STRIP },
    ] {
        assert!(network.add_buckling(wrong).is_err(), "{wrong:?}");
    }
    let weak = Buckling { compression: 1.0, ..STRIP };
    let error = network.add_buckling(weak).unwrap_err().to_string();
    assert!(error.contains("at least 23.01"), "{error}");
    assert_eq!(network.buckling().count(), 0);
    // The weakest strip that can buckle: where the ends meet, it pushes equally straight and bent.
    let least = 4.0 * std::f64::consts::PI.powi(2) * 0.2 / 0.343;
    let weakest = Buckling { compression: least * (1.0 + 1e-12), ..STRIP };
    network.add_buckling(weakest).unwrap();
    assert!(pull(weakest, 1e-9).is_finite());
}
