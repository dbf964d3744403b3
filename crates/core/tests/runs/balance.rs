//! Balance of energy: energy that a method adds to a run is noticed, and no other energy is
//! mistaken for it.

use a3_core::{BlowUp, Cause, Control, Error, Network, Simulation, Vector3};

use super::common::{described, method, scene, takes_minutes};

/// Run of a built-in scene up to a time (s).
fn run(name: &str, solver: &str, h: f64, until: f64) -> (Simulation, Result<(), Error>) {
    let mut run = Simulation::new(scene(name), method(solver), Control::Step(h)).unwrap();
    let end = run.advance_to(until);
    (run, end)
}

#[test]
fn energy_from_nowhere_is_noticed() {
    // Their states are absurd, although no particle is far away.
    for (name, solver, h) in
        [("chain", "v", 0.231), ("mit", "p", 0.0516), ("jelly", "i", 0.04), ("jelly", "i", 0.24)]
    {
        let (run, end) = run(name, solver, h, 4.5);
        let gained = match end {
            Ok(()) => run.gained().map(|gain| gain.energy),
            Err(Error::BlowUp(BlowUp { cause: Cause::Gained { energy, .. }, .. })) => Some(energy),
            Err(why) => panic!("{name} by {solver}: {why}"),
        };
        assert!(gained > Some(50.0), "{name} by {solver}: {gained:?}");
    }
    let (_, end) = run("pendulum", "m", 0.1947, 5.0);
    let Err(Error::BlowUp(lost)) = end else {
        panic!("it went on");
    };
    assert!(matches!(lost.cause, Cause::Gained { particle: 1, .. }), "{lost}");
    assert!(lost.to_string().contains("J that nothing put in"), "{lost}");
}

#[test]
fn work_is_no_gain() {
    for entry in a3_scenes::SCENES {
        let setup = entry.build(None).unwrap();
        for name in ["t", "v", "r", "i", "a", "o"] {
            let method = method(name);
            let refuses = method.check(setup.scene.model.system()).is_err();
            if refuses || takes_minutes(method, &setup.scene) {
                continue;
            }
            // Implicit Euler solves one linear equation a step, and gains energy in default steps.
            let control = match setup.defaults.control_of(method) {
                Control::Step(h) if name == "i" => Control::Step(0.1 * h),
                control => control,
            };
            let mut run = Simulation::new(setup.scene.clone(), method, control).unwrap();
            run.set_wind(true);
            run.set_swinging(true);
            // Fluids and bodies that touch need short steps.
            let short = |n: &Network| n.fluid().is_some() || n.contact_layer().is_some();
            let short = run.model().network().is_some_and(short);
            if run.advance_to(if short { 0.1 } else { 2.0 }).is_ok() {
                assert_eq!(run.gained(), None, "{} by {name}", entry.name);
            }
        }
    }
}

/// Cloth that lies on a box, which lifts it fast.
const LIFTED: &str = "gravity = [0, -9.81, 0]\n\
    [[cloth]]\ngrid = [6, 6]\nwidth = 1\nmass = 0.02\nstiffness = [40, 20, 1]\n\
    damping_ratio = 0.2\nat = [-0.5, 0.01, -0.5]\ndown = [0, 0, 1]\n\
    [[box]]\ncenter = [0, -0.5, 0]\nsize = [4, 1, 4]\nfriction = 0.5\n\
    shift = { by = [3, 30, 0], start = 0.2, end = 5 }\n";

#[test]
fn what_obstacles_and_hands_do_is_no_gain() {
    let mut lifted = Simulation::new(described(LIFTED), method("v"), Control::Step(0.002)).unwrap();
    lifted.advance_to(2.0).unwrap();
    let energy = lifted.energy().unwrap();
    assert!(energy.gravitational > 50.0, "{energy:?}");
    assert_eq!(lifted.gained(), None);
    // A hand pulls back and forth, with more energy than the scene has, and pins and lets go.
    for name in ["cloth", "chain", "double-pendulum"] {
        let mut run = Simulation::new(scene(name), method("r"), Control::Step(0.001)).unwrap();
        let last = run.particles() - 1;
        for k in 0..20 {
            if k % 5 == 0 {
                run.release();
                run.grab(last).unwrap();
            }
            let side = [-1.0, 1.0][k % 2];
            run.pull(run.position(last) + Vector3::new(side, 0.5, 0.3 * side));
            run.advance_to(run.time() + 0.04).unwrap();
        }
        run.release();
        run.advance_to(run.time() + 0.5).unwrap();
        assert_eq!(run.gained(), None, "{name}");
        // Particles that are low fall upwards from now on.
        run.reset();
        run.advance_to(0.2).unwrap();
        run.adjust(|network| network.set_gravity(Vector3::new(0.0, 60.0, 0.0)));
        run.advance_to(0.7).unwrap();
        assert_eq!(run.gained(), None, "{name}");
    }
}

