//! Orders of convergence of bounces by the force of contact: each method's own, up to about 4,
//! since the third derivative of the force jumps where it begins.

use a3_core::accuracy::{Frames, Metric, Precision, Reference, Scope, choose};
use a3_core::contact::{Obstacle, Shape, Skin};
use a3_core::{Method, Network, Path, Touch, Vector3, integrators};

use crate::common::{described, distance, method};

/// Length of all runs (s).
const UNTIL: f64 = 1.0;

/// A particle above a floor, or a particle above a free triangle, with gravity and a little drag.
fn system(on_floor: bool) -> (Network, Vec<f64>) {
    let skin =
        Skin { thickness: 0.2, stiffness: 600.0, damping: 0.0, friction: 0.0, ..Skin::default() };
    let count = if on_floor { 1 } else { 4 };
    let mut network = Network::new(vec![1.0; count]).unwrap();
    if on_floor {
        let floor = Obstacle {
            thickness: 0.2,
            ..Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros()))
        };
        network.add_obstacle(floor).unwrap();
        network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    } else {
        network.set_triangles([[1, 2, 3]]).unwrap();
    }
    network.set_drag(0.3).unwrap();
    let touch =
        Touch { skins: vec![skin; count], edges: vec![[0, 0]], drops: vec![], bodies: true };
    network.set_touch(Some(touch)).unwrap();
    let places = [[0.0, 0.35, 0.0], [1.0, 0.0, 0.1], [-0.6, 0.05, 0.9], [-0.5, 0.0, -0.8]];
    let mut y = vec![0.0; 6 * count];
    for (i, place) in places[..count].iter().enumerate() {
        for axis in 0..3 {
            y[axis * count + i] = place[axis];
        }
    }
    if on_floor {
        y[3] = 0.2;
    } else {
        y[3 * count] = 0.1;
        y[4 * count] = -0.9;
    }
    (network, y)
}

/// Bounce, with the times (s) between 0 and [`UNTIL`] at which the touch begins and ends, and its
/// state then.
struct Bounce {
    network: Network,
    y0: Vec<f64>,
    moments: Vec<f64>,
    exact: Vec<f64>,
}

