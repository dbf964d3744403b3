//! Coulomb friction: sticking, the acceleration of sliding, and obstacles that carry particles
//! along.

use std::slice;

use crate::common::{described, method, simulation};
use a3_core::contact::{Obstacle, Shape, Step, resolve};
use a3_core::integrators::METHODS;
use a3_core::{Control, Method, Model, Network, Path, Scene, Simulation, Vector3};

/// Acceleration down a slope of 30 degrees (m/s2) with mu = 0.3: g (sin - mu cos).
const DOWN: f64 = 9.81 * (0.5 - 0.3 * 0.866_025_403_784_438_6);

/// Cloth on a slope of 30 degrees: a floor with tilted gravity.
fn on_a_tilted_floor(mu: f64) -> Scene {
    let (sin, cos) = (30.0f64.to_radians().sin(), 30.0f64.to_radians().cos());
    described(&format!(
        "gravity = [{}, {}, 0]
        floor = {{ height = 0, friction = {mu} }}
        cloth = [{{ grid = [4, 5], spacing = 0.1, mass = 0.02, stiffness = [40, 20, 5], damping_ratio = 0.1,
            at = [0.037, 0, 0.3], down = [0, 0, 1] }}]",
        9.81 * sin,
        -9.81 * cos
    ))
}

/// The same cloth on the top of a turned box, 400 m long, with vertical gravity.
fn on_a_turned_box(mu: f64) -> Scene {
    let (sin, cos) = (30.0f64.to_radians().sin(), 30.0f64.to_radians().cos());
    described(&format!(
        "gravity = [0, -9.81, 0]
        box = [{{ center = [{}, {}, 0], size = [400, 2, 2], rotation = [0, 0, {}], friction = {mu} }}]
        cloth = [{{ grid = [4, 5], spacing = 0.1, mass = 0.02, stiffness = [40, 20, 5], damping_ratio = 0.1,
            at = [0, 0, 0.3], right = [{cos}, {}, 0], down = [0, 0, 1] }}]",
        -sin,
        -cos,
        -30.0f64.to_radians(),
        -sin
    ))
}

/// Block of soft jelly on the tilted floor, which has to settle first.
fn block(mu: f64) -> Scene {
    let (sin, cos) = (30.0f64.to_radians().sin(), 30.0f64.to_radians().cos());
    described(&format!(
        "gravity = [{}, {}, 0]
        floor = {{ height = 0, friction = {mu} }}
        jelly = [{{ grid = [4, 3, 3], size = [0.6, 0.2, 0.2], mass = 0.05, stiffness = [400, 200, 100],
            damping_ratio = 0.3, at = [0, 0.1, 0] }}]",
        9.81 * sin,
        -9.81 * cos
    ))
}

/// Fixed steps (s) that are stable on all of the scenes above, or tolerances of an adaptive method.
fn settings(method: &Method) -> [f64; 2] {
    if method.is_adaptive() && method.is_implicit() {
        // Each contact restarts at order 1, in steps that a fine tolerance makes tiny.
        [1e-2, 1e-3]
    } else if method.is_adaptive() {
        [1e-4, 1e-7]
    } else {
        [0.003, 0.001]
    }
}

fn middle(run: &Simulation) -> Vector3<f64> {
    let all = (0..run.particles()).map(|i| run.position(i));
    all.sum::<Vector3<f64>>() / run.particles() as f64
}

fn mean_velocity(run: &Simulation) -> Vector3<f64> {
    let (n, v) = (run.particles(), run.velocities());
    Vector3::from_fn(|axis, _| v[axis * n..(axis + 1) * n].iter().sum::<f64>() / n as f64)
}

/// Largest distance of a particle from where it was (m).
fn moved(run: &Simulation, from: &[f64]) -> f64 {
    let n = run.particles();
    let from = |i: usize| Vector3::new(from[i], from[n + i], from[2 * n + i]);
    (0..n).map(|i| (run.position(i) - from(i)).norm()).fold(0.0, f64::max)
}

