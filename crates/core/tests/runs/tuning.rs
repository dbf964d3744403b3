//! Changes of a scene during a run, and scene descriptions of runs in progress.

use crate::common::scene;
use a3_core::contact::{Obstacle, Shape};
use a3_core::{Network, Scene, Simulation, Vector3, integrators};
use a3_scenes::{Description, snapshot};

fn start(scene: Scene, method: &str, step: f64) -> Simulation {
    let method = integrators::find(method).unwrap();
    Simulation::new(scene, method, method.control(step)).unwrap()
}

fn network(run: &Simulation) -> &Network {
    run.model().network().unwrap()
}

/// Derivative of a run's current state: velocities (m/s), then accelerations (m/s2).
fn forces(run: &Simulation) -> Vec<f64> {
    let mut f = vec![0.0; run.state().len()];
    run.model().system().eval_f(run.time(), run.state(), &mut f);
    f
}

#[test]
fn stiffness_and_damping_are_scaled_each_by_itself() {
    let own = scene("cloth").model.network().unwrap().clone();
    let mut other = own.clone();
    other.scale_springs(3.0, 0.5).unwrap();
    for (a, b) in own.springs().zip(other.springs()) {
        assert_eq!((3.0 * a.law.stiffness, 0.5 * a.law.damping), (b.law.stiffness, b.law.damping));
        assert_eq!(a.law.rest_length, b.law.rest_length);
    }
    assert!(other.scale_springs(0.0, 1.0).is_err());
    assert!(other.scale_springs(1.0, -1.0).is_err());
    assert!(other.scale_springs(1.0, f64::NAN).is_err());
    other.copy_springs(&own).unwrap();
    assert!(own.springs().eq(other.springs()));
    let chain = scene("chain").model.network().unwrap().clone();
    assert!(other.copy_springs(&chain).is_err());
}

#[test]
fn torn_springs_stay_torn_when_the_others_are_exchanged() {
    let own = scene("cloth").model.network().unwrap().clone();
    let mut torn = own.clone();
    torn.set_tear(Some(2.0)).unwrap();
    let mut x = scene("cloth").state[..3 * own.particles()].to_vec();
    x[399] += 1.0;
    assert!(torn.tear(&x, 0.0) > 0);
    let left = torn.springs().count();
    torn.copy_springs(&own).unwrap();
    assert_eq!(torn.springs().count(), left);
    assert!(torn.springs().all(|s| !torn.is_torn(s.i, s.j)));
}

/// With any method, a run after an adjustment has the same bits as a run that began with the
/// adjusted scene, even if the method had scratch for damped kicks.
#[test]
fn an_adjusted_run_is_that_of_the_adjusted_scene() {
    for method in integrators::METHODS.iter().filter(|m| !m.positions_only() && !m.plain_only()) {
        let change = |network: &mut Network| {
            network.scale_springs(2.0, 0.0).unwrap();
            network.set_gravity(Vector3::new(0.0, -3.0, 0.0));
        };
        let mut begun_so = scene("cloth");
        let a3_core::Model::Network(network) = &mut begun_so.model else { unreachable!() };
        change(network);
        let step = if method.is_adaptive() { 1e-4 } else { 0.001 };
        let mut expected = start(begun_so, method.name, step);
        let mut run = start(scene("cloth"), method.name, step);
        run.take_steps(3).unwrap();
        let (time, state) = (run.time(), run.state().to_vec());
        run.adjust(change);
        assert_eq!((run.time(), run.state()), (time, &state[..]));
        run.reset();
        run.take_steps(20).unwrap();
        expected.take_steps(20).unwrap();
        assert_eq!(run.state(), expected.state(), "{}", method.name);
        assert_eq!(run.work(), expected.work(), "{}", method.name);
    }
}

#[test]
fn a_change_acts_from_the_next_step_on() {
    for method in ["verlet", "rk4", "dopri5", "implicit"] {
        let mut run = start(scene("pendulum"), method, 0.001);
        run.advance_to(0.5).unwrap();
        let mut free = start(scene("pendulum"), method, 0.001);
        free.advance_to(0.5).unwrap();
        run.adjust(|network| network.set_gravity(Vector3::new(0.0, -1000.0, 0.0)));
        run.advance_to(0.501).unwrap();
        free.advance_to(0.501).unwrap();
        let fell = free.position(1).y - run.position(1).y;
        assert!(fell > 2e-4, "{method}: {fell}");
    }
}

