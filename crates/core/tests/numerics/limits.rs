//! Stability limits by modes, against exact ones.

use crate::common::{described, method, scene, scene_with_grid, spring};
use crate::stability::{DAMPED_LIMITS, ZETAS};
use a3_core::stability::{GROWTH, Growth, LargestMode, Mode, largest_step, spectrum, tenfold_time};
use a3_core::{Grid, Mechanics, Network, Path, Sheet, Vector3, integrators};
use approx::assert_relative_eq;

fn undamped(frequency: f64) -> Mode {
    Mode { stiffness: frequency * frequency, ..Mode::default() }
}

#[test]
fn growth_on_the_imaginary_axis() {
    for w in [1.0, 30.0, 1e4] {
        for y in [0.1, 0.5, 1.0, 2.0, 2.9, 7.0] {
            for (name, expected) in [
                ("euler", f64::hypot(1.0, y)),
                ("trapezoid", (1.0 + y.powi(4) / 4.0).sqrt()),
                ("midpoint", (1.0 + y.powi(4) / 4.0).sqrt()),
                ("rk4", (1.0 - y.powi(6) / 72.0 + y.powi(8) / 576.0).sqrt()),
            ] {
                let radius = Growth::new(method(name), undamped(w)).unwrap().of_step(y / w);
                assert_relative_eq!(radius, expected, max_relative = 1e-11);
            }
        }
    }
}

/// Limits of each method on the real axis, on the imaginary axis, and between them.
#[test]
fn limits_in_the_plane() {
    let limit = |name: &str, mode: Mode| largest_step(method(name), &[mode]).unwrap().unwrap();
    for (name, real) in [
        ("euler", 2.0),
        ("trapezoid", 2.0),
        ("midpoint", 2.0),
        ("rk4", 2.785_293_563),
        ("rkf45", 3.677_706_621),
        ("dopri5", 3.306_567_893),
        ("dop853", 6.393_651_523),
        ("verner65", 4.855_274_315),
    ] {
        let found = limit(name, Mode::of_eigenvalue(-1000.0, 0.0));
        assert_relative_eq!(1000.0 * found.step, real, max_relative = 1e-3);
        assert!(found.is_sharp(), "{name}");
    }
    // The mode is so fast that any growth exceeds the bound at once.
    for (name, imaginary) in [
        ("rk4", 2.828_427_125),
        ("dopri5", 0.997_189_009),
        ("dop853", 5.960_359_812),
        ("symplectic", 2.0),
        ("verlet", 2.0),
        ("pefrl", 2.989_450),
        ("verner65", 2.584_199_580),
        ("srkn11", 9.073_609_404),
        ("dprkn86", 3.292_682_407),
        ("dprkn1210", 8.326_201_055),
    ] {
        let found = limit(name, undamped(1e6));
        assert_relative_eq!(1e6 * found.step, imaginary, max_relative = 5e-3);
        assert_relative_eq!(1e6 * found.bounded, imaginary, max_relative = 1e-6);
        assert!(found.is_sharp(), "{name}");
    }
    for name in ["euler", "trapezoid", "midpoint", "rkf45"] {
        let found = limit(name, undamped(100.0));
        assert!(found.bounded == 0.0 && 100.0 * found.step < 1.5, "{name}: {found:?}");
    }
    let w = 1e5;
    let more = ("srkn11", [9.074_230, 9.129_695, 9.678_548, 10.981_682, 5.525_655]);
    for (name, limits) in DAMPED_LIMITS.into_iter().chain([more]) {
        for (zeta, expected) in ZETAS.into_iter().zip(limits) {
            let mode = Mode { stiffness: w * w, drag: 2.0 * zeta * w, ..Mode::default() };
            let found = limit(name, mode);
            assert_relative_eq!(w * found.step, expected, max_relative = 2e-3);
            assert_relative_eq!(w * found.bounded, expected, max_relative = 2e-6);
        }
    }
    // The substitution by which these methods support drag damps every mode.
    for (name, limits) in [
        ("dprkn86", [4.815_554, 6.363_052, 10.676_329]),
        ("dprkn1210", [8.776_332, 10.100_642, 19.774_027]),
    ] {
        for (zeta, expected) in ZETAS.into_iter().zip(limits) {
            let mode = Mode::of_eigenvalue(-zeta * w, w * (1.0 - zeta * zeta).sqrt());
            let found = limit(name, mode);
            assert_relative_eq!(w * found.step, expected, max_relative = 2e-3);
        }
        let critical = Mode::of_eigenvalue(-w, 0.0);
        assert!(w * limit(name, critical).step > 40.0);
    }
}