#[test]
fn what_falls_or_is_thrown_far_away_is_not_lost() {
    // A particle in a scene of 1 m falls hundreds of metres.
    let particle = "[particles]\npositions = [[0, 0, 0]]\nmass = 1\n";
    let weight = "gravity = [0, -9.81, 0]\n";
    let thrown = "velocities = [[100, 50, 0]]\n";
    let gusts = "[wind]\non = true\nforce_per_mass = [40, 0, 0]\n";
    for (before, after, end) in [
        (weight, "", Some(Vector3::new(0.0, -490.5, 0.0))),
        (weight, thrown, Some(Vector3::new(1000.0, 9.5, 0.0))),
        ("drag = 0.1\n", gusts, None),
    ] {
        let text = format!("name = \"far\"\n{before}{particle}{after}");
        for (name, value) in [("verlet", 0.01), ("rk4", 0.01), ("dop853", 1e-6)] {
            let method = method(name);
            let control = method.control(value);
            let mut run = Simulation::new(described(&text), method, control).unwrap();
            run.advance_to(10.0).unwrap();
            let x = run.position(0);
            assert!(x.norm() > 200.0 && run.gained().is_none(), "{name}: {x}");
            let is_there = end.is_none_or(|end| (x - end).norm() < 1e-6);
            assert!(is_there, "{name}: {x}");
        }
    }
    // A step that is too long takes the particles as far, which is still a blow-up.
    let pair = "name = \"pair\"\nsprings = [[0, 1, 1e6, 1, 0]]\n\
                [particles]\npositions = [[0, 0, 0], [1.1, 0, 0]]\nmass = 1\n";
    let mut run = Simulation::new(described(pair), method("rk4"), Control::Step(0.003)).unwrap();
    let Err(Error::BlowUp(lost)) = run.advance_to(10.0) else {
        panic!("it went on");
    };
    assert!(matches!(lost.cause, Cause::Away { distance, .. } if distance > 50.0));
}

/// Where nothing moves, an adaptive method takes steps so long that it only just meets its
/// tolerance: its errors are no blow-up.
#[test]
fn errors_within_a_tolerance_are_no_gain() {
    let chain = "
        [[chain]]
        particles = 9
        from = [2.07, 0.08, -0.59]
        to = [3.57, -0.94, -0.78]
        mass = 6.6
        damping = 1.6
        stiffness = 1000
        buckling = { bending = 7.1e-7, compression = 710 }
    ";
    let rods = "
        drag = 3.15
        [[chain]]
        particles = 4
        from = [5.8922537, 0.51199329, -0.1132023]
        to = [5.2328742, -0.18579852, 0.72879147]
        mass = 0.489
        rigid = true
    ";
    for (toml, name) in
        [(chain, "dopri5"), (chain, "rkf45"), (chain, "dop853"), (rods, "rkf45"), (rods, "dopri5")]
    {
        for tolerance in [5e-3, 1e-6] {
            let control = Control::Tolerance(tolerance);
            let mut run = Simulation::new(described(toml), method(name), control).unwrap();
            run.advance_to(20.0).unwrap();
            run.conclude().unwrap();
            assert_eq!(run.gained(), None, "{name} {tolerance}");
        }
    }
}

/// The energy that damping dissipates does not hide that a run explodes.
#[test]
fn damped_explosions_are_noticed() {
    let toml = "
        drag_per_mass = 0.035
        tear = 2.43
        [[chain]]
        from = [-0.348, 0.504, 0.635]
        to = [-0.172, 0.485, -0.771]
        mass = 0.066
        particles = 4
        rigid = true
        [[cloth]]
        damping_ratio = 0.61
        density = 1255
        grid = [5, 3]
        spacing = 0.128
        stiffness = [0.71, 76245, 1014]
    ";
    let control = Control::Step(4.4e-4);
    let mut run = Simulation::new(described(toml), method("symplectic"), control).unwrap();
    let end = run.advance_to(0.009).and_then(|()| run.conclude());
    let Err(Error::BlowUp(lost)) = end else {
        panic!("it ended well, at {:?}", run.energy());
    };
    assert!(matches!(lost.cause, Cause::Gained { .. }), "{lost}");
}

