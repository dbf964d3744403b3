//! Checkpoints of a run: what it needs to go on to the same bits.

use serde::{Deserialize, Serialize};

use super::Simulation;
use super::state::RunState;
use super::stepper::{Progress, Stepper};
use super::tuning::{let_touch, touches_itself};
use crate::contact::Shape;
use crate::elements::Wind;
use crate::error::Error;
use crate::network::Network;
use crate::path::Path;
use crate::scene::Model;

/// A run at one time: all that it needs, beside its scene, to go on to the same bits.
///
/// The scene is not in it, nor what was [adjusted](Simulation::adjust) of the scene, such as the
/// stiffness of springs: restore it in a run of the same scene, adjusted alike. The last step of an
/// adaptive method is in it if [`Simulation::checkpoint`] made it, and not if
/// [`Simulation::record`] did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// State of the run.
    pub run: RunState,
    /// Pinned particles and their paths.
    pub pins: Vec<(usize, Path)>,
    /// Numbers and paths of the obstacles, except floors.
    pub obstacles: Vec<(usize, Path)>,
    /// The wind that blows.
    pub wind: Option<Wind>,
    /// Whether surfaces touch one another and themselves.
    pub touching: bool,
    /// Springs that have broken, by the particles at their ends, the lower number first, in order.
    pub torn: Vec<[usize; 2]>,
    /// Progress within a step, and of an adaptive method.
    pub progress: Progress,
}

impl Checkpoint {
    /// Checkpoint of a run in a state, without changes of its scene.
    pub(super) fn new(run: RunState) -> Self {
        Self {
            run,
            pins: vec![],
            obstacles: vec![],
            wind: None,
            touching: false,
            torn: vec![],
            progress: Progress::default(),
        }
    }

    /// Simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.run.time()
    }

    /// Memory of a checkpoint without the last step of an adaptive method (bytes).
    #[must_use]
    pub fn size(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.run.y[..])
            + size_of_val(&self.pins[..])
            + size_of_val(&self.obstacles[..])
            + size_of_val(&self.torn[..])
    }

    /// `Ok` if the state is one of a system of this dimension.
    fn check(&self, dim: usize) -> Result<(), Error> {
        let y = &self.run.y;
        if y.len() != dim {
            return Err(Error::Dimension {
                expected: dim,
                found: y.len(),
            });
        }
        if !(self.time() + self.run.end()).is_finite() || y.iter().any(|y| !y.is_finite()) {
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
        if let Some(grabbed) = &self.run.grabbed {
            network.check_particle(grabbed.particle)?;
            grabbed.attract(network);
        }
        if let Some(k) = self.run.grabbed_obstacle {
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
        let mut whole = self.moment();
        whole.run.copy_from(&self.state);
        whole.progress = self.stepper.progress(true);
        whole
    }

    /// The run as it is now, without the last step of an adaptive method: what goes on from there
    /// begins a new one.
    #[must_use]
    pub fn moment(&self) -> Checkpoint {
        let mut moment = Checkpoint::new(self.state.clone());
        self.record_model(&mut moment);
        moment
    }

    /// Writes a [moment](Self::moment) over another one, whose memory is used again.
    pub fn record(&self, moment: &mut Checkpoint) {
        moment.run.copy_from(&self.state);
        self.record_model(moment);
    }

    /// Writes what hands, time and tears changed of the model to a moment.
    fn record_model(&self, moment: &mut Checkpoint) {
        moment.pins.clear();
        moment.obstacles.clear();
        moment.torn.clear();
        let network = self.model.network();
        if let Some(network) = network {
            moment.pins.extend(network.pins());
            let obstacles = network.obstacles().iter().enumerate();
            moment.obstacles.extend(
                obstacles
                    .filter(|(_, obstacle)| obstacle.shape != Shape::Floor)
                    .map(|(k, obstacle)| (k, obstacle.path)),
            );
            moment.torn.extend_from_slice(network.torn());
        }
        moment.wind = network.and_then(Network::wind).copied();
        moment.touching = self.touching();
        moment.progress = self.stepper.progress(false);
        if self.stepper.within.times().is_some() {
            moment.run.set_time(self.time());
        }
    }

    /// Takes over everything of a checkpoint: the run goes on as the one that it was made of, to
    /// the same bits. A run that was lost goes on too.
    ///
    /// # Errors
    /// The checkpoint is of another scene, its method does not serve this one, or a number is not
    /// finite. The run goes on as before then.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        checkpoint.check(self.state.y.len())?;
        let run = &checkpoint.run;
        let mut model = self.scene.model.clone();
        if let (Model::Network(network), Some(whole)) = (&mut model, self.scene.model.network()) {
            if checkpoint.touching != touches_itself(&self.scene.model) {
                let_touch(network, &self.scene, checkpoint.touching)?;
            }
            checkpoint.bind(network, whole)?;
        }
        let mut stepper = Stepper::new(run.method, &self.scene, model.system(), run.control)?;
        stepper.resume(&checkpoint.progress, run.y.len())?;
        (self.model, self.stepper) = (model, stepper);
        self.state.copy_from(run);
        self.watch.resume();
        self.phases.contact.forget_impulses();
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
        moment.check(self.state.y.len())?;
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
        let then = &moment.run;
        self.state.y.copy_from_slice(&then.y);
        self.state.balance = then.balance;
        self.state.steps = then.steps;
        self.stepper.forget();
        // Another step is no multiple of the time that was counted then.
        if then.control == self.state.control {
            (self.state.since, self.state.taken) = (then.since, then.taken);
            self.state.shown = then.shown;
        } else {
            self.state.set_time(then.time());
        }
        self.phases.contact.forget_impulses();
        self.watch.resume();
        self.look_again();
        Ok(())
    }

    /// Remembers the state as one to go back to after a blow-up.
    pub(super) fn keep_good(&mut self) {
        let good = match self.good.take() {
            Some(mut good) => {
                self.record(&mut good);
                good
            }
            None => self.moment(),
        };
        self.good = Some(good);
    }
}