/// Limits in a system with damped springs, of modes with and without damping. Verlet's method takes
/// three kicks there; without damping, each is stable to h w = 2, and the step to 6.
#[test]
fn limits_of_damped_springs() {
    let w = 1e5;
    for (zeta, expected) in [
        (0.0, 6.0),
        (0.01, 5.824_314),
        (0.1, 5.306_993),
        (0.2, 4.808_862),
        (0.3, 4.390_518),
        (0.36, 4.177_438),
        (0.5, 3.758_512),
        (0.7, 3.132_067),
        (1.0, 2.459_701),
        (2.0, 1.380_401),
    ] {
        let mode = Mode { damping: 2.0 * zeta * w, reads_velocity: true, ..undamped(w) };
        let found = largest_step(method("verlet"), &[mode]).unwrap().unwrap();
        assert_relative_eq!(w * found.step, expected, max_relative = 2e-3);
        assert_relative_eq!(w * found.bounded, expected, max_relative = 2e-6);
    }
    // Modes that a scene reports.
    let modes = |damping: f64| {
        let scene = described(&format!(
            "[[chain]]\nparticles = 3\nfrom = [0, 0, 0]\nto = [2, 0, 0]\nmass = 1\n\
             stiffness = 1\ndamping = {damping}\npin = [{{ at = [\"first\"] }}]\n"
        ));
        spectrum(scene.model.system(), 0.0, &scene.state)
    };
    let damped = modes(0.1);
    assert!(!damped.is_empty() && damped.iter().all(|mode| mode.reads_velocity));
    assert!(modes(0.0).iter().all(|mode| !mode.reads_velocity));
}

/// Steps at which modes grow at all, and at which they grow tenfold, for methods with slow growth
/// in between: Euler's method with little damping, and that of Dormand and Prince without any.
#[test]
fn slow_growth_is_no_limit_and_no_stability() {
    let damped = Mode { drag: 0.02, ..undamped(10.0) };
    for (name, mode, bounded) in
        [("euler", damped, 2e-4), ("dopri5", undamped(10.0), 0.099_718_900_9)]
    {
        let found = largest_step(method(name), &[mode]).unwrap().unwrap();
        assert!(!found.is_sharp(), "{name}: {found:?}");
        assert_relative_eq!(found.bounded, bounded, max_relative = 1e-6);
        let steps = tenfold_time(found.step) / found.step;
        let growth = Growth::new(method(name), mode).unwrap().of_step(found.step);
        assert_relative_eq!(growth.powf(steps), GROWTH, max_relative = 1e-6);
        assert!(found.step > 1.2 * bounded, "{name}: {found:?}");
    }
}

/// The energy of a mode oscillates by a factor of 1 / (1 - z^2 / 4) in steps of Verlet's method, z
/// = h w, by (2 + z) / (2 - z) in those of symplectic Euler, and not at all in Runge-Kutta steps.
#[test]
fn the_energy_of_a_mode_swings() {
    for z in [0.1, 1.0, 1.9] {
        for (name, expected) in [
            ("verlet", 1.0 / (1.0 - z * z / 4.0)),
            ("symplectic", (2.0 + z) / (2.0 - z)),
            ("rk4", 1.0),
            ("trapezoid", 1.0),
        ] {
            let mut growth = Growth::new(method(name), undamped(30.0)).unwrap();
            assert_relative_eq!(growth.swing(z / 30.0), expected, max_relative = 1e-6);
        }
    }
    // Damping makes the exact energy oscillate, and a Runge-Kutta method adds nothing to that.
    for ratio in [0.3, 0.9] {
        let damped = Mode { damping: 2.0 * ratio * 30.0, ..undamped(30.0) };
        let mut growth = Growth::new(method("rk4"), damped).unwrap();
        assert_relative_eq!(growth.swing(1.0 / 30.0), 1.0, max_relative = 1e-6);
    }
}

