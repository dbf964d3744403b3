//! Setups: scenes with how they are shown, and how they are run unless one says otherwise.

use std::ops::Range;
use std::sync::Arc;

use a3_core::{Control, Method, Scene, Vector3};

use crate::surface::Surface;

/// Scene with its presentation and its defaults.
#[derive(Clone)]
pub struct Setup {
    /// Scene that is simulated.
    pub scene: Scene,
    /// What of the scene is shown, and from where.
    pub presentation: Arc<Presentation>,
    /// How the scene is run unless one says otherwise.
    pub defaults: Defaults,
}

/// What of a scene is shown, and from where.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Presentation {
    /// Position and target of the camera.
    pub viewpoint: Viewpoint,
    /// Surface of the bodies that have one.
    pub surface: Surface,
    /// Particles of the walls of each tank of fluid, which are shown by the edges of the tank.
    pub tanks: Vec<Range<usize>>,
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
    /// View of a whole scene from the front, a little from the right and from above.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let (target, radius) = scene.extent();
        let eye = target + Vector3::new(0.5, 0.15, 1.0).normalize() * (2.8 * radius);
        Self { eye, target }
    }
}

/// How a scene is run unless one says otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Defaults {
    /// Method to begin with, if the scene says one.
    pub solver: Option<&'static Method>,
    /// Step or tolerance of that method.
    pub control: Option<Control>,
    /// Length of a run (s).
    pub duration: Option<f64>,
    /// Factor of the methods' default steps: less than 1 for a cloth finer than in its description.
    pub step_scale: f64,
}

impl Default for Defaults {
    fn default() -> Self {
        Self {
            solver: None,
            control: None,
            duration: None,
            step_scale: 1.0,
        }
    }
}

impl Defaults {
    /// The step or tolerance of a method on this scene: the scene's own, or else the method's
    /// default. Where the scene's own step is shorter than the default of its solver, the steps of
    /// others are shorter in proportion. A step that is scaled has two digits, as one would type
    /// it.
    #[must_use]
    pub fn control_of(&self, method: &Method) -> Control {
        let own = self.control.filter(|_| {
            self.solver
                .is_some_and(|solver| std::ptr::eq(solver, method))
        });
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
