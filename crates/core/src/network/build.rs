//! How a network is built and changed, and how its springs break.

use std::ops::Range;

use nalgebra::Vector3;

use super::bodies::Bodies;
use super::elements::{Element, Elements};
use super::outflow::{drained, entered, is_drained, leave, set_drained};
use super::particles::Particles;
use super::parts::Network;
use super::surfaces::{Surfaces, Touch};
use super::tearing::{StrainLimits, Tears};
use crate::constraints::{Constraint, Constraints};
use crate::contact::{ContactLayer, Obstacle, Shape};
use crate::elements::{Buckling, Wind};
use crate::error::{Error, at_least, positive};
use crate::path::Path;
use crate::pin::Pin;
use crate::rigid::{Body, Motor};
use crate::spring::Spring;

impl Network {
    /// Creates a network of free particles of these masses (kg), without any force.
    ///
    /// # Errors
    /// There is no particle, or a mass is not a finite number above 0.
    pub fn new(masses: Vec<f64>) -> Result<Self, Error> {
        let particles = Particles::new(masses)?;
        Ok(Self {
            elements: Elements::new(particles.len()),
            constraints: Constraints::default(),
            bodies: Bodies::new(particles.len()),
            surfaces: Surfaces::default(),
            tears: Tears::default(),
            strain_limits: StrainLimits::default(),
            particles,
        })
    }

    /// Adds an element, after those of its type.
    ///
    /// # Errors
    /// A particle that it names does not exist, or a particle would be in two sheets.
    pub fn add(&mut self, element: impl Into<Element>) -> Result<(), Error> {
        self.strain_limits.forget();
        self.elements.add(element.into())
    }

    /// Pins particle i to `path` for good, whether it was pinned before or not.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it.
    pub fn pin(&mut self, i: usize, path: Path) -> Result<(), Error> {
        self.check_kinematic(i)?;
        if self.particles.pin(i, path) {
            self.strain_limits.forget();
        }
        Ok(())
    }

    /// Adds pins. If a particle is named several times, its last pin counts.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it, or a pin lets go at no time above 0;
    /// none is added then.
    pub fn pin_all(&mut self, pins: Vec<Pin>) -> Result<(), Error> {
        for pin in &pins {
            self.check_kinematic(pin.particle)?;
            positive("the time at which a pin lets go", pin.until.unwrap_or(1.0))?;
        }
        self.particles.pin_all(pins);
        self.strain_limits.forget();
        Ok(())
    }

    /// Frees particle i. Does nothing if it is free already, or has left a fluid.
    pub fn unpin(&mut self, i: usize) {
        if !is_drained(self, i) && self.particles.unpin(i) {
            self.strain_limits.forget();
        }
    }

    /// Replaces the path of every pin by the result of `path` for it.
    pub fn lead_pins(&mut self, path: impl FnMut(usize, Path) -> Path) {
        self.particles.lead_pins(path);
    }

    /// Checks that particle i can be pinned: it exists, and no rigid body carries it.
    pub(crate) fn check_kinematic(&self, i: usize) -> Result<(), Error> {
        self.particles.check(i)?;
        self.bodies.check_free(&self.particles, i)
    }

    /// Sets gravity g (m/s2); zero means none.
    pub fn set_gravity(&mut self, g: Vector3<f64>) {
        self.elements.set_gravity(g);
    }

    /// Sets the coefficient c (kg/s) of viscous drag -c v on each particle; zero means none.
    ///
    /// # Errors
    /// c is negative or not finite.
    pub fn set_drag(&mut self, c: f64) -> Result<(), Error> {
        at_least(0.0, "the drag", c)?;
        self.elements.set_drag(c);
        Ok(())
    }

    /// Sets or removes the wind, on particles or on triangles.
    pub fn set_wind(&mut self, wind: Option<Wind>) {
        self.elements.set_wind(wind.as_ref());
    }

    /// Adds one spring.
    ///
    /// # Errors
    /// An end does not exist, or both are the same.
    pub fn add_spring(&mut self, spring: Spring) -> Result<(), Error> {
        self.strain_limits.forget();
        self.elements.add_spring(spring)
    }

    /// Adds springs, and sorts all single ones by their ends: neighbours in memory follow in use.
    ///
    /// # Errors
    /// As [`add_spring`](Self::add_spring), for the first that cannot be: none after it is added.
    pub fn add_springs(&mut self, springs: impl IntoIterator<Item = Spring>) -> Result<(), Error> {
        let mut springs = springs.into_iter();
        let added = springs.try_for_each(|spring| self.add_spring(spring));
        self.elements.sort_springs();
        added
    }

    /// Adds a bend spring that buckles.
    ///
    /// # Errors
    /// An end does not exist, or both are the same; a number is negative or not finite; the rest
    /// length or the stiffness against bending is 0, or the compression stiffness less than 4 pi2
    /// `k_b` / r3.
    pub fn add_buckling(&mut self, buckling: Buckling) -> Result<(), Error> {
        self.elements.add_buckling(buckling)
    }