/// Largest angular frequency of n free masses on a line with one end pinned: 2 sqrt(k/m) cos(pi /
/// (2n + 1)).
#[test]
fn a_chain_has_its_frequency() {
    for n in [1, 2, 5, 40] {
        let mut network = Network::new(vec![0.5; n + 1]).unwrap();
        for i in 0..n {
            let spring = spring(i, i + 1, [200.0, 0.1, 0.0]);
            network.add_spring(spring).unwrap();
        }
        network.pin(0, Path::Still(Vector3::zeros())).unwrap();
        let mut y = vec![0.0; 6 * (n + 1)];
        for (i, x) in y[..=n].iter_mut().enumerate() {
            *x = 0.1 * i as f64;
        }
        let angle = std::f64::consts::PI / (2 * n + 1) as f64;
        let expected = 2.0 * 400f64.sqrt() * angle.cos();
        let found = spectrum(&network, 0.0, &y)[0].frequency();
        assert_relative_eq!(found, expected, max_relative = 1e-4);
    }
}

/// Largest w^2, in units of k/m, of a flat square of springs of one stiffness with two corners
/// pinned.
#[test]
fn a_cloth_has_its_frequency() {
    for (side, expected) in [
        (2, 2.707_107),
        (3, 5.427_124),
        (4, 7.140_427),
        (5, 8.252_815),
        (10, 9.589_049),
        (20, 9.987_099),
    ] {
        let grid = Grid::new(side, side).unwrap();
        let mut network = Network::new(vec![1.0; grid.particles()]).unwrap();
        network.add(Sheet::new(grid, 1.0, [1.0; 3], 0.0).unwrap()).unwrap();
        let n = grid.particles();
        let mut y = vec![0.0; 6 * n];
        for k in 0..n {
            (y[k], y[2 * n + k]) = ((k % side) as f64, (k / side) as f64);
        }
        for corner in [0, side - 1] {
            let at = Vector3::new(y[corner], 0.0, y[2 * n + corner]);
            network.pin(corner, Path::Still(at)).unwrap();
        }
        let found = spectrum(&network, 0.0, &y)[0].stiffness;
        assert_relative_eq!(found, expected, max_relative = 2e-3);
        let mut largest = LargestMode::default();
        let quick = largest.estimate(&network, 0.0, &y[..3 * n]).unwrap();
        assert_relative_eq!(quick.frequency(), expected.sqrt(), max_relative = 0.02);
        for _ in 0..20 {
            let _ = largest.estimate(&network, 0.0, &y[..3 * n]);
        }
        let again = largest.estimate(&network, 0.0, &y[..3 * n]).unwrap();
        assert_relative_eq!(again.frequency(), expected.sqrt(), max_relative = 5e-3);
    }
}

#[test]
fn drag_and_spring_damping_are_told_apart() {
    let mit = scene("mit");
    let modes = spectrum(mit.model.system(), 0.0, &mit.state);
    assert_relative_eq!(modes[0].frequency(), 81.87, max_relative = 1e-3);
    assert_relative_eq!(modes[0].drag, 2.5, max_relative = 1e-9);
    assert_eq!(modes[0].damping, 0.0);
    let cloth = scene("cloth");
    let network = cloth.model.network().unwrap();
    let modes = spectrum(network, 0.0, &cloth.state);
    assert_relative_eq!(modes[0].drag, 0.3, max_relative = 1e-9);
    // Damping is 0.006 s times the stiffness: all stiffness acts along the springs while none is
    // stretched.
    assert_relative_eq!(modes[0].damping, 0.006 * modes[0].stiffness, max_relative = 0.05);
    // The sum of the stiffnesses at a particle bounds the fastest mode.
    let bound = 2.0 * (4.0 * 2500.0 + 4.0 * 1250.0 + 4.0 * 625.0);
    assert!(modes[0].stiffness < bound && modes[0].stiffness > 0.4 * bound);
    let mut largest = LargestMode::default();
    let (x, _) = cloth.state.split_at(network.inverse_masses().len() * 3);
    let quick = largest.estimate(network, 0.0, x).unwrap();
    assert_relative_eq!(quick.frequency(), modes[0].frequency(), max_relative = 0.02);
}

