//! Implicit methods on large systems of plain numbers: Jacobians from few differences, and sparse
//! factors.

use std::f64::consts::PI;

use crate::common::method;
use a3_core::integrators::Tolerance;
use a3_core::{Control, Error, Ode, ParticleSystem, Refusal, Scene, Simulation, Work};

/// Runs an adaptive method from y at 0 s to a time (s). Returns the state there, the number of
/// steps and the work.
fn run(
    name: &str,
    system: &dyn ParticleSystem,
    until: f64,
    mut y: Vec<f64>,
    relative: f64,
) -> Result<(Vec<f64>, u32, Work), Error> {
    let tolerance = Tolerance::new(relative).unwrap();
    let mut adaptive = method(name).adaptive(system, tolerance).unwrap();
    let (mut t, mut steps, mut work) = (0.0, 0, Work::default());
    while t < until {
        let taken = adaptive.advance(system, t, until - t, &mut y)?;
        (t, steps) = (t + taken.h, steps + 1);
        work += taken.work;
    }
    Ok((y, steps, work))
}

/// Returns the second difference of a field that is 0 at both ends.
fn bend(y: &[f64], k: usize) -> f64 {
    let at = |k: Option<usize>| k.and_then(|k| y.get(k)).copied().unwrap_or_default();
    at(k.checked_sub(1)) - 2.0 * y[k] + at(Some(k + 1))
}

/// Heat in a rod of 2,000 numbers: each sine decays at its own rate, -4 n^2 sin^2(m pi / 2 n) / s
/// for m half waves, of up to 1.6e7 / s. Explicit methods would take three million steps.
#[test]
fn heat_in_a_long_rod_decays_as_its_sines_do() {
    const N: usize = 2000;
    let n = N as f64 + 1.0;
    let rod = Ode::new(N, move |_: f64, y: &[f64], dydt: &mut [f64]| {
        for (k, rate) in dydt.iter_mut().enumerate() {
            *rate = n * n * bend(y, k);
        }
    })
    .unwrap();
    let sine = |m: f64, k: usize| (m * PI * (k as f64 + 1.0) / n).sin();
    let start: Vec<_> = (0..N).map(|k| sine(1.0, k) + 0.5 * sine(7.0, k)).collect();
    let left = |m: f64| (-4.0 * n * n * (m * PI / (2.0 * n)).sin().powi(2) * 0.1).exp();
    for name in ["bdf", "radau"] {
        let (y, steps, work) = run(name, &rod, 0.1, start.clone(), 1e-6).unwrap();
        let exact = |k| left(1.0) * sine(1.0, k) + 0.5 * left(7.0) * sine(7.0, k);
        let errors = y.iter().enumerate().map(|(k, y)| (y - exact(k)).abs());
        let error = errors.fold(0.0, f64::max);
        println!("{name}: {error:.1e}, {steps} steps, {work:?}");
        assert!(error < 2e-5, "{name}: {error}");
        assert!(work.evaluations < 20 * u64::from(steps), "{name}: {work:?}");
    }
}

/// Brusselator of two fields in a row (Hairer, Wanner, *Solving Ordinary Differential Equations
/// II*, 1996, IV.10), with as many numbers each.
fn brusselator(count: usize) -> (Ode, Vec<f64>) {
    let n = count as f64 + 1.0;
    let strength = n * n / 50.0;
    let f = move |_: f64, y: &[f64], dydt: &mut [f64]| {
        let (u, v) = y.split_at(count);
        let (du, dv) = dydt.split_at_mut(count);
        for k in 0..count {
            // 1 and 3 at the ends.
            let ends = f64::from(u8::from(k == 0)) + f64::from(u8::from(k + 1 == count));
            let react = u[k] * u[k] * v[k];
            du[k] = 1.0 + react - 4.0 * u[k] + strength * (bend(u, k) + ends);
            dv[k] = 3.0 * u[k] - react + strength * (bend(v, k) + 3.0 * ends);
        }
    };
    let places = (1..=count).map(|k| k as f64 / n);
    let u = places.map(|x| 1.0 + (2.0 * PI * x).sin());
    let state = u.chain((0..count).map(|_| 3.0)).collect();
    (Ode::new(2 * count, f).unwrap(), state)
}

