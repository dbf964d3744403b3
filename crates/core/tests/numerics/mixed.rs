//! Limits at rest where drag over mass and the damping of springs differ between places, so that
//! undamped modes are not the modes of the motion. The limits are compared with runs of the scene,
//! disturbed in all directions, just below and just above them.

use std::fmt::Write;

use crate::common::{described, method, on_all_cores};
use a3_core::stability::{rest, tenfold_time};
use a3_core::{Control, Scene, Simulation};

/// Two particles on a string, of which the lower one has a twentieth of the mass and strong drag.
const HEAVY_DRAG: &str = "
    gravity = [0, -9.81, 0]
    drag = 5
    springs = [[0, 1, 100, 0.5, 0], [1, 2, 100, 0.5, 0]]
    [particles]
    positions = [[0, 0, 0], [0, -0.5, 0], [0, -1, 0]]
    masses = [1, 1, 0.05]
    pin = [{ particles = [0] }]
";

/// Numbers between 0 and 1 from a seed.
pub struct Numbers(pub u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005))
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Net that hangs from three pins: masses over three decades, stiffness over two, and drag, damped
/// springs or both, in metres or in other units.
pub fn net(seed: u64) -> Scene {
    let mut numbers = Numbers(seed.wrapping_mul(77_777) + 1);
    for _ in 0..8 {
        numbers.next();
    }
    let unit = [1.0, 1e-3, 1e3][seed as usize % 3];
    let n = 6 + seed as usize % 5;
    let places: Vec<_> = (0..n)
        .map(|i| {
            let height = -0.4 * (i / 3) as f64;
            let angle = 2.1 * i as f64 + numbers.between(-0.4, 0.4);
            [angle.cos(), height + numbers.between(-0.1, 0.1), angle.sin()]
        })
        .collect();
    let (mut positions, mut masses, mut springs) = (String::new(), String::new(), String::new());
    for [x, y, z] in &places {
        let _ = write!(positions, "[{}, {}, {}], ", unit * x, unit * y, unit * z);
        let _ = write!(masses, "{}, ", 10f64.powf(numbers.between(-2.0, 1.0)));
    }
    for j in 3..n {
        for i in j.saturating_sub(4)..j {
            let apart = places[i].iter().zip(places[j]);
            let length = apart.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            let stiffness = 10f64.powf(numbers.between(1.5, 3.5));
            let damped = !seed.is_multiple_of(4) && numbers.next() < 0.5;
            let damping =
                f64::from(u8::from(damped)) * stiffness * 10f64.powf(numbers.between(-3.0, -1.0));
            let rest = 0.9 * unit * length;
            let _ = write!(springs, "[{i}, {j}, {stiffness}, {rest}, {damping}], ");
        }
    }
    let drag = if seed % 4 == 1 { 0.0 } else { 10f64.powf(numbers.between(0.0, 1.0)) };
    described(&format!(
        "gravity = [0, {}, 0]
        drag = {drag}
        springs = [{springs}]
        [particles]
        positions = [{positions}]
        masses = [{masses}]
        pin = [{{ particles = [0, 1, 2] }}]",
        -9.81 * unit
    ))
}

/// Growth of a disturbance in all directions from the middle to the end of a run in steps of h (s),
/// by the largest speed of the particles times the roots of their masses.
fn growth(still: &Scene, name: &str, h: f64) -> f64 {
    let network = still.model.network().unwrap();
    let (n, half) = (network.particles(), still.state.len() / 2);
    let mut nudged = still.clone();
    let mut numbers = Numbers(9);
    let size = 1e-7 * still.state[..half].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for k in (0..half).filter(|k| !network.is_pinned(k % n)) {
        nudged.state[half + k] = size * numbers.between(-1.0, 1.0) / network.masses()[k % n].sqrt();
    }
    let start = |scene: &Scene| Simulation::new(scene.clone(), method(name), Control::Step(h));
    let (mut run, mut beside) = (start(&nudged).unwrap(), start(still).unwrap());
    let steps = (tenfold_time(h) / h).ceil() as u64;
    let mut largest = [f64::MIN_POSITIVE; 2];
    for k in 0..steps {
        if run.take_steps(1).is_err() || beside.take_steps(1).is_err() {
            return f64::INFINITY;
        }
        let speeds = run.state()[half..].iter().zip(&beside.state()[half..]).enumerate();
        let speed = speeds.fold(0.0, |most: f64, (k, (a, b))| {
            most.max((a - b).abs() * network.masses()[k % n].sqrt())
        });
        // Before it ends in a bounded motion, as damped springs may.
        if speed > 1e2 * size {
            return f64::INFINITY;
        }
        let part = (2 * k / steps) as usize;
        if k % (steps / 2) > steps / 3 {
            largest[part] = largest[part].max(speed);
        }
    }
    largest[1] / largest[0].max(1e-7 * size)
}

#[test]
fn limits_at_rest_hold_where_damping_mixes_modes() {
    let scenes: Vec<_> = (0..10).map(net).chain([described(HEAVY_DRAG)]).collect();
    on_all_cores(scenes.into_iter().enumerate(), |(seed, scene)| {
        let rest = rest(&scene, || true).unwrap().unwrap();
        for name in
            ["euler", "trapezoid", "rk4", "dopri5", "symplectic", "verlet", "pefrl", "dprkn86"]
        {
            let Ok(limit) = rest.largest_step(method(name)) else {
                // Springs are damped.
                continue;
            };
            let limit = limit.unwrap();
            if limit.step.is_infinite() || !limit.is_sharp() {
                continue;
            }
            let grown = |part: f64| growth(&rest.scene, name, part * limit.step);
            let below = grown(0.97);
            // A method of several kicks may be stable again at slightly longer steps.
            let above = [1.03, 1.01, 1.005].map(grown).into_iter().fold(0.0, f64::max);
            assert!(below < 2.0 && above > 2.0, "net {seed}, {name}: {below} {above} {limit:?}");
        }
    });
}

/// Heun's method by the eigenvalues of the motion: the lower particle's drag over mass is 100 per
/// second, and its upright motion has the eigenvalue -99.8.
#[test]
fn the_limit_of_a_dragged_particle() {
    let rest = rest(&described(HEAVY_DRAG), || true).unwrap().unwrap();
    let limit = rest.largest_step(method("trapezoid")).unwrap().unwrap();
    assert!((limit.bounded - 0.020_04).abs() < 1e-5, "{limit:?}");
}