#[test]
fn another_wind_blows_only_when_it_does() {
    let mut run = start(scene("cloth"), "rk4", 0.01);
    let strong = run.scene().wind.unwrap().scaled(2.0);
    run.change_wind(strong);
    assert!(!run.windy());
    run.set_wind(true);
    let now = *network(&run).wind().unwrap();
    assert_eq!(now, strong);
    let weak = run.scene().wind.unwrap().scaled(0.25);
    run.change_wind(weak);
    assert_eq!(*network(&run).wind().unwrap(), weak);
    run.reset();
    assert_eq!(*network(&run).wind().unwrap(), weak);
    let x = [0.3, 0.2, 0.1];
    let (was, is) = (strong.at(1.0, x), strong.scaled(0.5).at(1.0, x));
    assert!((was * 0.5 - is).norm() < 1e-15);
    let ahead = strong.ahead(2.5).at(1.0, x);
    assert!((ahead - strong.at(3.5, x)).norm() < 1e-14);
}

#[test]
fn pins_are_freed_and_hold_again_where_they_are() {
    let mut run = start(scene("cloth"), "rk4", 0.01);
    run.set_pinned(false);
    assert_eq!(network(&run).pins().count(), 0);
    let before = run.position(0).y;
    run.advance_to(0.3).unwrap();
    assert!(run.position(0).y < before - 0.2);
    run.reset();
    assert_eq!(network(&run).pins().count(), 0, "a reset leaves them free");
    run.advance_to(0.2).unwrap();
    // Pinning and unpinning everything leaves the grabbed particle in the hand.
    run.grab(3).unwrap();
    run.set_pinned(true);
    assert_eq!(network(&run).pins().count(), 20);
    let here = run.position(0);
    run.release();
    run.advance_to(0.5).unwrap();
    assert_eq!(run.position(0), here);
    assert!(network(&run).is_pinned(3));
    run.grab(3).unwrap();
    run.set_pinned(false);
    assert_eq!(run.grabbed(), Some(3));
    run.release();
    assert_eq!(network(&run).pins().count(), 0);
    assert!(!run.pinned());
}

/// Every scene, after all possible changes and a second of motion, continues from its description
/// after this was written and read.
#[test]
fn a_run_goes_on_from_its_description() {
    for entry in a3_scenes::SCENES {
        let (stiffness, damping, gusts) = (1.7, 0.6, 1.3);
        let scene = entry.build(None).unwrap().scene;
        // Sound limits the steps of fluids, and small differences grow soon where they splash.
        let flows = scene.model.network().is_some_and(|n| n.fluid().is_some());
        let (step, later) = if flows { (0.001, 0.05) } else { (0.005, 0.5) };
        let mut run = start(scene, "rk4", step);
        run.adjust(|network| {
            network.scale_springs(stiffness, damping).unwrap();
            network.set_gravity(Vector3::new(0.1, -7.0, 0.0));
            network.set_drag(0.013).unwrap();
            if matches!(network.obstacles(), [Obstacle { shape: Shape::Sphere { .. }, .. }, ..]) {
                let shape = Shape::Sphere { radius: 1.25 };
                network.reshape_obstacle(0, shape).unwrap();
            }
        });
        if let Some(wind) = run.scene().wind {
            run.change_wind(wind.scaled(gusts));
        }
        run.set_wind(true);
        run.set_swinging(true);
        run.advance_to(1.0).unwrap();

        let mut description = entry.description().unwrap();
        snapshot::scale_springs(&mut description, stiffness, damping);
        snapshot::scale_wind(&mut description, gusts);
        snapshot::begin_with(&mut description, run.model(), &run.moment());
        let text = description.to_toml().unwrap();
        let read = Description::parse(&text).unwrap();
        assert_eq!(read, description, "{}", entry.name);
        let scene = read.build(None, &mut |_| Err("none".into())).unwrap().scene;
        let mut again = start(scene, "rk4", step);

        assert_eq!(again.state(), run.state(), "{}", entry.name);
        let close = |what: &str, a: &[f64], b: &[f64], tolerance: f64| {
            for (a, b) in a.iter().zip(b) {
                assert!(
                    (a - b).abs() <= tolerance * a.abs().max(1.0),
                    "{what} of {}: {a} {b}",
                    entry.name
                );
            }
        };
        // Where surfaces touch, skins are recomputed for springs that were tuned.
        if run.model().network().is_some_and(|n| n.contact_layer().is_some()) {
            continue;
        }
        close("forces", &forces(&run), &forces(&again), 1e-12);
        run.advance_to(1.0 + later).unwrap();
        again.advance_to(later).unwrap();
        close("the state later", run.state(), again.state(), 1e-8);
    }
}