/// Two families agree, on 500 and on 2,000 numbers, and a number more on the way costs no more
/// evaluations.
#[test]
fn brusselators_cost_few_evaluations_whatever_their_size() {
    let mut counts = vec![];
    for count in [250, 1000] {
        let (system, start) = brusselator(count);
        let [bdf, radau] = ["bdf", "radau"].map(|name| {
            let (y, steps, work) = run(name, &system, 10.0, start.clone(), 1e-6).unwrap();
            println!("{name} {count}: {steps} steps, {work:?}");
            assert!(work.evaluations < 20 * u64::from(steps));
            counts.push(work.evaluations);
            y
        });
        let apart = bdf.iter().zip(&radau).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 2e-4, "{apart}");
    }
    let [bdf, radau, ..] = counts[..] else {
        panic!("four runs");
    };
    assert!(counts[2] < bdf * 3 / 2 && counts[3] < radau * 3 / 2, "{counts:?}");
}

/// A number that begins to act on a distant one, after the pattern was found, is found too: the
/// first is a clock, and past 0.5 the last number and the middle one, which decays, become one.
#[test]
fn numbers_that_begin_to_act_later_are_found() {
    const N: usize = 64;
    let system = Ode::new(N, |_: f64, y: &[f64], dydt: &mut [f64]| {
        for (rate, y) in dydt.iter_mut().zip(y) {
            *rate = -1e4 * (y - 1.0);
        }
        dydt[0] = 1.0;
        dydt[N / 2] = -y[N / 2];
        if y[0] > 0.5 {
            dydt[N - 1] = 1e6 * (y[N / 2] - y[N - 1]);
            dydt[N / 2] -= dydt[N - 1];
        }
    })
    .unwrap();
    let mut start = vec![0.0; N];
    start[N / 2] = 2.0;
    for name in ["bdf", "radau"] {
        let (y, steps, work) = run(name, &system, 1.0, start.clone(), 1e-6).unwrap();
        // Half of their mean decays from then on.
        let mean = 0.5 * (2.0 * (-0.5_f64).exp() + 1.0);
        let followed = mean * (-0.25_f64).exp();
        println!("{name}: {steps} steps, {work:?}");
        assert!((y[N - 1] - followed).abs() < 1e-4, "{name}: {}", y[N - 1]);
        assert!(steps < 1000 && work.evaluations < 10_000, "{name}: {steps}, {work:?}");
    }
}

/// Implicit methods refuse a system of more than 1,024 numbers where each acts on all, also in
/// fixed steps.
#[test]
fn large_full_systems_are_refused() {
    let system = Ode::new(1500, |_: f64, y: &[f64], dydt: &mut [f64]| {
        let mean = y.iter().sum::<f64>() / 1500.0;
        for (rate, y) in dydt.iter_mut().zip(y) {
            *rate = mean - y;
        }
    })
    .unwrap();
    let is_refusal = |error: &Error| {
        matches!(
            error,
            Error::Unsupported { why: Refusal::TooDense { numbers: 1500, most: 1024 }, .. }
        )
    };
    let start: Vec<_> = (0..1500).map(f64::from).collect();
    for name in ["bdf", "radau"] {
        let refused = run(name, &system, 1.0, start.clone(), 1e-6).unwrap_err();
        assert!(is_refusal(&refused), "{name}: {refused}");
    }
    for name in ["implicit", "implicit-midpoint", "tr-bdf2", "radau"] {
        let mut fixed = method(name).integrator(&system).unwrap();
        let mut y = start.clone();
        let refused = fixed.step(&system, 0.0, 0.1, &mut y).unwrap_err();
        assert!(is_refusal(&refused), "{name}: {refused}");
    }
}

/// Stiff numbers of 1e-9 beside others of 1e9, and a change of all units: as many evaluations, and
/// the same numbers to the tolerance.
#[test]
fn units_change_nothing() {
    let system = |unit: f64| {
        let f = move |_: f64, y: &[f64], dydt: &mut [f64]| {
            let [a, b, c] = [y[0] / unit, y[1] / unit, y[2] / unit];
            let [slow, fast, end] = [0.04 * a, 1e4 * b * c, 3e7 * b * b];
            dydt[0] = (fast - slow) * unit;
            dydt[1] = (slow - fast - end) * unit;
            dydt[2] = end * unit;
        };
        Ode::new(3, f).unwrap()
    };
    for name in ["bdf", "radau"] {
        let runs = [1.0, 1e-9, 1e9].map(|unit| {
            let system = system(unit).with_scales(vec![1e-8 * unit; 3]).unwrap();
            run(name, &system, 1e4, vec![unit, 0.0, 0.0], 1e-4).unwrap()
        });
        let counts = runs.each_ref().map(|(_, _, work)| work.evaluations);
        println!("{name}: {counts:?}");
        for ((y, ..), unit) in runs.iter().zip([1.0, 1e-9, 1e9]) {
            for (k, y) in y.iter().enumerate() {
                let apart = (y / unit - runs[0].0[k]).abs() / runs[0].0[k];
                assert!(apart < 1e-3, "{name} {unit} {k}: {apart}");
            }
        }
        assert!(
            counts.iter().all(|count| count.abs_diff(counts[0]) * 20 < counts[0]),
            "{counts:?}"
        );
    }
}

