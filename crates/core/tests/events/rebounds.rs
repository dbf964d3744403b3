//! Rebounds from spheres, capsules, turned boxes and moving obstacles, against closed forms.

use crate::common::{described, method};
use a3_core::integrators::METHODS;
use a3_core::{Control, Simulation, Vector3};

const G: Vector3<f64> = Vector3::new(0.0, -9.81, 0.0);
const RESTITUTION: f64 = 0.6;

/// Signed distance of a point from an obstacle at a time (s), and the normal there.
type Surface = fn(Vector3<f64>, f64) -> (f64, Vector3<f64>);

struct Case {
    obstacle: &'static str,
    surface: Surface,
    /// Velocity of the obstacle (m/s).
    moves: Vector3<f64>,
    x: Vector3<f64>,
    v: Vector3<f64>,
}

fn round(from: Vector3<f64>, radius: f64) -> (f64, Vector3<f64>) {
    (from.norm() - radius, from.normalize())
}

fn cases() -> [Case; 4] {
    [
        Case {
            obstacle: "sphere = [{ center = [0, 0, 0], radius = 1.2, restitution = 0.6 }]",
            surface: |x, _| round(x, 1.2),
            moves: Vector3::zeros(),
            x: Vector3::new(0.5, 2.0, 0.0),
            v: Vector3::zeros(),
        },
        Case {
            obstacle: "capsule = [{ from = [-1, 0, 0], to = [1, 0.5, 0], radius = 0.4, restitution = 0.6 }]",
            surface: |x, _| {
                let (from, along) = (Vector3::new(-1.0, 0.0, 0.0), Vector3::new(2.0, 0.5, 0.0));
                let share = (x - from).dot(&along) / along.norm_squared();
                round(x - from - along * share.clamp(0.0, 1.0), 0.4)
            },
            moves: Vector3::zeros(),
            x: Vector3::new(0.3, 1.7, 0.05),
            v: Vector3::new(0.2, -1.0, 0.3),
        },
        Case {
            obstacle: "box = [{ center = [0, 0, 0], size = [4, 1, 4], rotation = [0, 0, -0.5], restitution = 0.6 }]",
            surface: |x, _| {
                let normal = Vector3::new(0.5f64.sin(), 0.5f64.cos(), 0.0);
                (x.dot(&normal) - 0.5, normal)
            },
            moves: Vector3::zeros(),
            x: Vector3::new(0.2, 1.6, 0.0),
            v: Vector3::new(0.4, 0.0, 0.3),
        },
        Case {
            obstacle: "sphere = [{ center = [0, 0, 0], radius = 1, restitution = 0.6,
                shift = { by = [0, 3, 0], end = 3 } }]",
            surface: |x, t| round(x - Vector3::new(0.0, t, 0.0), 1.0),
            moves: Vector3::new(0.0, 1.0, 0.0),
            x: Vector3::new(0.4, 3.0, 0.0),
            v: Vector3::zeros(),
        },
    ]
}

/// Position and velocity 0.05 s after the first impact, and that time (s).
fn exact(case: &Case) -> (f64, Vector3<f64>, Vector3<f64>) {
    let at = |t: f64| case.x + case.v * t + G * (0.5 * t * t);
    let (mut low, mut high) = (0.0, 0.0);
    while (case.surface)(at(high), high).0 > 0.0 {
        (low, high) = (high, high + 1e-3);
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        let is_apart = (case.surface)(at(middle), middle).0 > 0.0;
        *(if is_apart { &mut low } else { &mut high }) = middle;
    }
    let (t, normal) = (low, (case.surface)(at(low), low).1);
    let v = case.v + G * t;
    let approach = (v - case.moves).dot(&normal);
    let v = v - normal * ((1.0 + RESTITUTION) * approach);
    let h = 0.05;
    (t + h, at(t) + v * h + G * (0.5 * h * h), v + G * h)
}

#[test]
fn rebounds_have_their_closed_forms() {
    for case in cases() {
        let vector = |v: Vector3<f64>| format!("[{}, {}, {}]", v.x, v.y, v.z);
        let toml = format!(
            "gravity = [0, -9.81, 0]
            {}
            [particles]
            positions = [{}]
            velocities = [{}]
            mass = 1",
            case.obstacle,
            vector(case.x),
            vector(case.v),
        );
        let (until, x, v) = exact(&case);
        let off = |name: &str, value: f64| {
            let method = method(name);
            let scene = described(&toml);
            let mut run = Simulation::new(scene, method, method.control(value)).unwrap();
            run.advance_to(until).unwrap();
            let found = Vector3::from_column_slice(&run.velocities());
            (run.position(0) - x).norm().max((found - v).norm())
        };
        for method in METHODS.iter().filter(|method| method.is_adaptive() && !method.plain_only()) {
            for k in 2..=9 {
                // The distance at which a touch counts, and BDF's own errors.
                let tolerance = 0.1f64.powi(k);
                let most = if method.name == "bdf" { 30.0 * tolerance } else { 1e-6 };
                let off = off(method.name, tolerance);
                assert!(off < most, "{} {tolerance:e}: {off:e}\n{toml}", method.name);
            }
        }
        for name in ["rk4", "verlet", "trapezoid"] {
            let off = off(name, 1e-3);
            assert!(off < 1e-5, "{name}: {off:e}\n{toml}");
        }
    }
}

/// A box that begins to rise at once strikes what lies on it, by every method.
#[test]
fn a_box_that_begins_to_rise_strikes_what_lies_on_it() {
    for restitution in [0.0, 0.5, 1.0] {
        let scene = format!(
            "gravity = [0, -9.81, 0]
            [[box]]
            center = [0, 0.25, 0]
            size = [2, 0.5, 2]
            restitution = {restitution}
            shift = {{ by = [0, 1, 0], start = 0.5, end = 1.0 }}
            [particles]
            positions = [[0, 0.5, 0]]
            mass = 1"
        );
        let fixed = [("rk4", 1e-3), ("rk4", 7e-4), ("verlet", 1e-2), ("implicit", 1e-3)];
        let fixed = fixed.map(|(name, step)| (name, Control::Step(step)));
        for (name, control) in fixed.into_iter().chain([("dopri5", Control::Tolerance(1e-6))]) {
            let mut run = Simulation::new(described(&scene), method(name), control).unwrap();
            run.advance_to(0.51).unwrap();
            let falls = if restitution > 0.0 { 0.0981 } else { 0.0 };
            let expected = 2.0 * (1.0 + restitution) - falls;
            let found = run.velocities()[1];
            assert!(
                (found - expected).abs() < 1e-3,
                "{name} {control:?}, e {restitution}: {found}, {expected}"
            );
        }
    }
}