#[test]
fn with_enough_friction_nothing_moves() {
    for scene in [on_a_tilted_floor(0.6), on_a_turned_box(0.6)] {
        let serving = |method: &&Method| method.check(scene.model.system()).is_ok();
        for method in METHODS.iter().filter(serving) {
            for setting in settings(method) {
                let mut run =
                    Simulation::new(scene.clone(), method, method.control(setting)).unwrap();
                while run.time() < 10.0 {
                    // The run continues to the end of a step: within a step, the state of an
                    // adaptive method falls freely.
                    run.take_steps(1).unwrap();
                }
                let moved = moved(&run, &scene.state);
                assert!(moved < 1e-12, "{} {setting}: {moved:e}", method.name);
            }
        }
    }
}

#[test]
fn with_little_friction_it_slides_as_coulomb_says() {
    for scene in [on_a_tilted_floor(0.3), on_a_turned_box(0.3)] {
        let serving = |method: &&Method| method.check(scene.model.system()).is_ok();
        for method in METHODS.iter().filter(serving) {
            for setting in settings(method) {
                let mut run =
                    Simulation::new(scene.clone(), method, method.control(setting)).unwrap();
                let from = middle(&run);
                while run.time() < 8.0 {
                    run.take_steps(1).unwrap();
                }
                let (t, way) = (run.time(), (middle(&run) - from).norm());
                let found = mean_velocity(&run).norm() / t;
                let both = [found, 2.0 * way / (t * t)];
                for found in both {
                    assert!(
                        (found / DOWN - 1.0).abs() < 1e-3,
                        "{} {setting}: {found}",
                        method.name
                    );
                }
            }
        }
    }
}

#[test]
fn a_block_stands_on_a_slope_or_slides_down() {
    for name in ["rk4", "verlet", "pefrl", "dopri5", "implicit-midpoint", "trbdf2"] {
        let method = method(name);
        let setting = if method.is_adaptive() { 1e-4 } else { 0.002 };
        let mut run = Simulation::new(block(0.6), method, method.control(setting)).unwrap();
        while run.time() < 10.0 {
            run.take_steps(1).unwrap();
        }
        let from = run.state().to_vec();
        while run.time() < 20.0 {
            run.take_steps(1).unwrap();
        }
        let moved = moved(&run, &from);
        // At the limit of its steps, an adaptive method keeps particles without contact from full
        // rest.
        let rest = if method.is_adaptive() { 1e-6 } else { 1e-12 };
        assert!(moved < rest, "{name}: {moved:e}");
        let mut run = Simulation::new(block(0.3), method, method.control(setting)).unwrap();
        let speed = |run: &mut Simulation, time: f64| {
            run.advance_to(time).unwrap();
            run.take_steps(1).unwrap();
            (run.time(), mean_velocity(run).x)
        };
        let (first, last) = (speed(&mut run, 2.0), speed(&mut run, 8.0));
        let found = (last.1 - first.1) / (last.0 - first.0);
        assert!((found / DOWN - 1.0).abs() < 1e-3, "{name}: {found}");
    }
}

fn particle(obstacle: Obstacle, x: Vector3<f64>, v: Vector3<f64>) -> Scene {
    let mut network = Network::new(vec![0.3]).unwrap();
    network.add_obstacle(obstacle).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let state = [x.as_slice(), v.as_slice()].concat();
    Scene::new("particle", Model::Network(Box::new(network)), state)
}

/// Conveyors that move along x at 2 m/s: a box that is 2 m high, and a floor.
fn conveyors() -> [Obstacle; 2] {
    let path = |height: f64| Path::Line {
        from: Vector3::new(0.0, height, 0.0),
        to: Vector3::new(100.0, height, 0.0),
        start: 0.0,
        end: 50.0,
    };
    let shape = Shape::turned_box(Vector3::new(20.0, 1.0, 1.0), Vector3::zeros()).unwrap();
    [(shape, -1.0), (Shape::Floor, 0.0)]
        .map(|(shape, height)| Obstacle { friction: 0.5, ..Obstacle::smooth(shape, path(height)) })
}