    /// Multiplies the stiffness and the damping of every spring and solid by these factors, and
    /// those of the fluid, the square of its speed of sound and its viscosity.
    ///
    /// # Errors
    /// The factor of the stiffness is not a finite number above 0, or that of the damping not one
    /// of at least 0.
    pub fn scale_springs(&mut self, stiffness: f64, damping: f64) -> Result<(), Error> {
        positive("the factor of the stiffness", stiffness)?;
        at_least(0.0, "the factor of the damping", damping)?;
        for element in self.elements.all_mut() {
            element.force_mut().scale(stiffness, damping);
        }
        Ok(())
    }

    /// Copies the springs, the solids and the fluid of another network of the same particles.
    /// Springs that have broken here stay broken, and what has left the fluid stays outside.
    ///
    /// # Errors
    /// The other has not as many particles.
    pub fn copy_springs(&mut self, other: &Self) -> Result<(), Error> {
        self.strain_limits.forget();
        let drained = drained(self).to_vec();
        self.elements.copy_springs(&other.elements)?;
        remove_torn(self);
        set_drained(self, &drained);
        Ok(())
    }

    /// Sets the length over rest length at which springs break. With `None`, as in a new network,
    /// they never break, and springs of rest length 0 never do.
    ///
    /// # Errors
    /// The limit is not a finite number above 1, or a limit of strain keeps springs below it.
    pub fn set_tear(&mut self, limit: Option<f64>) -> Result<(), Error> {
        Tears::check_limit(limit)?;
        self.strain_limits.check_tear(limit)?;
        self.tears.set_limit(limit);
        Ok(())
    }

    /// Breaks the springs between these pairs of particles.
    ///
    /// # Errors
    /// There is no spring between a pair of them.
    pub fn break_springs(&mut self, pairs: &[[usize; 2]]) -> Result<(), Error> {
        if !pairs.is_empty() {
            self.elements.check_springs(pairs)?;
            break_between(self, pairs.iter().map(|&[i, j]| [i.min(j), i.max(j)]));
        }
        Ok(())
    }

    /// Copies the springs and triangles of the same network in its initial state, except those
    /// between these pairs of particles.
    ///
    /// # Errors
    /// The other has not as many particles, or no such springs.
    pub fn mend(&mut self, whole: &Self, torn: &[[usize; 2]]) -> Result<(), Error> {
        self.tears.copy_torn(&whole.tears);
        self.copy_springs(whole)?;
        self.surfaces.triangles.clone_from(&whole.surfaces.triangles);
        self.renew_contact();
        let more = torn.iter().filter(|[i, j]| !whole.is_torn(*i, *j));
        self.break_springs(&more.copied().collect::<Vec<_>>())
    }

    /// Breaks the springs that at x (m) exceed the length at which they break, or fall short of it
    /// by at most the fraction `share`, and the bend springs along them. Returns the number of
    /// pairs of particles between which springs broke.
    pub fn tear(&mut self, x: &[f64], share: f64) -> usize {
        if !self.is_overstretched(x, share) {
            return 0;
        }
        let pairs = self.tears.breaking(&self.elements, x, share);
        break_between(self, pairs)
    }

    /// Lets the free particles of the fluid leave it that are in its outflows in the state y, or
    /// less than `slack` (m) outside. Where they are, they stay, and act on nothing any more.
    /// Returns whether there are any.
    pub fn drain(&mut self, y: &mut [f64], slack: f64) -> bool {
        let entered: Vec<u32> = entered(self, y, slack).collect();
        leave(self, y, &entered);
        !entered.is_empty()
    }

    /// Sets or removes the limit of the length over rest length of structural and shear springs
    /// among some particles, in place of earlier limits of any of these. Springs of rest length 0
    /// are not limited. Integrators do not know the limits: a [`Simulation`](crate::Simulation)
    /// shortens the springs that are too long after each step.
    ///
    /// # Errors
    /// The limit is not a finite number above 1, or there are no such particles; or springs that
    /// break at that stretch or above would never be stretched so far.
    pub fn set_strain_limit(
        &mut self,
        particles: Range<usize>,
        limit: Option<f64>,
    ) -> Result<(), Error> {
        let (n, tear) = (self.particles.len(), self.tears.limit());
        self.strain_limits.set(particles, limit, n, tear)
    }

    /// Lists the limited springs, if there are any and they are not listed yet.
    pub(crate) fn list_strained(&mut self) {
        let inverse_masses = self.particles.inverse_masses();
        self.strain_limits.list(&self.elements, inverse_masses);
    }

    /// Adds a constraint, which is held by forces. A state that violates it is drawn back to it.
    /// The two sides of a joint do not touch each other any more.
    ///
    /// # Errors
    /// There is no such particle; both ends of a rod are the same; a joint names no rigid body; or
    /// a number is out of its range.
    pub fn add_constraint(&mut self, constraint: Constraint) -> Result<(), Error> {
        let (first, second) = constraint.ends();
        self.particles.check(first)?;
        self.particles.check(second.unwrap_or(first))?;
        let bodies = &self.bodies;
        self.constraints.add(&constraint, |i| bodies.belonging(i))?;
        self.renew_contact();
        Ok(())
    }