/// Neighbours in a rod whose numbers are mixed up are found, as are one number that all act on, and
/// numbers on which none acts.
#[test]
fn any_sparse_pattern_serves() {
    const N: usize = 1500;
    let mut number: Vec<_> = (0..N).collect();
    number.sort_by_key(|k| k * k * 2_654_435_761 % 65_521);
    let mut places = vec![0; N];
    (0..N).for_each(|p| places[number[p]] = p);
    let start = places.iter().map(|p| PI * (*p as f64 + 1.0) / (N as f64 + 1.0));
    let start: Vec<_> = start.map(f64::sin).collect();
    let rod = Ode::new(N, move |_: f64, y: &[f64], dydt: &mut [f64]| {
        for (k, rate) in dydt.iter_mut().enumerate() {
            let at = |p: Option<usize>| p.and_then(|p| number.get(p)).map_or(0.0, |k| y[*k]);
            let sides = at(places[k].checked_sub(1)) + at(Some(places[k] + 1));
            *rate = 1e4 * (sides - 2.0 * y[k]);
        }
    })
    .unwrap();
    let rate = -4e4 * (PI / (2.0 * (N as f64 + 1.0))).sin().powi(2);
    let drive = |_: f64, _: &[f64], dydt: &mut [f64]| dydt.fill(2.0);
    let ground = |_: f64, y: &[f64], dydt: &mut [f64]| {
        for (rate, y) in dydt.iter_mut().zip(y) {
            *rate = -1e3 * y;
        }
        dydt[7] -= y.iter().sum::<f64>();
    };
    for name in ["bdf", "radau"] {
        let (y, steps, work) = run(name, &rod, 10.0, start.clone(), 1e-6).unwrap();
        println!("{name}: {steps} steps, {work:?}");
        for (y, start) in y.iter().zip(&start) {
            assert!((y - (rate * 10.0).exp() * start).abs() < 1e-5, "{name}: {y}");
        }
        assert!(work.evaluations < 4 * N as u64, "{name}: {work:?}");
        let driven = Ode::new(N, drive).unwrap();
        let (y, _, work) = run(name, &driven, 3.0, vec![0.0; N], 1e-6).unwrap();
        assert!((y[7] - 6.0).abs() < 1e-9 && work.evaluations < 300, "{work:?}");
        let grounded = Ode::new(N, ground).unwrap();
        let (y, ..) = run(name, &grounded, 0.01, vec![1.0; N], 1e-6).unwrap();
        // All others are y = exp(-1000 t): y7' = -1001 y7 - 1499 y.
        let all = (-10.0_f64).exp();
        let grounded = all * (1500.0 * (-0.01_f64).exp() - 1499.0);
        assert!((y[7] - grounded).abs() < 2e-5, "{name}: {} {grounded}", y[7]);
    }
}

/// Numbers that underflow as they decay, that are zero at first, or at the edge of the domain of f.
#[test]
fn differences_are_taken_of_any_number() {
    let decay = Ode::new(2, |t: f64, y: &[f64], dydt: &mut [f64]| {
        dydt.copy_from_slice(&[-1e3 * y[0], t.cos() - y[1]]);
    })
    .unwrap();
    let edge = Ode::new(1, |_: f64, y: &[f64], dydt: &mut [f64]| {
        dydt[0] = -y[0] + (1.0 - y[0]).sqrt();
    })
    .unwrap();
    for name in ["implicit", "implicit-midpoint", "tr-bdf2"] {
        let mut fixed = method(name).integrator(&decay).unwrap();
        let mut y = [1.0, 1.0];
        for k in 0..2500 {
            fixed.step(&decay, 0.01 * f64::from(k), 0.01, &mut y).unwrap();
        }
        assert!(y.iter().all(|y| y.is_finite()), "{name}: {y:?}");
        let mut fixed = method(name).integrator(&edge).unwrap();
        fixed.step(&edge, 0.0, 0.01, &mut [1.0]).unwrap();
    }
    for name in ["bdf", "radau"] {
        let (y, ..) = run(name, &decay, 20.0, vec![1.0, 1e-320], 1e-6).unwrap();
        let exact = 0.5 * (20.0_f64.sin() + 20.0_f64.cos() - (-20.0_f64).exp());
        assert!((y[1] - exact).abs() < 1e-4, "{name}: {y:?}");
        let (y, ..) = run(name, &edge, 20.0, vec![1.0], 1e-6).unwrap();
        // Where y = sqrt(1 - y).
        assert!((y[0] - 0.5 * (5.0_f64.sqrt() - 1.0)).abs() < 1e-5, "{name}: {y:?}");
    }
}

