//! Checkpoints of a run: what it needs to go on to the same bits.

use serde::{Deserialize, Serialize};

use super::Simulation;
use super::balance::Balance;
use super::stepper::{Progress, Stepper};
use super::tuning::{let_touch, touches_itself};
use crate::contact::{Guarded, Shape};
use crate::control::Control;
use crate::elements::Wind;
use crate::error::Error;
use crate::integrators::{Method, Work};
use crate::network::Network;
use crate::path::Path;
use crate::scene::Model;

/// A particle in the hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grabbed {
    /// Number of the particle.
    pub particle: usize,
    /// Whether the particle was pinned before, and is again when the hand lets go.
    pub was_pinned: bool,
    /// Path along which the hand leads it.
    pub path: Path,
}

/// A run at one time: all that it needs, beside its scene, to go on to the same bits.
///
/// The scene is not in it, nor what was [adjusted](Simulation::adjust) of the scene, such as the
/// stiffness of springs: restore it in a run of the same scene, adjusted alike. The last step of an
/// adaptive method is in it if [`Simulation::checkpoint`] made it, and not if
/// [`Simulation::record`] did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The method.
    #[serde(with = "by_name")]
    pub method: &'static Method,
    /// The step or the tolerance.
    pub control: Control,
    /// Time at which the steps that are counted in `taken` began (s).
    pub since: f64,
    /// Steps of the same size since then: the time is `since` + `taken` x step.
    pub taken: u64,
    /// Steps since the beginning.
    pub steps: u64,
    /// Cost of these steps.
    pub work: Work,
    /// What the guard of surfaces did in these steps.
    #[serde(default)]
    pub guarded: Guarded,
    /// Balance of its energy.
    #[serde(default)]
    pub balance: Balance,
    /// The state y: of a network [x | v], in m and m/s.
    pub y: Vec<f64>,
    /// Pinned particles and their paths.
    pub pins: Vec<(usize, Path)>,
    /// Whether the scene's pins hold nothing.
    pub unpinned: bool,
    /// The particle in the hand.
    pub grabbed: Option<Grabbed>,
    /// The number of the obstacle in the hand.
    pub grabbed_obstacle: Option<usize>,
    /// Numbers and paths of the obstacles, but for floors.
    pub obstacles: Vec<(usize, Path)>,
    /// Whether the pins swing.
    pub swinging: bool,
    /// Phase of the swing (rad): while it swings, sin(rate t + phase); while it stands, sin(phase).
    pub swing_phase: f64,
    /// The wind that blows.
    pub wind: Option<Wind>,
    /// Whether surfaces touch one another and themselves.
    #[serde(default)]
    pub touching: bool,
    /// Springs that have broken, by the particles at their ends, the lower number first, in order.
    pub torn: Vec<[usize; 2]>,
    /// Progress of an adaptive method.
    pub adaptive: Option<Progress>,
}

impl Checkpoint {
    /// A checkpoint without state.
    pub(super) fn empty(method: &'static Method, control: Control) -> Self {
        Self {
            method,
            control,
            since: 0.0,
            taken: 0,
            steps: 0,
            work: Work::default(),
            guarded: Guarded::default(),
            balance: Balance::default(),
            y: vec![],
            pins: vec![],
            unpinned: false,
            grabbed: None,
            grabbed_obstacle: None,
            obstacles: vec![],
            swinging: false,
            swing_phase: 0.0,
            wind: None,
            touching: false,
            torn: vec![],
            adaptive: None,
        }
    }

