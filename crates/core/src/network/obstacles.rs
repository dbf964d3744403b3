//! Obstacles in the way of a network.

use super::Network;
use crate::contact::{Obstacle, Shape};
use crate::elements::{Element, Wind};
use crate::error::Error;
use crate::path::Path;

impl Network {
    /// Adds an obstacle after those that are there: particles are put out of one after another.
    ///
    /// # Errors
    /// Its shape has no size, or its friction is negative; or a number is not finite.
    pub fn add_obstacle(&mut self, obstacle: Obstacle) -> Result<(), Error> {
        obstacle.check()?;
        self.obstacles.push(obstacle);
        self.renew_contact();
        Ok(())
    }

    /// Obstacles in the order in which they were added.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Removes obstacle k; those after it move up by one.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn remove_obstacle(&mut self, k: usize) -> Result<Obstacle, Error> {
        self.check_obstacle(k)?;
        let removed = self.obstacles.remove(k);
        self.renew_contact();
        Ok(removed)
    }

    /// Leads obstacle k along `path` from now on.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn lead_obstacle(&mut self, k: usize, path: Path) -> Result<(), Error> {
        self.check_obstacle(k)?;
        self.obstacles[k].path = path;
        let obstacle = self.obstacles[k].clone();
        if let Some(layer) = self
            .elements
            .iter_mut()
            .find_map(Element::contact_layer_mut)
        {
            layer.set_obstacle(k, obstacle);
        }
        Ok(())
    }

    /// Gives obstacle k another shape.
    ///
    /// # Errors
    /// There is no such obstacle, or the shape has no size.
    pub fn reshape_obstacle(&mut self, k: usize, shape: Shape) -> Result<(), Error> {
        self.check_obstacle(k)?;
        shape.check()?;
        self.obstacles[k].shape = shape;
        self.renew_contact();
        Ok(())
    }

    /// # Errors
    /// There is no obstacle k.
    pub fn check_obstacle(&self, k: usize) -> Result<(), Error> {
        match self.obstacles.len() {
            count if k < count => Ok(()),
            0 => Err(Error::Invalid("there is no obstacle here".into())),
            count => Err(Error::Invalid(format!(
                "there is no obstacle {k}: they are numbered 0 to {}",
                count - 1
            ))),
        }
    }

    /// Whether pins or obstacles are on their way, now or at some time.
    #[must_use]
    pub fn moves_by_itself(&self) -> bool {
        let pins = self.pins.iter().map(|pin| pin.path);
        let obstacles = self.obstacles.iter().map(|obstacle| obstacle.path);
        let moved = |path: Path| !matches!(path, Path::Still(_));
        pins.chain(obstacles).any(moved) || self.obstacles.iter().any(|o| o.turn.is_some())
    }

    /// First time after t (s) at which a path or a turn begins or ends; infinite if there is none.
    pub(crate) fn next_known_time(&self, t: f64) -> f64 {
        let pins = self.pins.iter().map(|pin| &pin.path);
        let obstacles = self.obstacles.iter().map(|obstacle| &obstacle.path);
        let turns = self.obstacles.iter().filter_map(|obstacle| obstacle.turn);
        let of_paths = pins.chain(obstacles).flat_map(Path::known_times);
        let all = of_paths.chain(turns.flat_map(|turn| turn.known_times()));
        all.filter(|time| *time > t).fold(f64::INFINITY, f64::min)
    }

    /// Longest step (s) from time t (s) to `end` (s) that shows the prescribed motion and the wind:
    /// a quarter of the shortest period.
    pub(crate) fn quarter_period(&self, t: f64, end: f64) -> f64 {
        let times = [t, end];
        let pins = self.pins.iter().map(|pin| &pin.path);
        let obstacles = self.obstacles.iter().map(|obstacle| &obstacle.path);
        let of_paths = pins.chain(obstacles).map(|path| path.quarter_period(times));
        let turns = self.obstacles.iter().filter_map(|obstacle| obstacle.turn);
        let of_turns = turns.filter(|turn| turn.is_on(times));
        let of_turns = of_turns.map(|turn| 0.5 * std::f64::consts::PI / turn.rate.abs());
        let of_wind = self.wind().map(Wind::quarter_period);
        let all = of_paths.chain(of_turns).chain(of_wind);
        all.fold(f64::INFINITY, f64::min)
    }
}
