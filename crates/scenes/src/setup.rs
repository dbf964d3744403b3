//! Setups: scenes with their presentation and with the defaults of their runs.

use std::ops::Range;
use std::sync::Arc;

use a3_core::contact::Shape;
use a3_core::{Control, Method, Model, Scene, Vector3};

/// Scene with its presentation and its defaults.
#[derive(Clone)]
pub struct Setup {
    /// Scene that is simulated.
    pub scene: Scene,
    /// How the scene is drawn.
    pub presentation: Arc<Presentation>,
    /// Defaults of its runs.
    pub defaults: Defaults,
}

/// Presentation of a scene: its viewpoint, and the parts that are drawn in a way of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Presentation {
    /// Camera.
    pub viewpoint: Viewpoint,
    /// Surface of the bodies that have one.
    pub surface: Surface,
    /// Particles of the walls of each tank of fluid. Only the edges of the tank are drawn in their
    /// place.
    pub tanks: Vec<Range<usize>>,
    /// Sentences about what may not be meant, such as a cup that leaks.
    pub notes: Vec<String>,
    /// Number of the particle whose path is drawn.
    pub trail: Option<usize>,
}

/// Position of a camera, and the point that it looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// Position of the camera (m).
    pub eye: Vector3<f64>,
    /// Point that the camera looks at (m).
    pub target: Vector3<f64>,
}

impl Viewpoint {
    /// Returns the view of a whole scene from the front, a little from the right and from above.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let (target, radius) = surroundings(&scene.model, 0.0, scene.extent());
        let eye = target + Vector3::new(0.5, 0.15, 1.0).normalize() * (2.8 * radius);
        Self { eye, target }
    }
}

/// Largest distance of what is seen around particles, over the radius of the ball that holds them.
const NEAR: f64 = 4.0;

/// Returns the middle (m) and the radius (m) of a ball that holds a given one, which holds the
/// particles, and the obstacles and the floor near it at time t (s).
#[must_use]
pub fn surroundings(
    model: &Model,
    t: f64,
    (middle, radius): (Vector3<f64>, f64),
) -> (Vector3<f64>, f64) {
    let network = model.network();
    let near = network.into_iter().flat_map(|network| {
        let falls = network.gravity().is_some();
        network.obstacles().iter().filter_map(move |obstacle| {
            let place = obstacle.at(t).place.position;
            let (place, size) = match obstacle.shape {
                Shape::Floor if falls => (Vector3::new(middle.x, place.y, middle.z), 0.0),
                Shape::Floor => return None,
                _ => (place, obstacle.shape.reach()),
            };
            ((place - middle).norm() + size < NEAR * radius).then_some((place, size))
        })
    });
    near.fold((middle, radius), |(middle, radius), (place, size)| {
        let away = place - middle;
        let distance = away.norm();
        if distance + size <= radius {
            return (middle, radius);
        }
        if distance + radius <= size {
            return (place, size);
        }
        let whole = 0.5 * (distance + radius + size);
        (middle + away * ((whole - radius) / distance), whole)
    })
}

/// Defaults of the runs of a scene.
///
/// ```
/// use a3_core::integrators;
///
/// let defaults = a3_scenes::find("cloth").unwrap().build(None)?.defaults;
/// let rk4 = integrators::find("rk4").unwrap();
/// assert!(defaults.control_of(rk4).step().is_some());
/// let dopri5 = integrators::find("dopri5").unwrap();
/// assert!(defaults.control_of(dopri5).tolerance().is_some());
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Defaults {
    /// Method that the scene names, if it does.
    pub solver: Option<&'static Method>,
    /// Step or tolerance of that method.
    pub control: Option<Control>,
    /// Length of a run (s).
    pub duration: Option<f64>,
    /// Factor of the methods' default steps: below 1 for a cloth with a finer grid than in its
    /// description.
    pub step_scale: f64,
}

impl Default for Defaults {
    fn default() -> Self {
        Self { solver: None, control: None, duration: None, step_scale: 1.0 }
    }
}

impl Defaults {
    /// Returns the step or tolerance that the scene names for a method, if it names one.
    #[must_use]
    pub fn own_control(&self, method: &Method) -> Option<Control> {
        let is_it = |solver: &Method| std::ptr::eq(solver, method);
        self.control.filter(|_| self.solver.is_some_and(is_it))
    }

    /// Returns the step or tolerance of a method on this scene: the scene's own, or else the
    /// method's default. If the scene's step is shorter than the default of its solver, the steps
    /// of other methods are shortened in proportion. A scaled step is rounded to two digits.
    #[must_use]
    pub fn control_of(&self, method: &Method) -> Control {
        let own = self.own_control(method);
        let scale = self.step_scale
            * match (own, self.control, self.solver.map(|s| s.default_control)) {
                (None, Some(Control::Step(own)), Some(Control::Step(usual))) => {
                    (own / usual).min(1.0)
                }
                _ => 1.0,
            };
        match own.unwrap_or(method.default_control) {
            Control::Step(step) if scale != 1.0 => {
                let step = step * scale;
                Control::Step(format!("{step:.1e}").parse().unwrap_or(step))
            }
            control => control,
        }
    }
}

/// Surface of the bodies that have one, whose particles come first in a scene. Other particles are
/// drawn one by one, with their springs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Corners of the triangles, counterclockwise as seen from outside, or from the front of a
    /// cloth.
    pub triangles: Vec<[u32; 3]>,
    /// End of the particles of each body, which begin at the end of the body before. Particles
    /// inside a body are in no triangle.
    pub bodies: Vec<usize>,
}

impl Surface {
    /// Counts the particles of bodies that have a surface.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.bodies.last().copied().unwrap_or(0)
    }
}