/// A run that is resumed after its pattern has grown goes on to the same bits.
#[test]
fn resumed_runs_keep_their_pattern() {
    const N: usize = 40;
    let scene = || {
        let f = |t: f64, y: &[f64], dydt: &mut [f64]| {
            for (k, rate) in dydt.iter_mut().enumerate() {
                // Numbers that are large push their neighbours.
                let pushes = |other: usize| (y[other] - 0.5).max(0.0);
                *rate = 50.0 * (pushes((k + 1) % N) - pushes(k)) + (t + k as f64).sin() - y[k];
            }
        };
        let state = (0..N).map(|k| 0.02 * k as f64).collect();
        Scene::new("pushes", Ode::new(N, f).unwrap(), state)
    };
    for name in ["bdf", "radau"] {
        let tolerance = Control::Tolerance(1e-5);
        let mut whole = Simulation::new(scene(), method(name), tolerance).unwrap();
        whole.advance_to(1.35).unwrap();
        let kept = whole.checkpoint();
        let mut resumed = Simulation::new(scene(), method(name), tolerance).unwrap();
        resumed.restore(&kept).unwrap();
        for run in [&mut whole, &mut resumed] {
            run.advance_to(4.0).unwrap();
        }
        assert_eq!(whole.state(), resumed.state(), "{name}");
        assert_eq!(whole.steps(), resumed.steps(), "{name}");
        assert_eq!(whole.work(), resumed.work(), "{name}");
    }
}

/// A pattern that is given spares the search for it, and entries spare differences. Entries that a
/// pattern misses are found.
#[test]
fn patterns_and_entries_may_be_given() {
    const N: u32 = 1500;
    let rod = || {
        let f = |_: f64, y: &[f64], dydt: &mut [f64]| {
            for (k, rate) in dydt.iter_mut().enumerate() {
                *rate = 1e3 * bend(y, k);
            }
        };
        Ode::new(N as usize, f).unwrap()
    };
    let band = || (0..N).flat_map(|i| (i.saturating_sub(1)..(i + 2).min(N)).map(move |j| (i, j)));
    let systems = [
        rod(),
        rod().with_sparsity(band().collect()).unwrap(),
        rod().with_jacobian_entries(move |_t, _y, entries: &mut Vec<(u32, u32, f64)>| {
            let value = |i, j| if i == j { -2e3 } else { 1e3 };
            entries.extend(band().map(|(i, j)| (i, j, value(i, j))));
        }),
        rod().with_sparsity((0..N).map(|i| (i, i)).collect()).unwrap(),
    ];
    let start: Vec<_> = (0..N).map(|k| (0.01 * f64::from(k)).sin()).collect();
    for name in ["bdf", "radau"] {
        let runs = systems.each_ref().map(|system| {
            let (y, _, work) = run(name, system, 1.0, start.clone(), 1e-6).unwrap();
            (y, work.evaluations)
        });
        let calls = runs.each_ref().map(|(_, calls)| *calls);
        println!("{name}: {calls:?}");
        assert!(calls[1] < calls[0] && calls[2] < calls[1] && calls[3] > calls[1]);
        for (y, _) in &runs[1..] {
            let apart = y.iter().zip(&runs[0].0).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-5, "{name}");
        }
    }
    // A matrix that is zero at the start has a pattern all the same.
    let from_rest = |_: f64, y: &[f64], dydt: &mut [f64]| {
        for (rate, y) in dydt.iter_mut().zip(y) {
            *rate = 1.0 - 50.0 * y * y;
        }
    };
    let entries = |_: f64, y: &[f64], out: &mut Vec<(u32, u32, f64)>| {
        let diagonal = (0..N).zip(y).filter(|(_, y)| **y != 0.0);
        out.extend(diagonal.map(|(k, y)| (k, k, -100.0 * y)));
    };
    let system = Ode::new(N as usize, from_rest).unwrap();
    let system = system.with_jacobian_entries(entries);
    let (y, _, work) = run("radau", &system, 1.0, vec![0.0; N as usize], 1e-6).unwrap();
    assert!((y[0] - 50f64.sqrt().recip()).abs() < 1e-6 && work.evaluations < 500);
    let outside = rod().with_sparsity(vec![(0, N)]);
    let words = outside.err().unwrap().to_string();
    assert!(words.contains("no row 0 and column 1500"), "{words}");
}
