//! Systems with a mass matrix, M y' = f(t, y), also a singular one, against closed forms and
//! published values.

use std::f64::consts::PI;

use crate::common::method;
use a3_core::accuracy::{Frames, Metric, Reference, choose};
use a3_core::integrators::{METHODS, Tolerance};
use a3_core::{Control, Error, Ode, ParticleSystem, Refusal, Scene, Simulation, Work};

const SERVING: [&str; 2] = ["radau", "bdf"];

/// Runs a method to a tolerance from y at 0 s to a time (s). Returns the state there and the work.
fn run(
    name: &str,
    system: &dyn ParticleSystem,
    relative: f64,
    until: f64,
    mut y: Vec<f64>,
) -> Result<(Vec<f64>, Work), Error> {
    let tolerance = Tolerance::new(relative).unwrap();
    let mut adaptive = method(name).adaptive(system, tolerance).unwrap();
    let (mut t, mut work) = (0.0, Work::default());
    while t < until {
        let taken = adaptive.advance(system, t, until - t, &mut y)?;
        t += taken.h;
        work += taken.work;
    }
    Ok((y, work))
}

/// Checks each number of a state against its value, to a relative error.
fn close(what: &str, found: &[f64], values: &[f64], relative: f64) {
    println!("{what}: {found:?}");
    assert_eq!(found.len(), values.len());
    for (found, value) in found.iter().zip(values) {
        let miss = (found - value).abs();
        assert!(miss <= relative * value.abs(), "{what}: {found} {value}");
    }
}

fn reaction(y: &[f64], f: &mut [f64]) {
    let (slow, fast, end) = (0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]);
    f[0] = fast - slow;
    f[1] = slow - fast - end;
    f[2] = end;
}

/// Robertson's reaction, whose last equation says that nothing is lost.
fn robertson() -> Ode {
    let ode = Ode::new(3, |_, y, f| {
        reaction(y, f);
        f[2] = y[0] + y[1] + y[2] - 1.0;
    });
    let matrix = vec![(0, 0, 1.0), (1, 1, 1.0)];
    ode.unwrap().with_mass_matrix(matrix).unwrap()
}

