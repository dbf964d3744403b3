//! Simulations: a scene, a method, and the time that the method has brought the scene to.

mod balance;
mod blow_up;
mod checkpoint;
mod hands;
mod readings;
mod stepper;
mod steps;
mod tuning;

pub use balance::{Balance, Gain};
pub use checkpoint::{Checkpoint, Grabbed};
pub use stepper::Progress;

use nalgebra::Vector3;

use crate::contact::{Contact, Guarded, StrainLimiter};
use crate::control::Control;
use crate::error::{BlowUp, Error};
use crate::integrators::{Method, Work};
use crate::scene::{Model, Scene, bounds};
use balance::Watch;
use stepper::Stepper;

/// A run of a scene.
pub struct Simulation {
    scene: Scene,
    model: Model,
    method: &'static Method,
    stepper: Stepper,
    control: Control,
    y: Vec<f64>,
    /// Time is `since + taken * step`, which gathers no rounding errors; under a tolerance it is
    /// `since` (s).
    since: f64,
    taken: u64,
    steps: u64,
    work: Work,
    contact: Contact,
    limiter: StrainLimiter,
    /// What the guard of surfaces did since the beginning.
    guarded: Guarded,
    swinging: bool,
    /// Phase of the swing (rad): while it swings, sin(rate t + phase); while it stands, sin(phase).
    swing_phase: f64,
    grabbed: Option<Grabbed>,
    grabbed_obstacle: Option<usize>,
    /// Whether the pins of the scene are free.
    unpinned: bool,
    blow_up: Option<BlowUp>,
    /// Energy that went in, and that the method added.
    watch: Watch,
    /// The last state in shape, to go back to when a step fails.
    good: Checkpoint,
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
        let stepper = Stepper::new(method, scene.model.system(), control)?;
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
        let y = scene.state.clone();
        let (middle, radius) = bounds(&y[..3 * model.particles()]);
        let contact = Contact::new(dim);
        let mut run = Self {
            scene,
            model,
            method,
            stepper,
            control,
            y,
            since: 0.0,
            taken: 0,
            steps: 0,
            work: Work::default(),
            contact,
            limiter: StrainLimiter::new(dim),
            guarded: Guarded::default(),
            swinging: false,
            swing_phase: 0.0,
            grabbed: None,
            grabbed_obstacle: None,
            unpinned: false,
            blow_up: None,
            watch: Watch::default(),
            good: Checkpoint::empty(method, control),
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
        let (windy, swinging, touching) = (self.windy(), self.swinging, self.touching());
        self.model = self.scene.model.clone();
        self.y.copy_from_slice(&self.scene.state);
        self.contact.forget_impulses();
        (self.since, self.taken, self.steps) = (0.0, 0, 0);
        (self.work, self.blow_up) = (Work::default(), None);
        self.guarded = Guarded::default();
        (self.grabbed, self.grabbed_obstacle) = (None, None);
        // The first step is chosen anew too: a run that was reset is the same run.
        if let Ok(stepper) = Stepper::new(self.method, self.model.system(), self.control) {
            self.stepper = stepper;
        }
        (self.swinging, self.swing_phase) = (false, 0.0);
        if std::mem::take(&mut self.unpinned) {
            self.set_pinned(false);
        }
        self.set_wind(windy);
        self.set_swinging(swinging);
        // Where surfaces cross, they begin as the scene has it.
        let _ = self.set_touching(touching);
        self.begin_watch();
    }

    /// Goes on with another method, in fixed steps or to a tolerance.
    ///
    /// # Errors
    /// The method does not serve the scene or does not take that control; the run goes on as
    /// before.
    pub fn set_method(&mut self, method: &'static Method, control: Control) -> Result<(), Error> {
        self.stepper = Stepper::new(method, self.model.system(), control)?;
        self.since = self.time();
        self.taken = 0;
        (self.method, self.control) = (method, control);
        self.watch.start_over();
        Ok(())
    }

    /// Goes on in other steps, or to another tolerance.
    ///
    /// # Errors
    /// The method does not take that control; the run goes on as before.
    pub fn set_control(&mut self, control: Control) -> Result<(), Error> {
        let (Control::Step(_), Control::Step(_)) = (self.control, control) else {
            return self.set_method(self.method, control);
        };
        self.method.check_control(control)?;
        self.since = self.time();
        self.taken = 0;
        self.control = control;
        self.watch.start_over();
        Ok(())
    }
}
