//! How a network is built and changed.

use std::ops::Range;

use nalgebra::Vector3;

use super::bodies::Bodies;
use super::elements::Elements;
use super::particles::Particles;
use super::parts::Network;
use super::strain::StrainLimits;
use super::surfaces::{Surfaces, Touch};
use super::tearing::Tears;
use crate::constraints::{Constraint, Constraints};
use crate::contact::{Obstacle, Shape};
use crate::elements::{Buckling, Element, Wind};
use crate::error::{Error, at_least, positive};
use crate::path::Path;
use crate::rigid::Body;
use crate::spring::Spring;

impl Network {
    /// Free particles of these masses (kg), without any force.
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

    /// Adds an element, after those of its kind.
    ///
    /// # Errors
    /// A particle that it names does not exist, or a particle would be in two sheets.
    pub fn add(&mut self, element: impl Into<Element>) -> Result<(), Error> {
        self.strain_limits.forget();
        self.elements.add(element.into())
    }

    /// Leads particle i along `path` from now on, whether it was pinned before or not.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it.
    pub fn pin(&mut self, i: usize, path: Path) -> Result<(), Error> {
        self.particles.check(i)?;
        self.check_led(i)?;
        if self.particles.pin(i, path) {
            self.strain_limits.forget();
        }
        Ok(())
    }

    /// Leads particles along paths, as [`pin`](Self::pin) does one: the last path of each counts.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it; none is pinned then.
    pub fn pin_all(&mut self, pins: Vec<(usize, Path)>) -> Result<(), Error> {
        for (i, _) in &pins {
            self.particles.check(*i)?;
            self.check_led(*i)?;
        }
        self.particles.pin_all(pins);
        self.strain_limits.forget();
        Ok(())
    }

    /// Lets particle i go. Does nothing if it is free.
    pub fn unpin(&mut self, i: usize) {
        if self.particles.unpin(i) {
            self.strain_limits.forget();
        }
    }

    /// Gives every pin the path that `path` makes of its own.
    pub fn lead_pins(&mut self, path: impl FnMut(usize, Path) -> Path) {
        self.particles.lead_pins(path);
    }

