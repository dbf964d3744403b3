//! Showing a run does not change it.

use crate::common::{described, method, on_all_cores, takes_minutes};
use a3_core::integrators::METHODS;
use a3_core::{Control, Simulation};

/// Every scene by every method has the same bits without frames and with frames between the ends of
/// steps.
#[test]
fn frames_change_no_bit() {
    on_all_cores(a3_scenes::SCENES, |entry| {
        let setup = entry.build(None).unwrap();
        for method in METHODS {
            if method.check(setup.scene.model.system()).is_err()
                || takes_minutes(method, &setup.scene)
            {
                continue;
            }
            let control = match setup.defaults.control_of(method) {
                Control::Step(step) => Control::Step(step.max(1e-3)),
                tolerance @ Control::Tolerance(_) => tolerance,
            };
            let run = || Simulation::new(setup.scene.clone(), method, control).unwrap();
            let (mut plain, mut seen) = (run(), run());
            if plain.take_steps(12).is_err() {
                continue;
            }
            let end = plain.time();
            for k in 1..=29 {
                seen.advance_to(end * f64::from(k) / 29.0).unwrap();
            }
            assert_eq!(plain.steps(), seen.steps(), "{} {}", entry.name, method.name);
            let same = plain.state() == seen.state();
            assert!(same, "{} by {}", entry.name, method.name);
        }
    });
}