/// A conveyor accelerates a particle by mu g until the particle sticks to it.
#[test]
fn a_conveyor_carries_a_particle_along() {
    let g = 9.81;
    for conveyor in conveyors() {
        for name in ["symplectic-euler", "rk4", "pefrl", "dopri5"] {
            let method = method(name);
            let setting = if method.is_adaptive() { 1e-6 } else { 0.001 };
            let scene = particle(conveyor.clone(), Vector3::zeros(), Vector3::zeros());
            let mut run = Simulation::new(scene, method, method.control(setting)).unwrap();
            run.advance_to(0.2).unwrap();
            run.take_steps(1).unwrap();
            let speed = run.velocities()[0];
            let expected = 0.5 * g * run.time();
            assert!((speed / expected - 1.0).abs() < 1e-9, "{name}: {speed}");
            run.advance_to(1.0).unwrap();
            run.take_steps(1).unwrap();
            assert_eq!(run.velocities(), [2.0, 0.0, 0.0], "{name}");
            let (before, at) = (run.time(), run.position(0).x);
            // While it slid, the particle fell behind by v^2 / (2 mu g).
            let lag = 2.0 * before - at;
            assert!((lag / (4.0 / g) - 1.0).abs() < 0.01, "{name}: {lag}");
            run.advance_to(5.0).unwrap();
            run.take_steps(1).unwrap();
            let way = run.position(0).x - at;
            assert!((way - 2.0 * (run.time() - before)).abs() < 1e-10, "{name}: {way}");
        }
    }
}

/// A particle that hits a floor within a step, and that friction stops at once, stops at the point
/// of the impact.
#[test]
fn after_an_impact_a_particle_stops_where_it_should() {
    let floor =
        Obstacle { friction: 0.5, ..Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros())) };
    // The particle falls for 0.1 s and moves 0.1 m along x in that time. Friction stops it at once.
    let (x, v) = (Vector3::new(0.0, 0.3 + 0.5 * 9.81 * 0.01, 0.0), Vector3::new(1.0, -3.0, 0.0));
    for h in [0.07, 0.013, 0.001] {
        let run = Simulation::new(particle(floor.clone(), x, v), method("rk4"), Control::Step(h));
        let mut run = run.unwrap();
        run.advance_to(0.5).unwrap();
        assert_eq!(run.velocities(), [0.0; 3]);
        // The path within a step is curved, which gives an error of second order.
        let off = (run.position(0).x - 0.1).abs();
        assert!(off < h * h, "{h}: {off:e}");
    }
}

#[test]
fn a_moving_sphere_drags_cloth_along() {
    let drape = |friction: f64| {
        let scene = described(&format!(
            "gravity = [0, -9.81, 0]
            drag_per_mass = 0.5
            sphere = [{{ center = [0, 0, 0], radius = 0.5, friction = {friction},
                shift = {{ by = [0.6, 0, 0], start = 1, end = 2 }} }}]
            cloth = [{{ grid = [13, 13], spacing = 0.1, density = 0.3, stiffness = [60, 30, 5], damping_ratio = 0.2,
                at = [0, 0.55, -0.6], down = [0, 0, 1] }}]"
        ));
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.002)).unwrap();
        run.advance_to(2.0).unwrap();
        middle(&run)
    };
    let (smooth, rough) = (drape(0.0), drape(0.8));
    assert!((rough.x - 0.6).abs() < 0.1, "{rough}");
    assert!(rough.x - smooth.x > 0.1, "{smooth} {rough}");
}

