//! Where a run was, to go back to.

use super::Simulation;
use crate::error::Error;
use crate::network::Network;
use crate::path::Path;
use crate::scene::Model;

/// What changes in a run as time goes on, at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// In s.
    pub time: f64,
    /// Steps until then.
    pub steps: u64,
    /// The state.
    pub y: Vec<f64>,
    /// The springs that had broken, by the particles at their ends.
    pub torn: Vec<[usize; 2]>,
    /// Paths of the obstacles.
    pub obstacles: Vec<Path>,
}

impl Moment {
    /// How much memory it takes (bytes).
    #[must_use]
    pub fn size(&self) -> usize {
        size_of_val(&self.y[..]) + size_of_val(&self.torn[..]) + size_of_val(&self.obstacles[..])
    }
}

impl Simulation {
    /// Writes down where the run is, in the place of another moment.
    pub fn record(&self, moment: &mut Moment) {
        (moment.time, moment.steps) = (self.time(), self.steps);
        moment.y.clone_from(&self.y);
        moment.torn.clear();
        moment.obstacles.clear();
        if let Some(network) = self.model.network() {
            moment.torn.extend(network.torn());
            let obstacles = network.obstacles().iter();
            moment
                .obstacles
                .extend(obstacles.map(|obstacle| obstacle.path));
        }
    }

    /// Back to where the run was: hands let go, and it goes on from there, also after a blow-up. Pins whose path does not
    /// lead there stay where they are in that state, or swing from there. Method, wind, settings and which particles are
    /// pinned stay as they are now.
    ///
    /// # Errors
    /// The moment is of another scene, or a number is not finite.
    pub fn rewind(&mut self, moment: &Moment) -> Result<(), Error> {
        let Moment {
            time, steps, ref y, ..
        } = *moment;
        if y.len() != self.y.len() {
            return Err(Error::Dimension {
                expected: self.y.len(),
                found: y.len(),
            });
        }
        if !time.is_finite() || y.iter().any(|y| !y.is_finite()) {
            return Err(Error::Invalid(
                "a state to go back to has finite numbers, and so has its time".into(),
            ));
        }
        self.release();
        self.release_obstacle();
        self.y.copy_from_slice(y);
        (self.since, self.taken, self.steps) = (time, 0, steps);
        self.good.y.copy_from_slice(y);
        (self.good.time, self.good.steps) = (time, steps);
        self.blow_up = None;
        self.look_again();
        if let (Model::Network(network), Some(whole)) =
            (&mut self.model, self.scene.model.network())
        {
            if network.torn() != moment.torn {
                network.mend(whole, &moment.torn)?;
            }
            for (k, path) in moment.obstacles.iter().enumerate() {
                network.lead_obstacle(k, *path)?;
            }
        }
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
}