impl Bounce {
    /// Bounce by a Nyström method of order 8, whose steps end where touches begin and end.
    fn new(on_floor: bool) -> Self {
        let (network, y0) = system(on_floor);
        let layer = network.contact_layer().unwrap();
        let touches = |y: &[f64]| layer.penetration(0.0, &y[..y.len() / 2]) > 0.0;
        let after = |t: f64, y: &[f64]| steps(&network, method("dprkn86"), y, 1, t);
        let (mut moments, mut y) = (vec![0.0], y0.clone());
        for k in 0..2000 {
            let [mut t, end] = [k, k + 1].map(|k| UNTIL * f64::from(k) / 2000.0);
            if touches(&after(end - t, &y)) != touches(&y) {
                let (mut low, mut high) = (0.0, end - t);
                for _ in 0..60 {
                    let middle = f64::midpoint(low, high);
                    if touches(&after(middle, &y)) == touches(&y) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                y = after(high, &y);
                t += high;
                moments.push(t);
            }
            y = after(end - t, &y);
        }
        moments.push(UNTIL);
        Self { network, y0, moments, exact: y }
    }

    /// Error of a run in `count` steps, regardless of touches.
    fn error(&self, method: &Method, count: u32) -> f64 {
        distance(&steps(&self.network, method, &self.y0, count, UNTIL), &self.exact)
    }

    /// Error of a run in `count` steps in each part between touches.
    fn error_in_parts(&self, method: &Method, count: u32) -> f64 {
        let mut y = self.y0.clone();
        for part in self.moments.windows(2) {
            y = steps(&self.network, method, &y, count, part[1] - part[0]);
        }
        distance(&y, &self.exact)
    }

    /// Order from the root mean squares of the errors at `samples` counts of steps from `fewest`
    /// on, and at `ratio` times these counts: single errors vary with the place in a step where a
    /// touch begins. Each is multiplied by its count to the fourth power, so that all have equal
    /// weight.
    fn order(&self, method: &Method, [samples, fewest, ratio]: [u32; 3]) -> f64 {
        let counts = || fewest..fewest + samples;
        let mean = |more: u32| {
            let squares =
                counts().map(|n| (self.error(method, more * n) * f64::from(n).powi(4)).powi(2));
            squares.sum::<f64>().sqrt()
        };
        (mean(1) / mean(ratio)).ln() / f64::from(ratio).ln()
    }
}

/// State after `count` steps over a time (s).
fn steps(network: &Network, method: &Method, y0: &[f64], count: u32, time: f64) -> Vec<f64> {
    let mut integrator = method.integrator(network).unwrap();
    let (mut y, h) = (y0.to_vec(), time / f64::from(count));
    for k in 0..count {
        integrator.step(network, f64::from(k) * h, h, &mut y).unwrap();
    }
    y
}

#[test]
fn methods_keep_their_order_up_to_four() {
    for on_floor in [true, false] {
        let bounce = Bounce::new(on_floor);
        for m in integrators::METHODS {
            if m.check(&bounce.network).is_err() {
                continue;
            }
            // The classical Runge-Kutta method needs short steps, above all on a floor: in longer
            // ones, its errors of smooth motion and of touches cancel. The other methods of order 4
            // and more soon reach double precision.
            let shortest = if on_floor { 3200 } else { 800 };
            let (measured, own) = match m.order {
                order @ 1..=2 => ([1, 4000, 2], f64::from(order)..=f64::from(order)),
                4 if m.name == "rk4" => ([24, shortest, 4], 4.0..=4.0),
                // In long steps, the error of smooth motion, of order 5, is the larger one.
                5 => ([96, 100, 4], 4.0..=5.0),
                _ => ([96, 100, 4], 3.9..=4.1),
            };
            let found = bounce.order(m, measured);
            assert!(
                (own.start() - 0.1..own.end() + 0.1).contains(&found),
                "{}, on a floor: {on_floor}: order {found:.3}, not {own:?}",
                m.name
            );
        }
    }
}

/// Only the step across the beginning or the end of a touch limits the order.
#[test]
fn steps_that_end_where_touches_do_keep_every_order() {
    for on_floor in [true, false] {
        let bounce = Bounce::new(on_floor);
        for (name, count) in [("verner65", 24), ("srkn11", 12), ("dop853", 8), ("dprkn86", 8)] {
            let m = method(name);
            let order =
                (bounce.error_in_parts(m, count) / bounce.error_in_parts(m, 2 * count)).log2();
            assert!(
                order > f64::from(m.order) - 0.3,
                "{name}, on a floor: {on_floor}: order {order:.2}"
            );
        }
    }
}

/// The scene of the chart in docs/methods.md: its reference is certain, the safeguard acts in no
/// run with these steps, and the chosen method meets its error.
#[test]
fn the_chart_of_a_bounce_has_a_sure_reference() {
    let scene = described(include_str!("../../../../docs/scenes/bounce.toml"));
    let precision = Precision { metric: Metric::Position, uncertainty: 1e-10, max_work: 80_000.0 };
    let (frames, scope, go_on) = (Frames::new(UNTIL), Scope::default(), || true);
    let reference = Reference::new(&scene, frames, scope, precision, &go_on).unwrap().unwrap();
    assert!(reference.floor.position < 1e-9, "{:e} m", reference.floor.position);
    let best = choose(&scene, &reference, Metric::Position, 1e-4, &go_on, |_| ()).unwrap().unwrap();
    let outcome = best[0].outcome;
    assert!(outcome.errors.position <= 1e-4, "{:e} m", outcome.errors.position);
    assert_eq!(outcome.guarded.impulses, 0);
}