/// What moves is compared with itself: rounding errors are no gain, a tenth of it is one, and the
/// work of what drives a scene is known where its energy is.
#[test]
fn gains_are_compared_with_what_moves() {
    let resting = "self_collision = true\n[[solid]]\ngrid = [2, 2, 2]\n\
        size = [1.28446, 0.225059, 0.83291]\ndensity = 2049.89\nyoung = 685198\n\
        poisson = 0.340108\nat = [-0.702326, 0.116608, -1.18176]\n";
    let windy = "self_collision = true\n[[cloth]]\ngrid = [15, 15]\nwidth = 1\ndensity = 0.2\n\
        stiffness = [40, 20, 2]\n[wind]\non = true\nsteady = true\nforce_per_mass = [0, 0, 1]\n";
    let sideways = "gravity = [0, -9.81, 0]\n[[box]]\ncenter = [0, -0.1, 0]\n\
        size = [20, 0.2, 6]\nthickness = 0.004\nshift = { by = [0.2, 0, 0], end = 4 }\n\
        [[body]]\nparts = [{ ball = 0.1 }]\nmass = 1\nat = [0, 0.101, 0]\n";
    let fan = "[wind]\non = true\nsteady = true\nvelocity = [0, 0, 5]\ndensity = 1.2\ndrag = 1.2\n\
        lift = 0\n[wind.region]\nat = [-0.5, 0, 0]\nradius = 0.4\nlength = 3\n\
        [[body]]\nparts = [{ box = [2, 1, 0.02] }]\nmass = 4\n\
        [[joint]]\nbody = 0\nhinge = { at = [0, 0, 0], axis = [0, 1, 0] }\n";
    for (text, name, value, until) in [
        (resting, "rk4", 0.001, 0.5),
        (resting, "implicit", 0.001, 0.5),
        (windy, "verlet", 0.001, 0.2),
        (windy, "implicit", 0.01, 0.2),
        (sideways, "implicit", 0.01, 1.0),
        (sideways, "verlet", 0.005, 1.0),
        (fan, "dopri5", 1e-3, 3.0),
    ] {
        let method = method(name);
        let mut run = Simulation::new(described(text), method, method.control(value)).unwrap();
        run.advance_to(until).unwrap();
        run.conclude().unwrap();
        assert_eq!(run.gained(), None, "{name} {value}: {text}");
    }
    // A light cart carries a heavy pendulum.
    let cart = "gravity = [0, -9.81, 0]\n[particles]\n\
        positions = [[0, 0, 0], [0.8660254037844386, -0.5, 0]]\nmasses = [0.01, 100]\n\
        [[constraint]]\nparticle = 0\nline = { point = [0, 0, 0], direction = [1, 0, 0] }\n\
        [[constraint]]\nrod = [0, 1]\n";
    let gained = |tolerance: f64| {
        let control = Control::Tolerance(tolerance);
        let mut run = Simulation::new(described(cart), method("dopri5"), control).unwrap();
        run.advance_to(5.0).unwrap();
        run.gained()
    };
    let gain = gained(1e-3).unwrap();
    assert!((0.1..0.3).contains(&gain.share), "{gain:?}");
    // The pendulum falls by 490.5 J.
    assert!((gain.energy / gain.share - 490.5).abs() < 0.2 * 490.5, "{gain:?}");
    assert_eq!(gained(1e-8), None);
}

/// Two particles on a stretched spring, whose period is 0.08 s, beside a cloth that touches itself.
const STRETCHED: &str = "self_collision = true\n\
    [particles]\nmass = 1\npositions = [[0, 0, 0], [1.5, 0, 0]]\nsprings = [[0, 1, 3084, 1.0, 0.0]]\n\
    [[cloth]]\ngrid = [2, 2]\nwidth = 0.1\nmass = 0.01\nstiffness = [10, 10, 1]\nat = [0, 5, 0]\n";

/// Explicit Euler gains a twentieth in a period, which is over before the energy is checked: that
/// is no blow-up.
#[test]
fn what_moved_between_checks_counts() {
    let scene = described(STRETCHED);
    let mut run = Simulation::new(scene, method("euler"), Control::Step(1e-4)).unwrap();
    run.advance_to(0.09).unwrap();
    let change = run.energy_change().unwrap();
    assert!((0.03..0.3).contains(&change), "{change}");
}

/// A stiff solid that flies freely, beside a box that moves.
const FLYING: &str = "self_collision = true\n\
    [[solid]]\ngrid = [2, 3, 2]\nsize = [0.2, 0.3, 0.2]\ndensity = 0.7\nyoung = 1e8\npoisson = 0.3\n\
    at = [1, 0, 0]\nvelocity = [0, 0.2, -0.1]\n\
    [[box]]\ncenter = [9, 0, 0]\nsize = [1, 1, 1]\nsine = { amplitude = [0.5, 0, 0], rate = 3 }\n";

