//! What the camera takes in: all that is there now, or all that moves.

use std::sync::Arc;

use a3_core::stability::Budget;
use a3_core::{Network, Simulation, Vector3};
use a3_render::Camera;
use a3_scenes::{Presentation, Viewpoint, surroundings};

use super::picture::camera;
use super::vectors::to_f32;

/// Time between two looks at a motion (s).
const SEEN_EVERY: f64 = 1.0 / 30.0;
/// Work of a run whose motion is looked at: about 0.1 s of processor time.
const WORK: f64 = 3e6;
/// Largest radius of a motion that is taken in, over the radius of the scene at its start: what
/// goes farther leaves the picture.
const MOST: f64 = 30.0;

/// A box along the axes (m).
#[derive(Clone, Copy)]
struct Bounds {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Bounds {
    /// Returns the box around particles and bodies of some runs. Liquid that has flowed out is not
    /// looked for.
    fn of<'a>(runs: impl IntoIterator<Item = &'a Simulation>) -> Self {
        let mut bounds =
            Self { low: Vector3::repeat(f64::INFINITY), high: Vector3::repeat(f64::NEG_INFINITY) };
        for run in runs {
            let network = run.model().network();
            let fluid = network.and_then(Network::fluid);
            let has_left = |i: &usize| fluid.is_some_and(|fluid| fluid.members().has_left(*i));
            let seen = (0..run.particles()).filter(|i| !has_left(i));
            let bodies = network.into_iter().flat_map(Network::bodies);
            let bodies = bodies.map(|body| (body.center(), body.radius()));
            for (i, radius) in seen.map(|i| (i, 0.0)).chain(bodies) {
                let at = run.position(i);
                bounds.low = bounds.low.inf(&at.add_scalar(-radius));
                bounds.high = bounds.high.sup(&at.add_scalar(radius));
            }
        }
        bounds
    }

    fn middle(&self) -> Vector3<f64> {
        0.5 * (self.low + self.high)
    }

    /// Returns the radius of the ball around the box.
    fn radius(&self) -> f64 {
        0.5 * (self.high - self.low).norm()
    }
}

/// Moves the camera, without turning it, so that all particles and bodies of all runs are visible,
/// and the obstacles and the floor near them.
pub fn see_all<'a>(camera: &mut Camera, runs: impl Iterator<Item = &'a Simulation> + Clone) {
    let bounds = Bounds::of(runs.clone());
    // Particles are drawn as balls: those at the edge of the picture need room, too.
    let radius = bounds.radius() + 0.1 * f64::from(camera.unit());
    let (middle, radius) = runs
        .fold((bounds.middle(), radius), |ball, run| surroundings(run.model(), run.time(), ball));
    camera.see(to_f32(middle), radius as f32);
}

/// Moves the camera that first shows a scene, without turning it, so that the motion of a run from
/// its start until a time (s) fills most of the picture, as far as a short computation gets.
pub fn see_motion(presentation: &mut Arc<Presentation>, mut run: Simulation, until: f64) {
    let budget = Budget::new(WORK);
    let (_, radius) = run.scene().extent();
    let mut seen = Bounds::of([&run]);
    while run.time() < until {
        let next = (run.time() + SEEN_EVERY).min(until);
        if budget.reach(&mut run, next) != Some(true) {
            break;
        }
        let now = Bounds::of([&run]);
        let wider = Bounds { low: seen.low.inf(&now.low), high: seen.high.sup(&now.high) };
        // Nothing fits where there are no particles, whose box is empty.
        let fits = wider.radius() < MOST * radius;
        if !fits {
            break;
        }
        seen = wider;
    }
    let radius = seen.radius();
    if !(radius > 0.0 && radius.is_finite()) {
        return;
    }
    let scene = run.scene();
    let (middle, radius) = surroundings(&scene.model, 0.0, (seen.middle(), radius));
    let mut seeing = camera(presentation);
    seeing.see(to_f32(middle), radius as f32);
    Arc::make_mut(presentation).viewpoint =
        Viewpoint { eye: seeing.eye().coords.cast(), target: seeing.target().coords.cast() };
}
