//! Simulations: a scene, a method, and the time that the method has brought the scene to.

mod balance;
mod blow_up;
mod checkpoint;
mod drive;
mod events;
mod hands;
mod located;
mod phases;
mod readings;
mod resting;
mod state;
mod step;
mod stepper;
mod steps;
mod tuning;
mod within;

pub use balance::{Balance, Gain};
pub use checkpoint::Checkpoint;
pub use state::{Grabbed, RunState};
pub use stepper::Progress;
pub use within::Span;

use nalgebra::Vector3;

use crate::control::Control;
use crate::error::{BlowUp, Error};
use crate::integrators::Method;
use crate::scene::{Model, Scene};
use balance::Watch;
use events::Events;
use phases::Phases;
use resting::Rests;
pub(crate) use resting::may_rest;
use stepper::Stepper;

/// A run of a scene.
pub struct Simulation {
    scene: Scene,
    model: Model,
    state: RunState,
    stepper: Stepper,
    phases: Phases,
    events: Events,
    /// Particles that rest on obstacles in the step that is taken.
    rests: Rests,
    /// Whether fixed steps end at events too, in parts.
    locates: bool,
    blow_up: Option<BlowUp>,
    watch: Watch,
    /// The last state in shape, to go back to when a step fails.
    good: Option<Checkpoint>,
    middle: Vector3<f64>,
    radius: f64,
}

impl Simulation {
    /// A run from the scene's beginning, in fixed steps or, with an adaptive method, to a
    /// tolerance.
    ///
    /// # Errors
    /// The method does not serve the scene or does not take that control; or the scene's state has
    /// another length than its model's.
    pub fn new(scene: Scene, method: &'static Method, control: Control) -> Result<Self, Error> {
        let stepper = Stepper::new(method, &scene, scene.model.system(), control)?;
        let model = scene.model.clone();
        let (dim, length) = (model.system().dim(), scene.state.len());
        if length != dim {
            return Err(Error::Dimension {
                expected: dim,
                found: length,
            });
        }
        if dim == 0 || dim % 3 != 0 && model.network().is_none() {
            return Err(Error::Invalid(format!(
                "the state of a scene must be n x 3 numbers, not {dim}"
            )));
        }
        if let Some(network) = model.network().filter(|n| n.contact_layer().is_some()) {
            let apart = network.check_apart(0.0, network.halves(&scene.state).0);
            apart.map_err(|e| Error::Invalid(format!("surfaces cannot begin crossed: {e}")))?;
        }
        let (middle, radius) = scene.extent();
        let (events, rests) = (Events::new(&model), Rests::new(&model));
        let mut run = Self {
            state: RunState::new(method, control, scene.state.clone()),
            scene,
            model,
            stepper,
            phases: Phases::new(dim),
            events,
            rests,
            locates: false,
            blow_up: None,
            watch: Watch::default(),
            good: None,
            middle,
            radius,
        };
        run.begin_watch();
        run.keep_good();
        Ok(run)
    }

    /// Goes back to the beginning, with what was torn mended. Wind and swing stay on if they are,
    /// and pins free; surfaces go on touching, unless they cross at the beginning. The hand lets
    /// go.
    pub fn reset(&mut self) {
        let (windy, touching) = (self.windy(), self.touching());
        let RunState {
            method,
            control,
            unpinned,
            swinging,
            ..
        } = self.state;
        self.model = self.scene.model.clone();
        self.state = RunState::new(method, control, self.scene.state.clone());
        self.phases.contact.forget_impulses();
        self.blow_up = None;
        // The first step is chosen as in a new run: one that was reset is the same run.
        if let Ok(stepper) = Stepper::new(method, &self.scene, self.model.system(), control) {
            self.stepper = stepper;
        }
        if unpinned {
            self.set_pinned(false);
        }
        self.set_wind(windy);
        self.set_swinging(swinging);
        // Where surfaces cross, they begin as the scene has it.
        let _ = self.set_touching(touching);
        self.begin_watch();
    }

    /// Lets fixed steps end at events, as adaptive ones do: where a prescribed motion begins or
    /// ends, a particle touches an obstacle, its slide ends, or a spring breaks. A step goes on
    /// from there by the rest of its length. So the order of the method is kept, at any price:
    /// this is for references.
    pub fn locate_events(&mut self) {
        self.locates = true;
    }

    /// Goes on with another method, in fixed steps or to a tolerance.
    ///
    /// # Errors
    /// The method does not serve the scene or does not take that control; the run goes on as
    /// before.
    pub fn set_method(&mut self, method: &'static Method, control: Control) -> Result<(), Error> {
        self.stepper = Stepper::new(method, &self.scene, self.model.system(), control)?;
        self.state.set_time(self.time());
        (self.state.method, self.state.control) = (method, control);
        self.start_watch_over();
        Ok(())
    }

    /// Goes on in other steps, or to another tolerance.
    ///
    /// # Errors
    /// The method does not take that control; the run goes on as before.
    pub fn set_control(&mut self, control: Control) -> Result<(), Error> {
        let (Control::Step(_), Control::Step(_)) = (self.state.control, control) else {
            return self.set_method(self.state.method, control);
        };
        self.state.method.check_control(control)?;
        self.look_again();
        self.state.set_time(self.time());
        self.state.control = control;
        self.start_watch_over();
        Ok(())
    }
}