#[test]
fn rounding_errors_are_no_work() {
    let scene = described(FLYING);
    let mut run = Simulation::new(scene, method("i"), Control::Step(0.1)).unwrap();
    for _ in 0..200 {
        run.take_steps(1).unwrap();
        assert_eq!(run.gained(), None, "at {} s", run.time());
    }
}

/// An observer who moves along at any uniform velocity sees the same share of energy gained.
#[test]
fn gains_are_the_same_to_all_observers() {
    let shares = [0.0, 1.0, 10.0].map(|speed: f64| {
        let text = format!(
            "[particles]
            positions = [[0, 0, 0], [1.1, 0, 0]]
            velocities = [[{speed}, 0, 0], [{speed}, 0, 0]]
            mass = 1
            springs = [[0, 1, 100, 1, 0]]"
        );
        let method = method("euler");
        let mut run = Simulation::new(described(&text), method, Control::Step(1e-3)).unwrap();
        run.advance_to(3.0).unwrap();
        run.gained().unwrap().share
    });
    for share in shares {
        assert!((share - shares[0]).abs() < 1e-6, "{shares:?}");
    }
}

/// A ball lies on a box that begins to move at once, upwards or downwards: no energy comes from
/// nowhere.
#[test]
fn a_ball_on_a_box_that_jumps_gains_nothing() {
    for by in [0.6, -0.6] {
        let text = format!(
            "gravity = [0, -9.81, 0]
            [[box]]
            center = [0, -0.1, 0]
            size = [4, 0.2, 4]
            restitution = 0.5
            shift = {{ by = [0, {by}, 0], start = 0.3, end = 0.6 }}
            [[body]]
            parts = [{{ ball = 0.1 }}]
            mass = 1
            at = [0, 0.1019, 0]"
        );
        for (name, control) in [
            ("rk4", Control::Step(5e-4)),
            ("dopri5", Control::Tolerance(1e-6)),
            ("dop853", Control::Tolerance(1e-8)),
        ] {
            let mut run = Simulation::new(described(&text), method(name), control).unwrap();
            let end = run.advance_to(1.0);
            end.unwrap_or_else(|why| panic!("{name}, {by} m: {why}"));
            assert_eq!(run.gained(), None, "{name}, {by} m");
        }
    }
}

/// A box sinks onto a jelly. Implicit methods foresee how it gives way, and what the box then has
/// to stop is little; its work is no gain all the same. What a step that is too long adds is one.
#[test]
fn a_jelly_that_a_box_presses_gains_nothing() {
    let text = "self_collision = true
        gravity = [0, -9.81, 0]
        floor = { height = 0, friction = 0.3 }
        [[jelly]]
        grid = [5, 5, 5]
        size = [0.4, 0.4, 0.4]
        mass = 0.002
        stiffness = [40, 20, 10]
        damping_ratio = 0.5
        at = [0, 0.22, 0]
        [[box]]
        center = [0, 0.66, 0]
        size = [1, 0.4, 1]
        shift = { by = [0, -0.25, 0], end = 0.5 }";
    let run = |name: &str, step: f64| {
        let mut run = Simulation::new(described(text), method(name), Control::Step(step)).unwrap();
        let end = run.advance_to(0.6);
        (end.map_err(|why| why.to_string()), run.gained())
    };
    for (name, step) in [("i", 0.02), ("i", 0.005), ("b", 0.01), ("r", 0.001)] {
        assert_eq!(run(name, step), (Ok(()), None), "{name}, {step} s");
    }
    let (end, _) = run("t", 0.002);
    assert!(end.is_err_and(|why| why.contains("gained")));
}

/// What a method adds to rods that it stretches is told, and nothing else is.
#[test]
fn rods_put_in_no_work() {
    for (solver, h, until) in
        [("s", 0.002, 3.0), ("s", 0.002, 10.0), ("m", 0.02, 10.0), ("t", 0.02, 10.0)]
    {
        let (run, end) = run("double-pendulum", solver, h, until);
        end.unwrap();
        let begun = Simulation::new(scene("double-pendulum"), run.method(), run.control()).unwrap();
        let gained = run.energy().unwrap().total() - begun.energy().unwrap().total();
        let told = run.gained().map(|gain| gain.energy);
        // The largest gain until then is told, if it is notable.
        match told {
            Some(told) => assert!(
                told > gained - 0.1 && told < 1.5 * gained,
                "{solver} {until}: {told} {gained}"
            ),
            None => assert!(gained < 5.0, "{solver} {until}: {gained}"),
        }
    }
}
