//! The table of scenes: numbers of particles and springs, and every scene with every method.

use crate::common::{described, on_all_cores, scene, scene_with_grid, takes_minutes};
use a3_core::{Control, Grid, MAX_PARTICLES, Simulation, SpringKind, integrators};

#[test]
fn cloth_springs_are_counted_by_kind() {
    for (rows, cols) in [(15, 15), (8, 8), (2, 2), (2, 5), (7, 3), (12, 30)] {
        for name in ["cloth", "mit"] {
            let scene = scene_with_grid(name, rows, cols);
            let network = scene.model.network().unwrap();
            let count = |kind| network.springs().filter(|s| s.kind == kind).count();
            assert_eq!(count(SpringKind::Structural), rows * (cols - 1) + cols * (rows - 1));
            assert_eq!(count(SpringKind::Shear), 2 * (rows - 1) * (cols - 1));
            assert_eq!(count(SpringKind::Bend), rows * (cols - 2) + cols * (rows - 2));
        }
    }
    assert_eq!(scene("mit").model.network().unwrap().springs().count(), 1202);
}

/// A cloth that cannot be stepped in sweeps over its rows is half as fast.
#[test]
fn scenes_of_cloth_alone_have_rows() {
    let two = "[[cloth]]
        grid = [4, 5]
        width = 1
        mass = 0.01
        stiffness = [20, 10, 5]
        [[cloth]]
        grid = [6, 3]
        width = 1
        mass = 0.01
        stiffness = [20, 10, 5]
        at = [0, 0, 1]";
    for (scene, patches) in [(scene("cloth"), 1), (scene("mit"), 1), (described(two), 2)] {
        assert!(scene.model.system().rows().is_some());
        assert_eq!(scene.model.network().unwrap().sheets().count(), patches);
    }
}

/// Springs connect the right particles: structural ones neighbours, shear ones diagonals, and bend
/// ones the particles next but one.
#[test]
fn cloth_springs_join_the_right_particles() {
    let (rows, cols) = (4, 6);
    let scene = scene_with_grid("mit", rows, cols);
    let grid = scene.grid().unwrap();
    let place = |k: usize| (k / cols, k % cols);
    for spring in scene.model.network().unwrap().springs() {
        let ((i, j), (k, l)) = (place(spring.i), place(spring.j));
        assert_eq!(grid.index_of(i, j), spring.i);
        let offset = (i.abs_diff(k), j.abs_diff(l));
        match spring.kind {
            SpringKind::Structural => assert!(offset == (0, 1) || offset == (1, 0)),
            SpringKind::Shear => assert_eq!(offset, (1, 1)),
            SpringKind::Bend => assert!(offset == (0, 2) || offset == (2, 0)),
        }
    }
}

#[test]
fn grids_that_make_no_sense_are_refused() {
    for (rows, cols) in
        [(0, 5), (1, 5), (5, 1), (usize::MAX, 2), (4_294_967_295, 4_294_967_295), (2049, 2048)]
    {
        let error = Grid::new(rows, cols).unwrap_err().to_string();
        assert!(error.contains(&MAX_PARTICLES.to_string()), "{error}");
    }
    let grid = Grid::new(3, 3).unwrap();
    assert!(a3_scenes::find("chain").unwrap().build(Some(grid)).is_err());
}