    /// Simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.since + self.taken as f64 * self.control.step().unwrap_or(0.0)
    }

    /// Memory of a checkpoint without the last step of an adaptive method (bytes).
    #[must_use]
    pub fn size(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.y[..])
            + size_of_val(&self.pins[..])
            + size_of_val(&self.obstacles[..])
            + size_of_val(&self.torn[..])
    }

    /// `Ok` if the state is one of a system of this dimension.
    fn check(&self, dim: usize) -> Result<(), Error> {
        if self.y.len() != dim {
            return Err(Error::Dimension {
                expected: dim,
                found: self.y.len(),
            });
        }
        if !self.time().is_finite() || self.y.iter().any(|y| !y.is_finite()) {
            return Err(Error::Invalid(
                "the state and the time of a checkpoint must be finite".into(),
            ));
        }
        Ok(())
    }

    /// Gives a network, which is as its scene has it, what hands, time and tears changed.
    fn bind(&self, network: &mut Network, whole: &Network) -> Result<(), Error> {
        if network.torn() != self.torn {
            network.mend(whole, &self.torn)?;
        }
        for (i, _) in whole.pins() {
            network.unpin(i);
        }
        for (i, path) in &self.pins {
            network.pin(*i, *path)?;
        }
        for (k, path) in &self.obstacles {
            network.lead_obstacle(*k, *path)?;
        }
        network.set_wind(self.wind);
        if let Some(grabbed) = &self.grabbed {
            network.check_particle(grabbed.particle)?;
            grabbed.attract(network);
        }
        if let Some(k) = self.grabbed_obstacle {
            network.check_obstacle(k)?;
        }
        Ok(())
    }
}