/// Verlet at 0.9 of its limit is stable with any frames.
#[test]
fn frames_excite_no_oscillation() {
    let toml = "
        [[chain]]
        particles = 9
        from = [0, 0, 0]
        to = [1, 0.3, 0]
        mass = 1
        stiffness = 1000
        pin = [{ at = [\"first\"] }]
    ";
    let toml = format!("gravity = [0, -9.81, 0]\n{toml}");
    let method = method("verlet");
    // w = 2 sqrt(k / m) cos(pi / 34) for 8 free masses.
    let mass = 1.0 / 9.0;
    let w = 2.0 * f64::sqrt(1000.0 / mass) * f64::cos(std::f64::consts::PI / 34.0);
    let step = 0.9 * 2.0 / w;
    for fps in [20, 24, 25, 30, 50, 60, 4000] {
        let mut run = Simulation::new(described(&toml), method, Control::Step(step)).unwrap();
        for k in 1..=3 * fps {
            run.advance_to(f64::from(k) / f64::from(fps)).unwrap();
        }
        assert!(run.gained().is_none(), "{fps}: {:?}", run.gained());
    }
}

/// States between the ends of smooth fixed steps have the error of the polynomial, of order 6 in
/// positions, and of order 5 in velocities.
#[test]
fn states_within_fixed_steps_are_accurate() {
    // A circle of frequency 5 about a spring of rest length 0.
    let toml = "
        [particles]
        positions = [[0, 0, 0], [1, 0, 0]]
        mass = 1
        springs = [[0, 1, 25, 0, 0]]
        pin = [{ particles = [0] }]
        [state]
        positions = [[0, 0, 0], [1, 0, 0]]
        velocities = [[0, 0, 0], [0, 5, 0]]
    ";
    let error = |step: f64| {
        let method = method("dop853");
        let mut run = Simulation::new(described(toml), method, Control::Step(step)).unwrap();
        run.advance_to(0.5 * step).unwrap();
        let angle = 2.5 * step;
        let x = run.position(1);
        let v = run.velocities();
        let of_x = (x.x - angle.cos()).hypot(x.y - angle.sin());
        let of_v = (v[1] + 5.0 * angle.sin()).hypot(v[3] - 5.0 * angle.cos());
        [of_x, of_v]
    };
    let ([x, v], [half_x, half_v]) = (error(0.1), error(0.05));
    assert!((x / half_x).log2() > 5.7 && x < 1e-5, "{x} {half_x}");
    assert!((v / half_v).log2() > 4.7 && v < 1e-3, "{v} {half_v}");
}

/// Between the ends of steps that are long compared with stiff springs, states have no more energy
/// than at the ends: the implicit midpoint method reverses such oscillations in each step, and a
/// polynomial through its states overshoots.
#[test]
fn states_within_stiff_steps_stay_between_their_ends() {
    let toml = "
        [[chain]]
        particles = 6
        from = [0, 0, 0]
        to = [1, 0.3, 0]
        mass = 1
        stiffness = 1e7
        [state]
        positions = [
            [0, 0, 0], [0.2, 0.06, 0], [0.4, 0.12, 0], [0.6, 0.18, 0], [0.8, 0.24, 0], [1, 0.3, 0],
        ]
        velocities = [[1, 0, 0], [0, 1, 0], [0.4, 0, 1], [0, -1, 0], [1, 0, -1], [0, 0.3, 0]]
    ";
    for name in ["implicit-midpoint", "implicit", "tr-bdf2", "xpbd", "vbd"] {
        let most = |frame: f64| {
            let control = Control::Step(0.01);
            let mut run = Simulation::new(described(toml), method(name), control).unwrap();
            let frames = 1..=(0.5 / frame).round() as u32;
            let energies = frames.map(|k| {
                run.advance_to(frame * f64::from(k)).unwrap();
                run.energy().unwrap().total()
            });
            energies.fold(3.125, f64::max)
        };
        let (ends, within) = (most(0.01), most(0.001));
        assert!(within < 1.2 * ends, "{name}: {within} J, {ends} J");
    }
}

/// Where nothing accelerates, an adaptive method takes ever longer steps. A run that went back from
/// far ahead goes on all the same.
#[test]
fn free_flight_goes_on_after_going_back() {
    let scene = described(
        "[particles]
        positions = [[0, 0, 0]]
        velocities = [[1, 0, 0]]
        mass = 1",
    );
    for name in ["dopri5", "dop853", "dprkn86", "bdf"] {
        let method = method(name);
        let mut run = Simulation::new(scene.clone(), method, method.control(1e-6)).unwrap();
        run.advance_to(0.5).unwrap();
        let moment = run.moment();
        run.take_steps(20).unwrap();
        assert!(run.time() > 1e3, "{name}: {}", run.time());
        run.rewind(&moment).unwrap();
        run.advance_to(0.6).unwrap();
        let x = run.position(0).x;
        assert!((x - 0.6).abs() < 1e-6, "{name}: {x}");
    }
}

/// A rigid chain falls across the corner of a post. Between steps, too, no edge gets into the post,
/// and the rods keep their lengths.
#[test]
fn frames_show_rods_beside_what_they_touch() {
    let toml = "
        self_collision = true
        gravity = [0, -9.81, 0]
        [[box]]
        center = [0, 0, 0]
        size = [0.05, 0.4, 0.05]
        rotation = [0, 0.3, 0]
        [[chain]]
        particles = 15
        rigid = true
        from = [-0.6, 0.23, 0.05]
        to = [0.6, 0.23, -0.07]
        mass = 0.01
    ";
    let length = f64::hypot(1.2, 0.12) / 14.0;
    for (name, tolerance) in [("dopri5", 1e-3), ("rkf45", 1e-3), ("verner65", 1e-5)] {
        let control = Control::Tolerance(tolerance);
        let mut run = Simulation::new(described(toml), method(name), control).unwrap();
        for k in 1..=60 {
            run.advance_to(f64::from(k) / 60.0).unwrap();
            let network = run.model().network().unwrap();
            let apart = network.check_apart(run.time(), &run.state()[..3 * run.particles()]);
            apart.unwrap_or_else(|why| panic!("{name}, frame {k}: {why}"));
            for i in 1..15 {
                let off = (run.position(i) - run.position(i - 1)).norm() / length - 1.0;
                assert!(off.abs() < 1e-3, "{name}, frame {k}, rod {i}: {off:e}");
            }
        }
    }
}