/// Values of Hairer and Wanner (1996) at 40 s, and of the examples of SUNDIALS at 4e5 s.
#[test]
fn robertson_ends_where_published() {
    let ends = [(40.0, [0.715_82, 9.185_5e-6, 0.284_17]), (4e5, [4.939e-3, 1.985_2e-8, 0.995_06])];
    for name in SERVING {
        for (until, values) in ends {
            let (y, work) = run(name, &robertson(), 1e-8, until, vec![1.0, 0.0, 0.0]).unwrap();
            close(name, &y, &values, 5e-4);
            assert!((y.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{name}");
            let ode = Ode::new(3, |_, y, f: &mut [f64]| reaction(y, f)).unwrap();
            let (own, alone) = run(name, &ode, 1e-8, until, vec![1.0, 0.0, 0.0]).unwrap();
            close(name, &y, &own, 2e-4);
            // The conservation law costs nothing.
            let ratio = work.total() / alone.total();
            assert!((0.7..1.4).contains(&ratio), "{name}: {ratio}");
        }
    }
}

/// The period of a pendulum of 1 m that swings by 90 degrees is 2 pi / (sqrt(g) M), with the
/// arithmetic-geometric mean M of 1 and cos(45 degrees). At the bottom, the rod holds three times
/// the weight.
#[test]
fn a_pendulum_on_a_rod_has_its_period() {
    const G: f64 = 9.81;
    let pendulum = Ode::new(5, |_, y, f| {
        let [x, z, u, w, pull] = [y[0], y[1], y[2], y[3], y[4]];
        f[..4].copy_from_slice(&[u, w, -pull * x, -pull * z - G]);
        f[4] = u * u + w * w - G * z - pull * (x * x + z * z);
    });
    let matrix = (0..4).map(|k| (k, k, 1.0)).collect();
    let pendulum = pendulum.unwrap().with_mass_matrix(matrix).unwrap();
    let (mut a, mut b) = (1.0, 0.5_f64.sqrt());
    while a - b > 1e-15 {
        (a, b) = (f64::midpoint(a, b), f64::sqrt(a * b));
    }
    let period = 2.0 * PI / (G.sqrt() * a);
    for (name, most) in SERVING.into_iter().zip([1e-7, 1e-5]) {
        let start = vec![1.0, 0.0, 0.0, 0.0, 0.0];
        let (bottom, _) = run(name, &pendulum, 1e-9, 0.25 * period, start.clone()).unwrap();
        let speed = (2.0 * G).sqrt();
        for (y, value) in bottom.iter().zip([0.0, -1.0, -speed, 0.0, 3.0 * G]) {
            assert!((y - value).abs() < 30.0 * most, "{name}: {bottom:?}");
        }
        let (end, _) = run(name, &pendulum, 1e-9, period, start.clone()).unwrap();
        println!("{name}: {end:?}");
        for (y, value) in end.iter().zip(&start) {
            assert!((y - value).abs() < 30.0 * most, "{name}: {end:?}");
        }
    }
}

/// The transistor amplifier, whose matrix has no empty row, and the values of the test set of the
/// University of Bari for it, at 0.2 s.
#[test]
fn the_transistor_amplifier_ends_where_published() {
    let amplifier = Ode::new(8, |t: f64, y, f| {
        const R: f64 = 1.0 / 9000.0;
        let gate = |x: f64| 1e-6 * ((x / 0.026).exp() - 1.0);
        let (first, second) = (gate(y[1] - y[2]), gate(y[4] - y[5]));
        f[0] = (y[0] - 0.1 * (200.0 * PI * t).sin()) / 1000.0;
        f[1] = (2.0 * y[1] - 6.0) * R + 0.01 * first;
        f[2] = y[2] * R - first;
        f[3] = (y[3] - 6.0) * R + 0.99 * first;
        f[4] = (2.0 * y[4] - 6.0) * R + 0.01 * second;
        f[5] = y[5] * R - second;
        f[6] = (y[6] - 6.0) * R + 0.99 * second;
        f[7] = y[7] * R;
    });
    let mut matrix = vec![];
    for (k, [i, j]) in [[0, 1], [2, 2], [3, 4], [5, 5], [6, 7]].into_iter().enumerate() {
        let c = 1e-6 * (k + 1) as f64;
        matrix.extend([(i, i, -c), (j, j, -c)].iter().take((j - i + 1) as usize));
        if i != j {
            matrix.extend([(i, j, c), (j, i, c)]);
        }
    }
    let amplifier = amplifier.unwrap().with_mass_matrix(matrix).unwrap();
    let values = [
        -0.556_214_501_226_270_9e-2,
        0.300_652_247_190_304_2e1,
        0.284_995_878_860_812_8e1,
        0.292_642_253_620_624_1e1,
        0.270_461_786_501_055_4e1,
        0.276_183_777_839_314_5e1,
        0.477_092_763_161_677_2e1,
        0.123_699_586_809_154_8e1,
    ];
    let start = vec![0.0, 3.0, 3.0, 6.0, 3.0, 3.0, 6.0, 0.0];
    for name in SERVING {
        let (y, work) = run(name, &amplifier, 1e-8, 0.2, start.clone()).unwrap();
        println!("{work:?}");
        close(name, &y, &values, 2e-5);
    }
}

/// Heat in a rod by linear finite elements: sines decay by 6 (1 - c) / (h^2 (2 + c)), with the
/// cosine c of their phase from node to node. Small rods have full matrices, long ones sparse.
#[test]
fn heat_by_finite_elements_decays_as_its_sines_do() {
    for n in [9_usize, 400] {
        let h = 1.0 / (n as f64 + 1.0);
        let rod = Ode::new(n, move |_, y, f| {
            let at = |k: Option<usize>| k.and_then(|k| y.get(k)).copied().unwrap_or_default();
            for (k, f) in f.iter_mut().enumerate() {
                *f = (at(k.checked_sub(1)) - 2.0 * y[k] + at(Some(k + 1))) / h;
            }
        });
        let band = (0..n as u32).flat_map(|i| {
            let near = i.saturating_sub(1)..(i + 2).min(n as u32);
            near.map(move |j| (i, j, if i == j { 4.0 } else { 1.0 } * h / 6.0))
        });
        let rod = rod.unwrap().with_mass_matrix(band.collect()).unwrap();
        let sine = |m: f64| (1..=n).map(|k| (m * PI * h * k as f64).sin()).collect::<Vec<_>>();
        let left = |m: f64| {
            let c = (m * PI * h).cos();
            (-6.0 * (1.0 - c) / (h * h * (2.0 + c)) * 0.1).exp()
        };
        let add = |a: f64, b: f64| -> Vec<f64> {
            let both = sine(1.0).into_iter().zip(sine(5.0));
            both.map(|(x, y)| a * x + b * y).collect()
        };
        for name in SERVING {
            let (y, work) = run(name, &rod, 1e-7, 0.1, add(1.0, 0.5)).unwrap();
            let exact = add(left(1.0), 0.5 * left(5.0));
            let miss = y.iter().zip(exact).map(|(y, exact)| (y - exact).abs());
            let miss = miss.fold(0.0, f64::max);
            println!("{name}, {n}: {miss:.1e}, {work:?}");
            assert!(miss < 3e-6, "{name}: {miss}");
            assert!(work.evaluations < 3000, "{name}: {work:?}");
        }
    }
}

/// A regular matrix, and the system multiplied by its inverse.
#[test]
fn a_regular_matrix_is_its_inverse_on_the_other_side() {
    // M = [[2, 1], [1, 1]], with the inverse [[1, -1], [-1, 2]].
    let f = |t: f64, y: &[f64]| [-50.0 * y[0] + t.sin(), y[0] * y[1] - y[1]];
    let with = Ode::new(2, move |t, y, out| out.copy_from_slice(&f(t, y))).unwrap();
    let matrix = vec![(0, 0, 2.0), (0, 1, 0.5), (0, 1, 0.5), (1, 0, 1.0), (1, 1, 1.0)];
    let with = with.with_mass_matrix(matrix).unwrap();
    let without = Ode::new(2, move |t, y, out| {
        let [a, b] = f(t, y);
        out.copy_from_slice(&[a - b, 2.0 * b - a]);
    });
    let (exact, _) = run("dop853", &without.unwrap(), 1e-12, 3.0, vec![1.0, 2.0]).unwrap();
    for (name, most) in SERVING.into_iter().zip([1e-7, 1e-5]) {
        let (y, _) = run(name, &with, 1e-8, 3.0, vec![1.0, 2.0]).unwrap();
        close(name, &y, &exact, most);
    }
    // A matrix of ones on its diagonal is none.
    let plain = Ode::new(2, |_, y, out: &mut [f64]| out.copy_from_slice(y)).unwrap();
    let plain = plain.with_mass_matrix(vec![(0, 0, 1.0), (1, 1, 1.0)]).unwrap();
    assert!(plain.mass_matrix().is_empty());
}

/// y' = z - y with z = 1, and z = 2 from 1 s on: z jumps.
#[test]
fn numbers_without_a_derivative_begin_and_jump_where_their_equation_says() {
    let level = |t: f64| -> f64 { if t < 1.0 { 1.0 } else { 2.0 } };
    let system = Ode::new(2, move |t, y, f| {
        f[0] = y[1] - y[0];
        f[1] = y[1].powi(3) - level(t).powi(3);
    });
    let system = system.unwrap().with_mass_matrix(vec![(0, 0, 1.0)]).unwrap();
    let model = system.with_jumps(vec![1.0]).unwrap();
    // z is 1, not 0.7, at the start.
    let scene = Scene::new("level", model, vec![0.0, 0.7]);
    for (name, most) in SERVING.into_iter().zip([1e-7, 1e-5]) {
        let control = Control::Tolerance(1e-8);
        let mut run = Simulation::new(scene.clone(), method(name), control).unwrap();
        let after_one = 1.0 - f64::exp(-1.0);
        for (until, value) in [(0.5, 1.0 - f64::exp(-0.5)), (1.0, after_one)] {
            run.advance_to(until).unwrap();
            close(name, run.state(), &[value, 1.0], most);
        }
        run.advance_to(3.0).unwrap();
        let value = 2.0 + (after_one - 2.0) * f64::exp(-2.0);
        close(name, run.state(), &[value, 2.0], most);
        // Back to another state, which does not satisfy the equation either.
        run.set_state(&[0.0, 3.0], 4.0).unwrap();
        run.advance_to(5.0).unwrap();
        close(name, run.state(), &[2.0 * after_one, 2.0], most);
    }
}

/// A circle in which the place follows from the time alone has index 2; a square that is -1 has no
/// root.
#[test]
fn equations_that_determine_nothing_are_refused_in_a_line() {
    let make = |last: fn(f64, &[f64]) -> f64| {
        let ode = Ode::new(2, move |t, y, f| {
            f[0] = y[1];
            f[1] = last(t, y);
        });
        ode.unwrap().with_mass_matrix(vec![(0, 0, 1.0)]).unwrap()
    };
    for name in SERVING {
        let start = vec![0.0, 0.7];
        let told = |ode: &Ode| run(name, ode, 1e-6, 1.0, start.clone()).unwrap_err().to_string();
        let deep = told(&make(|t, y| y[0] - t.sin()));
        assert!(deep.contains("differentiate them until they do"), "{deep}");
        let none = told(&make(|_, y| y[1] * y[1] + 1.0));
        assert!(none.contains("hold nowhere near the state"), "{none}");
    }
    let ode = || Ode::new(2, |_, y, f: &mut [f64]| f.copy_from_slice(y)).unwrap();
    let wrongs = [vec![], vec![(0, 2, 1.0)], vec![(1, 0, f64::NAN)]];
    let told = wrongs.map(|wrong| ode().with_mass_matrix(wrong).err().unwrap().to_string());
    assert!(told[0].contains("the mass matrix is 0"), "{told:?}");
    assert!(told[1].contains("no row 0 and column 2"), "{told:?}");
    assert!(told[2].contains("NaN in row 1 and column 0"), "{told:?}");
}

#[test]
fn other_methods_refuse_a_mass_matrix() {
    let system = robertson();
    for method in METHODS {
        let refused = method.refusal(&system) == Some(Refusal::HasMassMatrix);
        assert_eq!(refused, !SERVING.contains(&method.name), "{}", method.name);
    }
    let decay = Ode::new(2, |_, y, f: &mut [f64]| {
        f[0] = -y[0];
        f[1] = y[0] + y[1] - 1.0;
    });
    let decay = decay.unwrap().with_mass_matrix(vec![(0, 0, 1.0)]).unwrap();
    let end = |name: &str| {
        let mut fixed = method(name).integrator(&decay).unwrap();
        let mut y = [1.0, 0.0];
        for k in 0..10 {
            fixed.step(&decay, 0.1 * f64::from(k), 0.1, &mut y)?;
        }
        Ok::<_, Error>(y)
    };
    let left = f64::exp(-1.0);
    close("radau", &end("radau").unwrap(), &[left, 1.0 - left], 1e-8);
    // Its steps of a given length are those of TR-BDF2.
    let refused = end("bdf").unwrap_err().to_string();
    assert!(refused.contains("M y' = f(t, y)"), "{refused}");
}

#[test]
fn a_choice_has_a_reference_and_the_methods_that_serve() {
    let scene = Scene::new("robertson", robertson(), vec![1.0, 0.0, 0.0]);
    let frames = Frames::of(&scene.model, 40.0);
    let go_on = || true;
    let reference = Reference::finest(&scene, frames, &go_on).unwrap().unwrap();
    assert!(reference.is_stiff);
    assert!(reference.floor.state < 1e-8, "{:?}", reference.floor);
    let found = choose(&scene, &reference, Metric::State, 1e-5, &go_on, |_| {});
    let mut names: Vec<_> = found.unwrap().unwrap().iter().map(|c| c.method.name).collect();
    names.sort_unstable();
    assert_eq!(names, ["bdf", "radau"]);
}
