//! What stands in the way of a network: spheres, boxes, capsules, a floor.

use super::Network;
use crate::colliders::{Capsule, Cuboid, Floor, Sphere};
use crate::error::{Error, positive};
use crate::path::Path;

impl Network {
    /// Puts a sphere in the way.
    pub fn add_sphere(&mut self, sphere: Sphere) {
        self.spheres.push(sphere);
    }

    /// The spheres in the way.
    #[must_use]
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// Whether pins or obstacles are on their way, now or at some time.
    #[must_use]
    pub fn moves_by_itself(&self) -> bool {
        let pins = self.pins.iter().map(|pin| pin.path);
        let spheres = self.spheres.iter().map(|sphere| sphere.path);
        let boxes = self.boxes.iter().map(|cuboid| cuboid.path);
        let capsules = self.capsules.iter().map(|capsule| capsule.path);
        let mut paths = pins.chain(spheres).chain(boxes).chain(capsules);
        paths.any(|path| !matches!(path, Path::Still(_)))
    }

    /// Leads sphere k along `path` from now on.
    ///
    /// # Errors
    /// There is no such sphere.
    pub fn lead_sphere(&mut self, k: usize, path: Path) -> Result<(), Error> {
        self.check_sphere(k)?;
        self.spheres[k].path = path;
        Ok(())
    }

    /// Makes sphere k as large as that (m).
    ///
    /// # Errors
    /// There is no such sphere, or the radius is not a finite number above 0.
    pub fn resize_sphere(&mut self, k: usize, radius: f64) -> Result<(), Error> {
        self.check_sphere(k)?;
        positive("a sphere's radius", radius)?;
        self.spheres[k].radius = radius;
        Ok(())
    }

    /// # Errors
    /// There is no sphere k.
    pub fn check_sphere(&self, k: usize) -> Result<(), Error> {
        match self.spheres.len() {
            count if k < count => Ok(()),
            0 => Err(Error::Invalid("there is no sphere here".into())),
            count => Err(Error::Invalid(format!(
                "there is no sphere {k}: they are numbered 0 to {}",
                count - 1
            ))),
        }
    }

    /// Puts a box in the way.
    pub fn add_box(&mut self, cuboid: Cuboid) {
        self.boxes.push(cuboid);
    }

    /// The boxes in the way.
    #[must_use]
    pub fn boxes(&self) -> &[Cuboid] {
        &self.boxes
    }

    /// Puts a capsule in the way.
    pub fn add_capsule(&mut self, capsule: Capsule) {
        self.capsules.push(capsule);
    }

    /// The capsules in the way.
    #[must_use]
    pub fn capsules(&self) -> &[Capsule] {
        &self.capsules
    }

    /// Lays a floor.
    pub fn set_floor(&mut self, floor: Floor) {
        self.floor = Some(floor);
    }

    /// Takes the floor away, if there is one.
    pub fn remove_floor(&mut self) {
        self.floor = None;
    }

    /// The floor, if there is one.
    #[must_use]
    pub fn floor(&self) -> Option<Floor> {
        self.floor
    }
}