impl Simulation {
    /// The run as it is now, with the last step of an adaptive method: some 20 arrays of the size
    /// of the state.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            adaptive: self.stepper.progress(true),
            ..self.moment()
        }
    }

    /// The run as it is now, without the last step of an adaptive method: what goes on from there
    /// begins a new one.
    #[must_use]
    pub fn moment(&self) -> Checkpoint {
        let mut moment = Checkpoint::empty(self.method, self.control);
        self.record(&mut moment);
        moment
    }

    /// Writes a [moment](Self::moment) over another one, whose memory is used again.
    pub fn record(&self, moment: &mut Checkpoint) {
        let mut old = std::mem::replace(moment, Checkpoint::empty(self.method, self.control));
        old.y.clone_from(&self.y);
        old.pins.clear();
        old.obstacles.clear();
        old.torn.clear();
        let network = self.model.network();
        if let Some(network) = network {
            old.pins.extend(network.pins());
            let obstacles = network.obstacles().iter().enumerate();
            old.obstacles.extend(
                obstacles
                    .filter(|(_, obstacle)| obstacle.shape != Shape::Floor)
                    .map(|(k, obstacle)| (k, obstacle.path)),
            );
            old.torn.extend_from_slice(network.torn());
        }
        *moment = Checkpoint {
            method: self.method,
            control: self.control,
            since: self.since,
            taken: self.taken,
            steps: self.steps,
            work: self.work,
            guarded: self.guarded,
            balance: self.watch.balance,
            y: old.y,
            pins: old.pins,
            unpinned: self.unpinned,
            grabbed: self.grabbed,
            grabbed_obstacle: self.grabbed_obstacle,
            obstacles: old.obstacles,
            swinging: self.swinging,
            swing_phase: self.swing_phase,
            wind: network.and_then(Network::wind).copied(),
            touching: self.touching(),
            torn: old.torn,
            adaptive: self.stepper.progress(false),
        };
    }

    /// Takes over everything of a checkpoint: the run goes on as the one that it was made of, to
    /// the same bits. A run that was lost goes on too.
    ///
    /// # Errors
    /// The checkpoint is of another scene, its method does not serve this one, or a number is not
    /// finite. The run goes on as before then.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        checkpoint.check(self.y.len())?;
        let mut model = self.scene.model.clone();
        if let (Model::Network(network), Some(whole)) = (&mut model, self.scene.model.network()) {
            if checkpoint.touching != touches_itself(&self.scene.model) {
                let_touch(network, &self.scene, checkpoint.touching)?;
            }
            checkpoint.bind(network, whole)?;
        }
        let mut stepper = Stepper::new(checkpoint.method, model.system(), checkpoint.control)?;
        if let Some(progress) = &checkpoint.adaptive {
            stepper.resume(progress)?;
        }
        (self.model, self.stepper) = (model, stepper);
        (self.method, self.control) = (checkpoint.method, checkpoint.control);
        (self.since, self.taken) = (checkpoint.since, checkpoint.taken);
        (self.steps, self.work) = (checkpoint.steps, checkpoint.work);
        self.guarded = checkpoint.guarded;
        self.watch.resume(checkpoint.balance);
        self.y.copy_from_slice(&checkpoint.y);
        self.contact.forget_impulses();
        self.unpinned = checkpoint.unpinned;
        (self.grabbed, self.grabbed_obstacle) = (checkpoint.grabbed, checkpoint.grabbed_obstacle);
        (self.swinging, self.swing_phase) = (checkpoint.swinging, checkpoint.swing_phase);
        self.blow_up = None;
        self.keep_good();
        Ok(())
    }

    /// Goes back to the state of a moment, and on from there as the run is now, also after a
    /// blow-up: hands let go; method, control, work, wind, swing and which particles are pinned
    /// stay. Surfaces touch if they
    /// did at that moment. Pins whose path does not lead there stay where they are in that state,
    /// or swing from there.
    ///
    /// # Errors
    /// The moment is of another scene, or a number is not finite.
    pub fn rewind(&mut self, moment: &Checkpoint) -> Result<(), Error> {
        moment.check(self.y.len())?;
        self.release();
        self.release_obstacle();
        self.go_back(moment)?;
        self.blow_up = None;
        self.keep_good();
        let time = self.time();
        let pins = self.model.network().into_iter().flat_map(Network::pins);
        // Not for a rounding error: a scene's own path is kept.
        let far = 1e-9 * self.radius;
        let elsewhere: Vec<_> = pins
            .filter(|(i, path)| (path.at(time).position - self.position(*i)).norm() > far)
            .map(|(i, _)| i)
            .collect();
        for i in elsewhere {
            self.leave_pin(i);
        }
        Ok(())
    }

    /// Goes back to the state of a moment of this run: time, springs that had not broken,
    /// obstacles, and whether surfaces touched.
    pub(super) fn go_back(&mut self, moment: &Checkpoint) -> Result<(), Error> {
        let touching = self.touching();
        if let (Model::Network(network), Some(whole)) =
            (&mut self.model, self.scene.model.network())
        {
            for (k, path) in &moment.obstacles {
                network.lead_obstacle(*k, *path)?;
            }
            let torn = network.torn() != moment.torn;
            if torn {
                network.mend(whole, &moment.torn)?;
            }
            if moment.touching != touching {
                let_touch(network, &self.scene, moment.touching)?;
            }
            if torn || moment.touching != touching {
                self.refit();
            }
        }
        self.y.copy_from_slice(&moment.y);
        self.contact.forget_impulses();
        self.watch.resume(moment.balance);
        self.steps = moment.steps;
        // Another step is no multiple of the time that was counted then.
        (self.since, self.taken) = if moment.control == self.control {
            (moment.since, moment.taken)
        } else {
            (moment.time(), 0)
        };
        self.look_again();
        Ok(())
    }

    /// Remembers the state as one to go back to after a blow-up.
    pub(super) fn keep_good(&mut self) {
        let mut good =
            std::mem::replace(&mut self.good, Checkpoint::empty(self.method, self.control));
        self.record(&mut good);
        self.good = good;
    }
}

mod by_name {
    //! Methods in serialised values: by their names.

    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    use crate::integrators::{Method, find};

    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde passes a reference"
    )]
    pub fn serialize<S: Serializer>(method: &&'static Method, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(method.name)
    }

    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<&'static Method, D::Error> {
        let name = String::deserialize(from)?;
        find(&name).ok_or_else(|| D::Error::custom(format!("there is no method {name}")))
    }
}
