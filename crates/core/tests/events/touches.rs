//! First contact of particles with obstacles.

use crate::common::{described, method};
use a3_core::Vector3;
use a3_core::contact::Shape;
use a3_core::integrators::METHODS;
use a3_core::{Control, Method, Simulation};

/// State of a scene at a time (s), by a method at a step or a tolerance.
fn after(toml: &str, method: &'static Method, value: f64, until: f64) -> Simulation {
    let mut run = Simulation::new(described(toml), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    run
}

fn adaptive() -> impl Iterator<Item = &'static Method> {
    METHODS.iter().filter(|method| method.is_adaptive() && !method.plain_only())
}

const SLOPE: &str = "
    gravity = [0, -9.81, 0]
    [particles]
    positions = [[0, 1, 0]]
    mass = 1
    [[box]]
    center = [-0.49999999999999994, -0.8660254037844387, 0]
    size = [60, 2, 4]
    rotation = [0, 0, -0.5235987755982988]
";

/// A particle falls 1 m onto a smooth slope of 30 degrees, loses its velocity along the normal, and
/// slides on.
#[test]
fn a_particle_falls_on_a_slope_and_slides() {
    let end = Vector3::new(4.345_823_729, -2.509_062_5, 0.0);
    let apart = |method, value| (after(SLOPE, method, value, 1.5).position(0) - end).norm();
    for method in adaptive().filter(|method| method.name != "bdf") {
        for tolerance in [1e-2, 1e-5, 1e-8] {
            let apart = apart(method, tolerance);
            assert!(apart < 1e-8, "{} {tolerance}: {apart}", method.name);
        }
    }
    for tolerance in [1e-3, 1e-5, 1e-7] {
        let apart = apart(method("bdf"), tolerance);
        assert!(apart < 3.0 * tolerance, "bdf {tolerance}: {apart}");
    }
    for name in ["trapezoid", "rk4", "verlet", "pefrl", "implicit-midpoint"] {
        let apart = apart(method(name), 0.01);
        assert!(apart < 1e-8, "{name}: {apart}");
    }
}

/// A particle that falls onto the top of a sphere of 2 m stays there.
#[test]
fn a_particle_stays_on_a_sphere() {
    let toml = "
        gravity = [0, -9.81, 0]
        [particles]
        positions = [[0, 2, 0]]
        mass = 1
        [[sphere]]
        center = [0, -2, 0]
        radius = 2
    ";
    for method in adaptive() {
        for tolerance in [1e-2, 1e-6] {
            let end = after(toml, method, tolerance, 3.0).position(0);
            let height = (end - Vector3::new(0.0, -2.0, 0.0)).norm() - 2.0;
            assert!(height.abs() < 1e-9, "{} {tolerance}: {end}", method.name);
        }
    }
}

/// A sphere flies through the place of a particle that hangs at rest, after ten seconds without any
/// motion: all methods agree on where it throws the particle.
#[test]
fn a_sphere_that_passes_after_a_rest_throws_what_hangs_there() {
    let toml = "
        gravity = [0, -10, 0]
        [particles]
        positions = [[0, 2, 0], [0, 0.6, 0]]
        mass = 1
        springs = [[0, 1, 25, 1, 0]]
        pin = [{ particles = [0] }]
        [[sphere]]
        center = [-5, 0.5, 0]
        radius = 0.5
        shift = { by = [10, 0, 0], start = 10, end = 11 }
    ";
    let accurate = after(toml, method("dop853"), 1e-10, 12.0).position(1);
    assert!((accurate - Vector3::new(0.0, 0.6, 0.0)).norm() > 0.5, "{accurate}");
    for method in adaptive().filter(|method| method.check(described(toml).model.system()).is_ok()) {
        let end = after(toml, method, 1e-5, 12.0).position(1);
        assert!((end - accurate).norm() < 5e-3, "{}: {end} {accurate}", method.name);
    }
    let fixed = after(toml, method("rk4"), 5e-5, 12.0).position(1);
    assert!((fixed - accurate).norm() < 5e-3, "{fixed} {accurate}");
}

/// Fast, thin, small and moving obstacles, at random: at no tolerance is a particle inside one at
/// the end of a step, or past it.
#[test]
fn no_particle_passes_through_what_moves_small_and_fast() {
    let mut seed = 20_u64;
    let mut random = move |low: f64, high: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((seed >> 11) as f64 / (1u64 << 53) as f64)
    };
    let mut touched = 0;
    for k in 0..300 {
        // A plate that is at y = 0 when the particle arrives there, at t = 1.
        let thick = 10f64.powf(random(-4.0, -1.0));
        let (speed, lift) = (random(-3.0, 3.0), random(-2.0, 2.0));
        let toml = format!(
            "gravity = [0, {}, 0]
            [particles]
            positions = [[0, 0, 0]]
            mass = 1
            [state]
            positions = [[0, 0, 0]]
            velocities = [[{speed}, 0, 0]]
            [[box]]
            center = [{}, {}, 0]
            size = [4, {thick}, 4]
            sine = {{ amplitude = [0, {}, 0], rate = {}, phase = {} }}",
            random(-12.0, -2.0),
            0.5 * speed,
            random(-3.0, -1.0) - thick,
            0.3 * lift,
            random(0.1, 8.0),
            random(0.0, 6.0),
        );
        let tolerance = 10f64.powf(random(-8.0, -1.0));
        let method = adaptive().nth(k % 4).unwrap();
        let scene = described(&toml);
        let mut run = Simulation::new(scene, method, Control::Tolerance(tolerance)).unwrap();
        let mut above = true;
        while run.time() < 1.5 {
            run.take_steps(1).unwrap();
            let network = run.model().network().unwrap();
            let obstacle = &network.obstacles()[0];
            let Shape::Box { half_extents, .. } = obstacle.shape else { unreachable!() };
            let d = run.position(0) - obstacle.path.at(run.time()).position;
            // Until it slides off the side of the plate.
            if d.x.abs() > half_extents.x - 1e-3 {
                above = false;
            }
            touched += u32::from(above && d.y < half_extents.y + 1e-9);
            assert!(
                !above || d.y > half_extents.y - 1e-8,
                "{} {tolerance}: {d} at {} in {toml}",
                method.name,
                run.time()
            );
        }
    }
    assert!(touched > 500, "{touched}");
}
