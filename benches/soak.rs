//! Long runs: `cargo bench --bench soak` takes 1e7 steps by every method, with wind and swing if
//! the method supports them, and fails if a number is not finite or memory grows. It takes hours;
//! `cargo bench --bench soak -- verlet rk4` takes the steps of these methods only.

use std::time::Instant;

use a3_core::integrators::METHODS;
use a3_core::{Method, Simulation};
use a3_scenes::Description;

/// Steps of a run, and of one with `--test`.
const STEPS: [u64; 2] = [10_000_000, 2_000];

/// Largest growth of memory after the first tenth of a run (bytes).
const GROWTH: usize = 1 << 20;

/// Small cloth with everything that a run can have: wind, swing, a moving sphere, friction, a
/// floor.
const SCENE: &str = r#"
    gravity = [0, -9.81, 0]
    drag_per_mass = 0.3
    swing = { amplitude = [0, 0, 0.2], rate = 3 }
    floor = { height = -2, friction = 0.2 }
    [[cloth]]
    grid = [3, 3]
    width = 1
    mass = 0.1
    stiffness = [40, 20, 5]
    pin = [{ at = ["top-left", "top-right"] }]
    [[sphere]]
    center = [0.2, -0.9, 0.3]
    radius = 0.3
    friction = 0.2
    sine = { amplitude = [0, 0, 0.5], rate = 2 }
"#;

/// Resident memory of this process (bytes), if the system reports it.
fn memory() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: usize = pages.split(' ').nth(1)?.parse().ok()?;
    Some(pages * 4096)
}

/// Runs a method for a number of steps. Returns the growth of memory (bytes).
fn soak(method: &'static Method, steps: u64) -> Option<usize> {
    let wind = "[wind]\nvelocity = [3, 0, 1]\n";
    let text = match (method.positions_only(), method.is_adaptive()) {
        (false, _) => format!("{SCENE}{wind}"),
        (true, false) => SCENE.to_owned(),
        // Friction makes the steps of such a method rough.
        (true, true) => SCENE.replace("friction = 0.2", "friction = 0"),
    };
    let entry = a3_scenes::find("simple").filter(|_| method.plain_only());
    let setup = match entry {
        Some(plain) => plain.build(None).expect("a scene that is built in"),
        None => Description::parse(&text)
            .and_then(|scene| scene.build(None, &mut |_| unreachable!("no file is named")))
            .expect("the scene of this benchmark"),
    };
    let control = setup.defaults.control_of(method);
    let mut run = Simulation::new(setup.scene, method, control).expect("a method that serves it");
    run.set_wind(true);
    run.set_swinging(true);
    let mut before = None;
    for tenth in 0..10 {
        run.take_steps(steps / 10).unwrap_or_else(|why| panic!("{}: {why}", method.name));
        assert!(run.state().iter().all(|y| y.is_finite()), "{}", method.name);
        assert_eq!(run.gained(), None, "{}", method.name);
        if tenth == 0 {
            before = memory();
        }
    }
    Some(memory()?.saturating_sub(before?))
}

fn main() {
    let is_test = std::env::args().any(|word| word == "--test");
    let steps = STEPS[usize::from(is_test)];
    let asked: Vec<String> =
        std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for method in METHODS {
        if !asked.is_empty() && !asked.iter().any(|name| name == method.name) {
            continue;
        }
        let begun = Instant::now();
        let growth = soak(method, steps);
        assert!(growth.is_none_or(|growth| growth < GROWTH), "{}: {growth:?} bytes", method.name);
        println!(
            "{:>14}: {steps} steps in {:.1} s, memory grew by {} KiB",
            method.name,
            begun.elapsed().as_secs_f64(),
            growth.map_or("?".into(), |growth| (growth / 1024).to_string())
        );
    }
}