#[test]
fn what_was_freed_is_described_as_free() {
    let mut run = start(scene("cloth"), "rk4", 0.01);
    run.set_pinned(false);
    run.advance_to(0.1).unwrap();
    let mut description = a3_scenes::find("cloth").unwrap().description().unwrap();
    snapshot::begin_with(&mut description, run.model(), &run.moment());
    let scene = description.build(None, &mut |_| Err("none".into())).unwrap().scene;
    assert_eq!(scene.model.network().unwrap().pins().count(), 0);
}

/// Paths continue in a description: that of a pin in a straight line before, during and after its
/// motion, and that of a sphere.
#[test]
fn paths_go_on_from_where_they_are() {
    let text = "gravity = [0, -9.81, 0]
        chain = [{ particles = 3, from = [0, 0, 0], to = [1, 0, 0], mass = 1, stiffness = 50,
            pin = [{ at = ['first'], shift = { by = [0.4, 0, 0], start = 0.5, end = 1.5 } }] }]
        sphere = [{ center = [0, -3, 0], radius = 0.5, sine = { amplitude = [0, 0.5, 0], rate = 2, phase = 0.3 } }]";
    let build = |description: &Description| {
        description.build(None, &mut |_| Err("none".into())).unwrap().scene
    };
    let description = Description::parse(text).unwrap();
    for time in [0.2, 1.0, 2.0] {
        let mut run = start(build(&description), "rk4", 0.01);
        run.advance_to(time).unwrap();
        let mut now = description.clone();
        snapshot::begin_with(&mut now, run.model(), &run.moment());
        let again = build(&Description::parse(&now.to_toml().unwrap()).unwrap());
        let again = start(again, "rk4", 0.01);
        for later in [0.0, 0.1, 0.4, 0.9, 3.0] {
            let place = |run: &Simulation, t: f64| {
                let pin = network(run).pins().next().unwrap().1.at(t);
                let sphere = network(run).obstacles()[0].path.at(t);
                [pin.position, pin.velocity, sphere.position, sphere.velocity]
            };
            let (a, b) = (place(&run, run.time() + later), place(&again, later));
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).norm() < 1e-12, "{time} + {later}: {a} {b}");
            }
        }
    }
}

/// Moving boxes and capsules continue along their paths in a description, and buckling strips keep
/// their stiffness.
#[test]
fn obstacles_and_strips_go_on_too() {
    let text = "\
floor = { height = -20, friction = 0.7 }
box = [{ center = [0, -5, 0], size = [1, 2, 3], friction = 0.3, sine = { amplitude = [1, 0, 0], rate = 2 } }]
capsule = [{ from = [0, -9, 0], to = [1, -9, 0], radius = 0.1, friction = 2, shift = { by = [1, 2, 3], end = 4 } }]
sphere = [{ center = [0, -9, 5], radius = 1, friction = 0.1 }]

[[cloth]]
grid = [4, 5]
spacing = 0.1
mass = 0.01
stiffness = [10, 5, 2]
buckling = { bending = 0.0001, compression = 10 }
";
    let no_files = &mut |_: &str| Err(String::new());
    let mut description = Description::parse(text).unwrap();
    let mut run = start(description.build(None, no_files).unwrap().scene, "rk4", 0.01);
    run.adjust(|network| network.scale_springs(3.0, 1.0).unwrap());
    run.advance_to(1.5).unwrap();
    snapshot::scale_springs(&mut description, 3.0, 1.0);
    snapshot::begin_with(&mut description, run.model(), &run.moment());
    let again = start(description.build(None, no_files).unwrap().scene, "rk4", 0.01);
    let (now, then) = (network(&run), network(&again));
    for later in [0.0, 0.7, 9.0] {
        let paths = |network: &Network, t: f64| {
            let [_, cuboid, capsule, _] = network.obstacles() else {
                panic!("{:?}", network.obstacles());
            };
            let Shape::Capsule { ends, .. } = capsule.shape else {
                panic!("{capsule:?}");
            };
            let ends = ends.map(|end| end + capsule.path.at(t).position);
            [cuboid.path.at(t).position, ends[0], ends[1]]
        };
        for (a, b) in paths(now, 1.5 + later).iter().zip(paths(then, later)) {
            assert!((a - b).norm() < 1e-12, "{later}: {a} {b}");
        }
    }
    let [sphere, cuboid, capsule, floor] = then.obstacles() else {
        panic!("{:?}", then.obstacles());
    };
    let frictions = [sphere, cuboid, capsule, floor].map(|obstacle| obstacle.friction);
    assert_eq!(frictions, [0.1, 0.3, 2.0, 0.7]);
    assert_eq!([floor, sphere], [&now.obstacles()[3], &now.obstacles()[0]]);
    assert!(now.buckling().eq(then.buckling()));
}