/// Contact never adds kinetic energy relative to an obstacle at rest. It changes the tangential
/// velocity by at most mu times the change of the normal velocity, and by less only where no
/// tangential velocity is left.
#[test]
fn contact_takes_energy_and_gives_none() {
    let shapes = [
        Shape::Sphere { radius: 0.9 },
        Shape::turned_box(Vector3::new(0.8, 0.5, 0.7), Vector3::new(0.3, 0.2, -0.9)).unwrap(),
        Shape::Capsule {
            ends: [Vector3::new(-0.5, 0.1, 0.0), Vector3::new(0.6, 0.0, 0.2)],
            radius: 0.5,
        },
        Shape::Floor,
    ];
    let place = Path::Still(Vector3::new(0.1, -0.05, 0.02));
    let number = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 23) - 1.0;
    let (mut met, mut stuck, mut slid) = (0, 0, 0);
    for shape in shapes {
        for friction in [0.0, 0.2, 1.0, 100.0] {
            let obstacle = Obstacle { friction, ..Obstacle::smooth(shape.clone(), place) };
            for k in 0..500 {
                let y0: Vec<f64> = (0..6).map(|a| number(6 * k + a)).collect();
                let h = 0.1;
                let mut y1 = y0.clone();
                for a in 0..3 {
                    y1[a] += h * y0[3 + a];
                }
                let free = y1.clone();
                let step = Step { t: 0.3, h, y0: &y0 };
                let found = resolve(slice::from_ref(&obstacle), &[2.0], &step, &mut y1);
                if found.contacts == 0 {
                    assert_eq!(y1, free);
                    continue;
                }
                met += 1;
                let vector = |y: &[f64]| Vector3::from_column_slice(y);
                let (before, after) = (vector(&free[3..]), vector(&y1[3..]));
                assert!(after.norm() <= before.norm() * (1.0 + 1e-15));
                let taken = before - after;
                assert!((found.impulse - 0.5 * taken.norm()).abs() < 1e-15);
                // Without friction, the velocity changes along the normal only.
                let mut smooth = free.clone();
                resolve(
                    &[Obstacle { friction: 0.0, ..obstacle.clone() }],
                    &[2.0],
                    &step,
                    &mut smooth,
                );
                let across = before - vector(&smooth[3..]);
                let along = taken - across;
                assert!(along.dot(&across).abs() < 1e-14);
                assert!(along.norm() <= friction * across.norm() + 1e-14);
                if friction > 0.0 && across.norm() > 1e-9 {
                    let left = vector(&smooth[3..]) - along;
                    let sticks = left.norm() < 1e-14;
                    stuck += u32::from(sticks);
                    slid += u32::from(!sticks);
                    let short = along.norm() < friction * across.norm() - 1e-12;
                    assert!(sticks || !short, "less than friction could take: {along}");
                }
            }
        }
    }
    assert!(met > 1000 && stuck > 100 && slid > 100, "{met} {stuck} {slid}");
}

/// Friction of 0 gives the same bits as no friction.
#[test]
fn without_friction_nothing_changes() {
    let text = |friction: &str, floor: &str| {
        described(&format!(
            "gravity = [0, -9.81, 0]
            floor = {floor}
            sphere = [{{ center = [0, 0, 0], radius = 0.5{friction} }}]
            cloth = [{{ grid = [8, 8], spacing = 0.1, density = 0.3, stiffness = [60, 30, 5], damping_ratio = 0.2,
                at = [0.1, 0.55, -0.3], down = [0, 0, 1] }}]"
        ))
    };
    let run = |scene: Scene| {
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.002)).unwrap();
        run.advance_to(1.5).unwrap();
        assert!(run.contact().contacts > 5);
        run.state().to_vec()
    };
    let without = run(text("", "-0.6"));
    assert_eq!(run(text(", friction = 0", "{ height = -0.6 }")), without);
    assert_ne!(run(text(", friction = 0.1", "-0.6")), without);
    assert_ne!(run(text("", "{ height = -0.6, friction = 0.1 }")), without);
}

/// A particle at rest on the ground does not sink between the ends of an adaptive method's steps.
#[test]
fn between_steps_nothing_sinks_visibly() {
    let floor = Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros()));
    for name in ["dopri5", "dop853", "fehlberg"] {
        for tolerance in [1e-2, 1e-4, 1e-8] {
            let scene = particle(floor.clone(), Vector3::new(0.0, 1.0, 0.0), Vector3::zeros());
            let control = Control::Tolerance(tolerance);
            let mut run = Simulation::new(scene, method(name), control).unwrap();
            for frame in 1..=300 {
                run.advance_to(f64::from(frame) / 60.0).unwrap();
                let lowest = run.lowest();
                assert!(lowest > -1e-3, "{name} {tolerance}: {lowest:e}");
            }
            assert!(run.steps() < 1000, "{}", run.steps());
        }
    }
    let mut run = simulation("jelly", "dopri5", 1e-3);
    for frame in 1..=180 {
        run.advance_to(f64::from(frame) / 60.0).unwrap();
        assert!(run.lowest() > -2e-3, "{:e}", run.lowest());
    }
}