/// With its default step, each method is stable on each scene that it supports, for 5 s of wind
/// and swing, or for less where that would take minutes.
#[test]
fn default_controls_hold_everywhere() {
    on_all_cores(a3_scenes::SCENES, |entry| {
        for method in integrators::METHODS {
            let setup = entry.build(None).unwrap();
            let (scene, control) = (setup.scene, setup.defaults.control_of(method));
            let serves = method.check(scene.model.system()).is_ok();
            if takes_minutes(method, &scene) {
                continue;
            }
            let run = Simulation::new(scene, method, control);
            assert_eq!(run.is_ok(), serves);
            let Ok(mut run) = run else { continue };
            run.set_wind(true);
            run.set_swinging(true);
            let end = match entry.name {
                "flag" | "jelly" => 2.0,
                "cantilever" => 1.0,
                "drop" | "dam-break" => 0.3,
                "boxes" | "dominoes" | "ball-on-cloth" => 0.02,
                _ => 5.0,
            };
            run.advance_to(end)
                .unwrap_or_else(|e| panic!("{} on {}: {e}", method.name, entry.name));
            let (_, radius) = run.extent();
            // Positions and velocities.
            let halves = 6 * run.particles().min(run.state().len() / 6);
            assert!(
                run.state()[..halves].iter().all(|y| y.abs() < 20.0 * radius),
                "{} on {}",
                method.name,
                entry.name
            );
        }
    });
}

/// Default steps are shortened for a finer cloth, whose fastest mode is faster, and are stable.
#[test]
fn default_controls_hold_on_other_grids() {
    on_all_cores([(8, 8), (40, 40), (60, 20), (20, 60)], |(rows, cols)| {
        for method in integrators::METHODS.iter().filter(|m| !m.positions_only() && !m.plain_only())
        {
            let grid = Grid::new(rows, cols).unwrap();
            let setup = a3_scenes::find("cloth").unwrap().build(Some(grid)).unwrap();
            let control = match method.default_control {
                Control::Step(step) => Control::Step(step * setup.defaults.step_scale),
                Control::Tolerance(_) => method.default_control,
            };
            let mut run = Simulation::new(setup.scene, method, control).unwrap();
            run.advance_to(1.0).unwrap_or_else(|e| panic!("{} on {rows}x{cols}: {e}", method.name));
            assert!(run.largest_stretch().unwrap() < 2.5, "{} on {rows}x{cols}", method.name);
        }
    });
}

/// A pin has the place and the velocity of its path from the first moment on, for any body that it
/// is part of; otherwise the first step would depend on its length.
#[test]
fn pins_begin_in_their_places() {
    let moving = "[[chain]]
        particles = 3
        from = [0, 0, 0]
        to = [1, 0, 0]
        mass = 1
        stiffness = 25
        pin = [{ at = ['first'], sine = { amplitude = [0, 0.5, 0], rate = 3, center = [0, 2, 0] } }]
        [state]
        positions = [[0, 0, 0], [0.5, 0, 0], [1, 0, 0]]
        velocities = [[7, 7, 7], [0, 0, 0], [0, 0, 0]]";
    let scene = described(moving);
    assert_eq!(row(&scene.state, 0), [0.0, 2.0, 0.0, 0.0, 1.5, 0.0]);
    assert_eq!(row(&scene.state, 1), [0.5, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for name in a3_scenes::SCENES.iter().map(|entry| entry.name) {
        let scene = self::scene(name);
        let Some(network) = scene.model.network() else {
            continue;
        };
        for i in (0..network.particles()).filter(|i| network.is_pinned(*i)) {
            assert_eq!(row(&scene.state, i)[3..], [0.0; 3], "{name}, particle {i}");
        }
    }
}

/// The flag initially moves as one, except for the particles at the pole.
#[test]
fn a_flag_takes_the_same_way_in_steps_of_any_length() {
    let after = |method: &str, control| {
        let method = integrators::find(method).unwrap();
        let mut run = Simulation::new(scene("flag"), method, control).unwrap();
        run.advance_to(0.1).unwrap();
        run.state().to_vec()
    };
    let adaptive = after("dop853", Control::Tolerance(1e-8));
    let fixed = after("rk4", Control::Step(2e-4));
    let apart = adaptive.iter().zip(&fixed).map(|(a, b)| (a - b).abs());
    let largest = apart.fold(0.0, f64::max);
    assert!(largest < 1e-5, "{largest:.1e}");
}

/// Position and velocity of particle i.
fn row(state: &[f64], i: usize) -> Vec<f64> {
    let n = state.len() / 6;
    (0..6).map(|k| state[k * n + i]).collect()
}
