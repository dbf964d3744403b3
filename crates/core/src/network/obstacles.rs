//! Obstacles in the way of a network.

use super::Network;
use crate::contact::{Obstacle, Shape};
use crate::elements::Element;
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
}