    /// Sets the natural frequency w (1/s) with which errors of the constraints decay, like a
    /// critically damped spring, C'' = -w2 C - 2 w C' (Baumgarte). The default is 10: errors decay
    /// within a second. Explicit methods need steps well below 1 / w.
    ///
    /// # Errors
    /// w is not a finite number above 0.
    pub fn set_baumgarte_frequency(&mut self, w: f64) -> Result<(), Error> {
        self.constraints.set_baumgarte_frequency(w)
    }

    /// Adds a rigid body, of a particle that is its centre of mass and of particles that it carries
    /// from now on, whose masses become 0. The state gets seven more numbers, which
    /// [`Rotation`](crate::rigid::Rotation) writes.
    ///
    /// # Errors
    /// A particle does not exist, belongs to another body already, is pinned or in a
    /// sheet.
    pub fn add_body(&mut self, body: Body) -> Result<(), Error> {
        self.bodies.check(&body, &self.particles, &self.elements)?;
        self.particles.carry(body.points());
        self.bodies.add(body);
        self.constraints = (self.constraints).with_carriers(|i| self.bodies.belonging(i))?;
        self.renew_contact();
        Ok(())
    }

    /// Adds a motor.
    ///
    /// # Errors
    /// There is no such body, or a number is not finite.
    pub fn add_motor(&mut self, motor: Motor) -> Result<(), Error> {
        self.bodies.add_motor(motor)
    }

    /// Sets the triangles between particles, on which [wind](Wind::on_triangles) blows and which
    /// can touch, in place of earlier ones.
    ///
    /// # Errors
    /// A corner does not exist.
    pub fn set_triangles(
        &mut self,
        triangles: impl IntoIterator<Item = [usize; 3]>,
    ) -> Result<(), Error> {
        let checked = triangles.into_iter().map(|corners| {
            let mut all = corners.iter();
            all.try_for_each(|&i| self.particles.check(i))?;
            Ok(corners.map(|i| i as u32))
        });
        self.surfaces.triangles = checked.collect::<Result<_, Error>>()?;
        self.renew_contact();
        Ok(())
    }

    /// Sets the contact properties of surfaces. With `None`, as in a new network, surfaces pass
    /// through one another, and only obstacles stop particles.
    ///
    /// # Errors
    /// There is not one skin for each particle, or a number of one is negative or not finite; or an
    /// edge has an end that does not exist.
    pub fn set_touch(&mut self, touch: Option<Touch>) -> Result<(), Error> {
        self.surfaces.set_touch(touch, &self.particles)?;
        self.renew_contact();
        Ok(())
    }

    /// Adds an obstacle. Obstacles move particles out in the order in which they were added.
    ///
    /// # Errors
    /// Its shape has no size, or its friction is negative; or a number is not finite.
    pub fn add_obstacle(&mut self, obstacle: Obstacle) -> Result<(), Error> {
        self.surfaces.add_obstacle(obstacle)?;
        self.renew_contact();
        Ok(())
    }

    /// Removes obstacle k; those after it move up by one.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn remove_obstacle(&mut self, k: usize) -> Result<Obstacle, Error> {
        let removed = self.surfaces.remove_obstacle(k)?;
        self.renew_contact();
        Ok(removed)
    }

    /// Sets the path of obstacle k from now on.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn lead_obstacle(&mut self, k: usize, path: Path) -> Result<(), Error> {
        let obstacle = self.surfaces.lead_obstacle(k, path)?;
        if let Some(layer) = self.elements.first_mut::<ContactLayer>() {
            layer.set_obstacle(k, obstacle.clone());
        }
        Ok(())
    }

    /// Replaces the shape of obstacle k.
    ///
    /// # Errors
    /// There is no such obstacle, or the shape has no size.
    pub fn reshape_obstacle(&mut self, k: usize, shape: Shape) -> Result<(), Error> {
        self.surfaces.reshape_obstacle(k, shape)?;
        self.renew_contact();
        Ok(())
    }

    /// Creates the contact of surfaces again, with the present triangles and obstacles.
    pub(super) fn renew_contact(&mut self) {
        let jointed = (self.bodies.all(), self.constraints.all());
        let layer = self.surfaces.layer(jointed, &self.tears, drained(self));
        self.elements.replace_all(layer);
    }
}

/// Breaks the springs between pairs of particles, given with the lower number first. Returns the
/// number of new pairs.
fn break_between(network: &mut Network, pairs: impl IntoIterator<Item = [usize; 2]>) -> usize {
    let new = network.tears.add(pairs);
    remove_torn(network);
    network.surfaces.leave_out_holes(&network.tears);
    network.renew_contact();
    new
}

/// Removes the springs between particles where one has broken.
fn remove_torn(network: &mut Network) {
    let torn = network.tears.torn();
    if !torn.is_empty() {
        network.strain_limits.forget();
        network.elements.remove_springs(torn);
    }
}