    /// Checks that particle i can be led along a path by itself.
    pub(crate) fn check_led(&self, i: usize) -> Result<(), Error> {
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

    /// Lets wind blow on particles or on triangles, or calms it.
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

    /// Adds springs in any order, and keeps all in the order of their ends: neighbours in memory
    /// are then used one after another.
    ///
    /// # Errors
    /// As [`add_spring`](Self::add_spring), for the first that cannot be: none after it is added.
    pub fn add_springs(&mut self, springs: impl IntoIterator<Item = Spring>) -> Result<(), Error> {
        let mut springs = springs.into_iter();
        let added = springs.try_for_each(|spring| self.add_spring(spring));
        self.elements.sort_springs();
        added
    }

    /// Adds a bend spring that buckles, in place of one that does not.
    ///
    /// # Errors
    /// An end does not exist, or both are the same; a number is negative or not finite; the rest
    /// length or the stiffness against bending is 0, or the compression stiffness less than 4 pi2
    /// `k_b` / r3.
    pub fn add_buckling(&mut self, buckling: Buckling) -> Result<(), Error> {
        self.elements.add_buckling(buckling)
    }

    /// Multiplies the stiffness and the damping of every spring and solid by these factors, and
    /// likewise those of the fluid: the square of its speed of sound, and its viscosity.
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

    /// Takes over the springs, the solids and the fluid of another network of the same particles.
    /// Those that have broken here stay broken.
    ///
    /// # Errors
    /// The other has not as many particles.
    pub fn copy_springs(&mut self, other: &Self) -> Result<(), Error> {
        self.strain_limits.forget();
        self.elements.copy_springs(&other.elements)?;
        self.remove_torn();
        Ok(())
    }

    /// Lets springs break at so many times their rest length, or never, as in a new network.
    /// Springs of rest length 0 never break.
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
            self.break_between(pairs.iter().map(|&[i, j]| [i.min(j), i.max(j)]));
        }
        Ok(())
    }

    /// Takes over the springs and triangles of the same network as it began, except those between
    /// these pairs of particles.
    ///
    /// # Errors
    /// The other has not as many particles, or no such springs.
    pub fn mend(&mut self, whole: &Self, torn: &[[usize; 2]]) -> Result<(), Error> {
        self.tears.copy_torn(&whole.tears);
        self.copy_springs(whole)?;
        self.surfaces
            .triangles
            .clone_from(&whole.surfaces.triangles);
        self.renew_contact();
        let more = torn.iter().filter(|[i, j]| !whole.is_torn(*i, *j));
        self.break_springs(&more.copied().collect::<Vec<_>>())
    }

    /// Breaks the springs that are too long at x (m), or lack no more than that share of their
    /// length, and those that go with them. Returns the number of pairs between which it broke
    /// some.
    pub fn tear(&mut self, x: &[f64], share: f64) -> usize {
        if !self.is_overstretched(x, share) {
            return 0;
        }
        let pairs = self.tears.breaking(&self.elements, x, share);
        self.break_between(pairs)
    }

    /// Breaks the springs between pairs of particles, the lower number of each first. Returns the
    /// number of new pairs.
    fn break_between(&mut self, pairs: impl IntoIterator<Item = [usize; 2]>) -> usize {
        let new = self.tears.add(pairs);
        self.remove_torn();
        self.surfaces.leave_out_holes(&self.tears);
        self.renew_contact();
        new
    }

    /// Removes the springs between particles where one has broken.
    fn remove_torn(&mut self) {
        if !self.tears.torn().is_empty() {
            self.strain_limits.forget();
            self.elements.remove_springs(self.tears.torn());
        }
    }

    /// Limits the length over rest length of structural and shear springs among some particles, in
    /// place of limits of any of these; or lets them be as long as they may. Springs of rest length
    /// 0 are not limited. Integrators know nothing of it: a [`Simulation`](crate::Simulation)
    /// shortens what is too long after each step.
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

    /// Lists the springs that are limited, if any are and if they are not listed yet.
    pub(crate) fn list_strained(&mut self) {
        let inverse_masses = self.particles.inverse_masses();
        self.strain_limits.list(&self.elements, inverse_masses);
    }

    /// Adds a constraint, which is held by forces: a state that breaks it is drawn back to it.
    ///
    /// # Errors
    /// There is no such particle; both ends of a rod are the same; or a number makes no sense.
    pub fn add_constraint(&mut self, constraint: Constraint) -> Result<(), Error> {
        let (first, second) = constraint.ends();
        self.particles.check(first)?;
        self.particles.check(second.unwrap_or(first))?;
        let carrier = |i| self.bodies.carrier(&self.particles, i);
        self.constraints.add(constraint, carrier)
    }

    /// Sets the natural frequency w (1/s) with which errors of the constraints are taken back, like
    /// a critically damped spring, C'' = -w2 C - 2 w C' (Baumgarte). It is 10 unless set: errors
    /// are gone within a second, slowly for any step that shows motion at all. Explicit methods
    /// need steps well below 1 / w.
    ///
    /// # Errors
    /// w is not a finite number above 0.
    pub fn set_baumgarte_frequency(&mut self, w: f64) -> Result<(), Error> {
        self.constraints.set_baumgarte_frequency(w)
    }

    /// Makes a rigid body of a particle, its centre of mass, and of particles that it carries from
    /// now on: their masses become 0. The state gets seven numbers more, which
    /// [`Rotation`](crate::rigid::Rotation) writes.
    ///
    /// # Errors
    /// A particle does not exist, belongs to another body already, is pinned or in a
    /// sheet.
    pub fn add_body(&mut self, body: Body) -> Result<(), Error> {
        self.bodies.check(&body, &self.particles, &self.elements)?;
        self.particles.carry(body.points());
        self.bodies.add(body);
        // The body may carry what constraints hold.
        let carrier = |i| self.bodies.carrier(&self.particles, i);
        self.constraints = self.constraints.with_carriers(carrier)?;
        self.renew_contact();
        Ok(())
    }

    /// Spans triangles between particles, for [wind](Wind::on_triangles) to blow on, in place of
    /// earlier ones.
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

    /// Lets surfaces touch, or, as in a new network, pass through one another: then only obstacles
    /// are solid, and only to particles.
    ///
    /// # Errors
    /// There is not one skin for each particle, or a number of one is negative or not finite; or an
    /// edge has an end that does not exist.
    pub fn set_touch(&mut self, touch: Option<Touch>) -> Result<(), Error> {
        self.surfaces.set_touch(touch, &self.particles)?;
        self.renew_contact();
        Ok(())
    }

    /// Adds an obstacle after those that are there: particles are put out of one after another.
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

    /// Leads obstacle k along `path` from now on.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn lead_obstacle(&mut self, k: usize, path: Path) -> Result<(), Error> {
        let obstacle = self.surfaces.lead_obstacle(k, path)?;
        let mut elements = self.elements.all_mut().iter_mut();
        if let Some(layer) = elements.find_map(Element::contact_layer_mut) {
            layer.set_obstacle(k, obstacle.clone());
        }
        Ok(())
    }

    /// Gives obstacle k another shape.
    ///
    /// # Errors
    /// There is no such obstacle, or the shape has no size.
    pub fn reshape_obstacle(&mut self, k: usize, shape: Shape) -> Result<(), Error> {
        self.surfaces.reshape_obstacle(k, shape)?;
        self.renew_contact();
        Ok(())
    }

    /// Creates the contact of surfaces again, of the triangles and obstacles that are there now.
    fn renew_contact(&mut self) {
        let layer = self.surfaces.layer(self.bodies.all(), &self.tears);
        let is = |element: &Element| matches!(element, Element::ContactLayer(_));
        self.elements.replace(is, layer.map(Into::into));
    }
}
