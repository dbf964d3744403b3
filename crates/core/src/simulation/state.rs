//! State of a run: all data that changes while it runs, except the model and the memory of an
//! adaptive method.

use serde::{Deserialize, Serialize};

use super::balance::Balance;
use super::pins::Grabbed;
use super::reach::STEP_END_TOLERANCE;
use crate::contact::Guarded;
use crate::control::Control;
use crate::error::{BlowUp, Cause, Error};
use crate::integrators::{Method, Work};
use crate::scene::{Model, Scene};

/// State of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunState {
    /// The method.
    #[serde(with = "by_name")]
    pub method: &'static Method,
    /// The step or the tolerance.
    pub control: Control,
    /// Time at which the steps that are counted in `taken` began (s).
    pub since: f64,
    /// Number of steps of the same size since then. The last step ends at `since` + `taken` x step,
    /// which accumulates no rounding errors; under a tolerance, it ends at `since`.
    pub taken: u64,
    /// Time shown (s), if it is within the last step.
    pub shown: Option<f64>,
    /// Steps since the beginning.
    pub steps: u64,
    /// Cost of these steps.
    pub work: Work,
    /// Actions of the collision safeguard in these steps.
    pub guarded: Guarded,
    /// Balance of energy.
    pub balance: Balance,
    /// The state y: of a network [x | v], in m and m/s.
    pub y: Vec<f64>,
    /// Whether the scene's pins are freed.
    pub unpinned: bool,
    /// The particle in the hand.
    pub grabbed: Option<Grabbed>,
    /// The number of the obstacle in the hand.
    pub grabbed_obstacle: Option<usize>,
    /// Whether the pins swing.
    pub swinging: bool,
    /// Phase of the swing (rad): that of sin(rate t + phase) while the pins swing, of sin(phase)
    /// while they stand.
    pub swing_phase: f64,
    /// Hash of which particles rested on which obstacles in the last step.
    pub resting: u64,
}

impl RunState {
    /// Creates the state of a run at the beginning of a scene.
    ///
    /// # Errors
    /// The scene's state has another length than its model's, or none; or surfaces cross there.
    pub(super) fn begin(
        scene: &Scene,
        method: &'static Method,
        control: Control,
    ) -> Result<Self, Error> {
        let (model, y) = (&scene.model, &scene.state);
        let dim = model.system().dim();
        if y.len() != dim {
            return Err(Error::Dimension { expected: dim, found: y.len() });
        }
        if dim == 0 || matches!(model, Model::Points(_)) && dim % 3 != 0 {
            return Err(Error::Invalid(format!(
                "the state of a scene must be one number or more, and that of points n x 3, not \
                 {dim}"
            )));
        }
        if let Some(network) = model.network().filter(|n| n.contact_layer().is_some()) {
            let apart = network.check_apart(0.0, network.halves(y).0);
            apart.map_err(|e| {
                Error::Invalid(format!(
                    "surfaces cannot begin crossed or without a gap, unless `untangle` brings them apart: {e}"
                ))
            })?;
        }
        Ok(Self::new(method, control, y.clone()))
    }

    /// Creates the state of a run that begins at y.
    pub(super) fn new(method: &'static Method, control: Control, y: Vec<f64>) -> Self {
        Self {
            method,
            control,
            since: 0.0,
            taken: 0,
            shown: None,
            steps: 0,
            work: Work::default(),
            guarded: Guarded::default(),
            balance: Balance::default(),
            y,
            unpinned: false,
            grabbed: None,
            grabbed_obstacle: None,
            swinging: false,
            swing_phase: 0.0,
            resting: 0,
        }
    }

    /// Becomes a copy of another state, and reuses the memory of y.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let mut y = std::mem::take(&mut self.y);
        y.clone_from(&other.y);
        *self = Self { y, ..*other };
    }

    /// Returns the blow-up of the run by a cause, at a time (s).
    pub(super) fn blow_up(&self, cause: Cause, time: f64) -> BlowUp {
        BlowUp { method: self.method.title, control: self.control, step: self.steps, time, cause }
    }

    /// Returns the simulated time, which is shown (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.shown.unwrap_or_else(|| self.end())
    }

    /// Returns the time at the end of the last step (s).
    pub(super) fn end(&self) -> f64 {
        self.since + self.taken as f64 * self.control.step().unwrap_or(0.0)
    }

    /// Returns the time (s) by which the end of a fixed step may miss a known time.
    pub(super) fn sliver(&self) -> f64 {
        STEP_END_TOLERANCE * self.control.step().unwrap_or(0.0)
    }

    /// Sets the time (s), from which steps are then counted.
    pub(super) fn set_time(&mut self, time: f64) {
        (self.since, self.taken, self.shown) = (time, 0, None);
    }

    /// Goes back to the state of another time, but keeps method, control, cost and hands.
    pub(super) fn go_back(&mut self, then: &Self) {
        self.y.copy_from_slice(&then.y);
        (self.balance, self.steps) = (then.balance, then.steps);
        // If the control has changed, the time is no multiple of the step.
        if then.control == self.control {
            (self.since, self.taken) = (then.since, then.taken);
            self.shown = then.shown;
        } else {
            self.set_time(then.time());
        }
    }
}

mod by_name {
    //! Methods in serialised values: by their names.

    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    use crate::integrators::{Method, find};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub fn serialize<S: Serializer>(method: &&'static Method, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(method.name)
    }

    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<&'static Method, D::Error> {
        let name = String::deserialize(from)?;
        find(&name).ok_or_else(|| D::Error::custom(format!("there is no method {name}")))
    }
}
