//! Rigid bodies that fall, bounce, slide, roll and rest have the same bits in all units of length,
//! mass and time that differ by powers of two.

use a3_core::{Control, Method, Simulation, integrators};
use a3_scenes::Setup;

use crate::bodies;
use crate::told;

/// Default number of scenes, each run by one method. `A3_SCENES` sets another, and `A3_FIRST` the
/// first.
const SCENES: usize = 80;

/// Parts of m, kg and s in other units.
const UNITS: [[f64; 3]; 4] =
    [[1024.0, 1.0, 1.0], [1.0, 1024.0, 1.0], [1.0, 1.0, 1024.0], [32.0, 0.0625, 1.0]];

/// Number of steps, and time where a method has a tolerance (s).
const STEPS: u64 = 200;
const TIME: f64 = 0.5;

fn build(seed: usize, units: [f64; 3]) -> Setup {
    let text = toml::to_string(&bodies::scene(seed as u64, units)).unwrap();
    crate::build(&text).unwrap().unwrap()
}

/// Returns the end of a run whose unit of time is this part of a second, as far as it gets.
fn run(setup: &Setup, method: &'static Method, s: f64) -> Option<Vec<f64>> {
    let control = match method.default_control {
        Control::Step(h) => Control::Step(h * s),
        tolerance @ Control::Tolerance(_) => tolerance,
    };
    let mut run = Simulation::new(setup.scene.clone(), method, control).ok()?;
    // A blow-up ends both runs.
    let _ = match control {
        Control::Step(_) => run.take_steps(STEPS),
        Control::Tolerance(_) => run.advance_to(TIME),
    };
    Some(run.state().to_vec())
}

/// Returns a state in these units.
fn converted(state: &[f64], n: usize, [m, kg, s]: [f64; 3]) -> Vec<f64> {
    let unit = |i: usize| match i {
        i if i < 3 * n => m,
        i if i < 6 * n => m / s,
        i if (i - 6 * n) % 7 < 4 => 1.0,
        _ => kg * m * m / s,
    };
    state.iter().enumerate().map(|(i, y)| y * unit(i)).collect()
}

#[test]
fn bodies_move_alike_in_all_units() {
    let (count, first) = (told("A3_SCENES", SCENES), told("A3_FIRST", 0));
    // Solutions of linear systems end at the errors of quantities with different units.
    let methods = integrators::METHODS.iter();
    let methods: Vec<_> = methods.filter(|it| !it.solves_linear_systems()).collect();
    let (mut faults, mut runs) = (vec![], 0);
    for seed in first..first + count {
        let (setup, method) = (build(seed, [1.0; 3]), methods[seed % methods.len()]);
        let Some(own) = run(&setup, method, 1.0) else {
            continue;
        };
        let n = setup.scene.model.particles();
        for units in UNITS {
            // The first step of a method with a tolerance is at most 0.01 s.
            if units[2] != 1.0 && method.default_control.tolerance().is_some() {
                continue;
            }
            runs += 1;
            let other = run(&build(seed, units), method, units[2]);
            if other.is_none_or(|other| other != converted(&own, n, units)) {
                faults.push(format!("scene {seed}, {}, {units:?}", method.name));
            }
        }
    }
    assert!(runs > 2 * count, "{runs} runs");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