#[test]
fn the_circle_has_one_mode() {
    let circle = scene("simple");
    let modes = spectrum(circle.model.system(), 0.0, &circle.state);
    assert_eq!(modes.len(), 1);
    assert_relative_eq!(modes[0].frequency(), 1.0, max_relative = 1e-8);
    assert_eq!(modes[0].drag, 0.0);
}

#[test]
fn a_scene_of_any_shape_has_a_spectrum() {
    for entry in a3_scenes::SCENES {
        let scene = entry.build(None).unwrap().scene;
        let modes = spectrum(scene.model.system(), 0.0, &scene.state);
        // A cloth with rigid bodies is too large.
        let found = entry.name != "ball-on-cloth";
        assert_eq!(!modes.is_empty(), found, "{}", entry.name);
        for m in integrators::METHODS {
            if let Ok(Some(limit)) = largest_step(m, &modes) {
                println!(
                    "{:<10} {:<10} {:9.5} {:9.5}",
                    entry.name, m.name, limit.bounded, limit.step
                );
            }
        }
    }
    let tall = scene_with_grid("cloth", 60, 4);
    assert!(spectrum(tall.model.system(), 0.0, &tall.state)[0].frequency() > 0.0);
}

/// Beside a free body, whose eigenvalues are zero with high multiplicity, a fluid and a solid have
/// the same modes as alone, where these come from Lanczos's method.
#[test]
fn eigenvalues_are_found_beside_many_that_are_zero() {
    let solid = "
        [[solid]]
        grid = [3, 2, 4]
        size = [0.164572, 1.31998, 0.695598]
        density = 158.335
        young = 7.17465e+06
        poisson = 0.275164
        at = [0.007671, -0.4899, -0.1751]
    ";
    let brick = "
        drag_per_mass = 4.56997
        [[chain]]
        particles = 6
        from = [-0.506569, -1.56093, -0.118498]
        to = [-1.19329, 1.11387, -1.72772]
        mass = 1.9218
        [[body]]
        parts = [{ box = [0.0757611, 0.612294, 0.685748], at = [-0.0950336, 0.271119, 0.0245021] }]
        mass = 10.7196
        at = [2.281, 0.2326, 0.000271]
    ";
    let fastest = |text: &str| {
        let scene = described(text);
        spectrum(scene.model.system(), 0.0, &scene.state)[0].frequency()
    };
    let both = fastest(&format!("{brick}{solid}"));
    assert_relative_eq!(both, fastest(solid), max_relative = 1e-4);
}

#[test]
fn what_grows_by_itself_limits_no_step() {
    let falling = Mode::of_eigenvalue(0.3, 2.0);
    let swinging = Mode::of_eigenvalue(-0.1, 50.0);
    // Rounding errors of a motion without damping, from differences of forces.
    let rounded = Mode::of_eigenvalue(1e-9, 50.0);
    assert!(!falling.returns() && swinging.returns() && rounded.returns());
    for method in integrators::METHODS.iter().filter(|m| !m.positions_only()) {
        let of = |modes: &[Mode]| largest_step(method, modes).unwrap().map(|limit| limit.step);
        assert_eq!(of(&[swinging, falling]), of(&[swinging]), "{}", method.name);
        assert_eq!(of(&[falling]), None);
    }
}
