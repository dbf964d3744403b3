//! Properties of a network and of its states.

use std::ops::Range;

use nalgebra::Vector3;

use super::elements::Element;
use super::evaluation::{at, prescribed};
use super::parts::Network;
use super::surfaces::Touch;
use super::{crossings, evaluation, holding};
use crate::constraints::Constraint;
use crate::contact::{ContactLayer, Crossed, Obstacle, StrainLimit, crossed};
use crate::elements::{Buckling, Finish, Fluid, Sheet, Wind};
use crate::energy::Energy;
use crate::error::{Error, Unmet};
use crate::path::{Path, Pose};
use crate::pin::Pin;
use crate::rigid::{Body, Rotation};
use crate::spring::Spring;

impl Network {
    /// Returns the number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.particles.len()
    }

    /// Returns the mass of each particle (kg), of pinned ones too; 0 for a point of a rigid body.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        self.particles.masses()
    }

    /// Checks that particle i exists.
    ///
    /// # Errors
    /// There is no particle i.
    pub fn check_particle(&self, i: usize) -> Result<(), Error> {
        self.particles.check(i)
    }

    /// Returns the particles that pins hold now, and their paths.
    pub fn pins(&self) -> impl Iterator<Item = (usize, Path)> {
        let pins = self.particles.pins().iter();
        pins.map(|pin| (pin.particle, pin.path))
    }

    /// Returns all pins: those that have let go, and then those that hold.
    pub fn all_pins(&self) -> impl Iterator<Item = Pin> {
        let released = self.particles.released().iter();
        released.chain(self.particles.pins()).copied()
    }

    /// Returns whether particle i is pinned.
    #[must_use]
    pub fn is_pinned(&self, i: usize) -> bool {
        self.particles.is_pinned(i)
    }

    /// Returns whether particle i is a point of a rigid body.
    #[must_use]
    pub fn is_carried(&self, i: usize) -> bool {
        self.particles.is_carried(i)
    }

    /// Returns the elements, in the order of their types.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        self.elements.all()
    }

    /// Returns the names of the forces and obstacles in use.
    #[must_use]
    pub fn forces_in_use(&self) -> Vec<&'static str> {
        let obstacles = self.obstacles().iter();
        let shapes: Vec<_> = obstacles.map(|obstacle| obstacle.shape.name()).collect();
        let shown = ["sphere", "box", "capsule", "floor"].into_iter();
        let constraints = self.is_constrained().then_some("constraints");
        let motors = evaluation::has_motors(self).then_some("motors");
        let tearing = self.tear_limit().map(|_| "tearing");
        let limits = (!self.strain_limits().is_empty()).then_some("strain limit");
        let others = constraints
            .into_iter()
            .chain(motors)
            .chain(shown.filter(|name| shapes.contains(name)))
            .chain(tearing)
            .chain(limits);
        self.elements.names().into_iter().chain(others).collect()
    }

    /// Returns the sheets.
    pub fn sheets(&self) -> impl Iterator<Item = &Sheet> {
        self.elements.sheets()
    }

    /// Returns gravity g (m/s2), if there is any.
    #[must_use]
    pub fn gravity(&self) -> Option<Vector3<f64>> {
        self.elements.gravity()
    }

    /// Returns the coefficient c (kg/s) of viscous drag, if there is any.
    #[must_use]
    pub fn drag(&self) -> Option<f64> {
        self.elements.drag()
    }

    /// Returns the wind, if it blows.
    #[must_use]
    pub fn wind(&self) -> Option<&Wind> {
        self.elements.wind()
    }

    /// Returns the fluid, if there is one.
    #[must_use]
    pub fn fluid(&self) -> Option<&Fluid> {
        self.elements.fluid()
    }

    /// Returns whether particle i is in a wall: of the fluid, and pinned or carried by a rigid
    /// body.
    #[must_use]
    pub fn is_wall(&self, i: usize) -> bool {
        let contains = |fluid: &Fluid| fluid.members().contains(i);
        (self.is_pinned(i) || self.is_carried(i)) && self.fluid().is_some_and(contains)
    }

    /// Returns the number of particles in walls that are pinned, and so have no errors.
    #[must_use]
    pub fn fixed_walls(&self) -> usize {
        let of = |fluid: &Fluid| self.pins().filter(|(i, _)| fluid.members().contains(*i)).count();
        self.fluid().map_or(0, of)
    }

    /// Returns the bend springs that buckle.
    pub fn buckling(&self) -> impl Iterator<Item = Buckling> {
        self.elements.buckling()
    }

    /// Returns all springs except those that buckle, those of sheets first.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.elements.springs()
    }

    /// Returns all springs, those that buckle as they are while straight.
    pub fn all_springs(&self) -> impl Iterator<Item = Spring> {
        self.elements.all_springs()
    }

    /// Returns the springs attached to particle i, those that buckle as they are while straight.
    pub fn springs_of(&self, i: usize) -> impl Iterator<Item = Spring> {
        self.all_springs().filter(move |s| s.i == i || s.j == i)
    }

    /// Returns each neighbour of particle i in a solid, with its distance at rest (m).
    pub(crate) fn neighbours_in_solids(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let solids = self.elements.solids();
        solids.flat_map(move |solid| solid.neighbours(i))
    }

    /// Returns whether there are springs or solids.
    #[must_use]
    pub fn is_elastic(&self) -> bool {
        self.elements.elastic().any(|element| !element.is_empty())
    }

    /// Returns whether springs or solids are damped.
    #[must_use]
    pub fn is_damped(&self) -> bool {
        let mut elastic = self.elements.elastic();
        elastic.any(|element| element.force().reads_velocity())
    }

    /// Writes the forces (N) of all springs to f, in the state (x, v).
    pub fn spring_forces(&self, x: &[f64], v: &[f64], f: &mut [f64]) {
        let springs = self.elements.elastic();
        self.elements.sum(springs, &at(self, 0.0, x, v), f, &Finish::default());
    }

    /// Returns the strain at each particle at x (m), n x 3: the largest difference from 1 of the
    /// length over rest length of its springs, or of the principal stretches of its tetrahedra; NaN
    /// for a particle without either. Springs of rest length 0 are left out.
    #[must_use]
    pub fn strains(&self, x: &[f64]) -> Vec<f64> {
        self.elements.strains(x)
    }

    /// Returns the length over rest length of the structural spring that is stretched most, or the
    /// largest principal stretch of a solid, if there is any.
    #[must_use]
    pub fn largest_stretch(&self, x: &[f64]) -> Option<f64> {
        self.elements.largest_stretch(x)
    }

    /// Returns the length over rest length at which springs break, if they can.
    #[must_use]
    pub fn tear_limit(&self) -> Option<f64> {
        self.tears.limit()
    }

    /// Returns the number of pairs of particles between which springs have broken.
    #[must_use]
    pub fn tears(&self) -> usize {
        self.tears.torn().len()
    }

    /// Returns the pairs of particles between which springs have broken, the lower number of each
    /// first, in order.
    #[must_use]
    pub fn torn(&self) -> &[[usize; 2]] {
        self.tears.torn()
    }

    /// Returns whether a spring between particles i and j has broken.
    #[must_use]
    pub fn is_torn(&self, i: usize, j: usize) -> bool {
        self.tears.is_torn(i, j)
    }

    /// Returns whether a triangle has all its sides. Others are not drawn.
    #[must_use]
    pub fn is_whole(&self, corners: [usize; 3]) -> bool {
        self.tears.is_whole(corners)
    }

    /// Returns whether springs at x (m) exceed the length at which they break, or fall short of it
    /// by at most the fraction `share`.
    pub(crate) fn is_overstretched(&self, x: &[f64], share: f64) -> bool {
        self.tears.is_overstretched(&self.elements, x, share)
    }

    /// Limits of the length over rest length of springs, each with the particles among which it
    /// applies.
    #[must_use]
    pub fn strain_limits(&self) -> &[(Range<usize>, f64)] {
        self.strain_limits.all()
    }

    /// Returns the limited springs, as last listed.
    pub(crate) fn strained(&self) -> Option<&StrainLimit> {
        self.strain_limits.listed()
    }

    /// Returns the constraints, their directions of length 1.
    #[must_use]
    pub fn constraints(&self) -> &[Constraint] {
        self.constraints.all()
    }

    pub(crate) fn is_constrained(&self) -> bool {
        !self.constraints.all().is_empty()
    }

    /// Returns whether constraints hold particle i.
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        let mut ends = self.constraints().iter().map(Constraint::ends);
        ends.any(|(a, b)| a == i || b == Some(i))
    }

    /// Returns the other end and the length (m) of each rod attached to particle i.
    pub fn rods_of(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        self.constraints().iter().filter_map(move |c| match *c {
            Constraint::Rod { i: a, j: b, length } if a == i || b == i => Some((a + b - i, length)),
            _ => None,
        })
    }

    /// Returns the largest error |C| (m) of constraints in y; without joints, positions are enough.
    #[must_use]
    pub fn constraint_error(&self, y: &[f64]) -> Option<f64> {
        holding::error(self, y)
    }

    /// Returns the constraint with the largest relative error in y, in a scene of a radius (m).
    #[must_use]
    pub fn worst_constraint(&self, y: &[f64], radius: f64) -> Option<Unmet> {
        holding::worst(self, y, radius)
    }

    /// Returns the rigid bodies, in the order in which they were added.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        self.bodies.all()
    }

    /// Returns the body to which particle i belongs, as its centre or as a point.
    #[must_use]
    pub fn body_of(&self, i: usize) -> Option<usize> {
        self.bodies.body_of(i)
    }

    /// Returns the rotation of body k in the state y.
    #[must_use]
    pub fn rotation(&self, k: usize, y: &[f64]) -> Rotation {
        self.bodies.rotation(k, y)
    }

    /// Writes the rotation of body k to the state y. Its points follow at the next step.
    pub fn set_rotation(&self, k: usize, rotation: &Rotation, y: &mut [f64]) {
        rotation.write(&mut y[self.bodies.numbers(k)]);
    }

    /// Returns the place and orientation of body k in the state y.
    #[must_use]
    pub fn pose(&self, k: usize, y: &[f64]) -> Pose {
        let (x, v) = self.halves(y);
        self.bodies()[k].pose(&self.rotation(k, y), x, v)
    }

    /// Returns the positions and velocities, n x 3 each, of a state.
    #[must_use]
    pub fn halves<'a>(&self, y: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let n = 3 * self.particles();
        (&y[..n], &y[n..2 * n])
    }

    /// Returns the triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.surfaces.triangles
    }

    /// Returns the obstacles in the order in which they were added.
    #[must_use]
    pub fn obstacles(&self) -> &[Obstacle] {
        self.surfaces.obstacles()
    }

    /// Returns the obstacles as single particles meet them.
    pub(crate) fn solids(&self) -> &[Obstacle] {
        self.surfaces.solids()
    }

    /// Checks that obstacle k exists.
    ///
    /// # Errors
    /// There is no obstacle k.
    pub fn check_obstacle(&self, k: usize) -> Result<(), Error> {
        self.surfaces.check_obstacle(k)
    }

    /// Returns whether pins or obstacles move at any time, or pins let go.
    #[must_use]
    pub fn moves_by_itself(&self) -> bool {
        prescribed(self).moves()
    }

    /// Returns the contact properties of surfaces, if they can touch.
    #[must_use]
    pub fn touch(&self) -> Option<&Touch> {
        self.surfaces.touch()
    }

    /// Returns whether particles can touch obstacles, or surfaces one another.
    #[must_use]
    pub fn can_touch(&self) -> bool {
        !self.obstacles().is_empty() || self.touch().is_some_and(|touch| touch.bodies)
    }

    /// Returns the contact of surfaces, if they can touch.
    #[must_use]
    pub fn contact_layer(&self) -> Option<&ContactLayer> {
        self.elements.contact_layer()
    }

    /// Returns the surfaces that pass through one another at time t (s) at x (m), n x 3, also if
    /// contact is off.
    #[must_use]
    pub fn crossed(&self, t: f64, x: &[f64]) -> Vec<Crossed> {
        if let Some(layer) = self.contact_layer() {
            return crossed(layer, t, x);
        }
        let jointed = (self.bodies(), self.constraints());
        let all = self.surfaces.layer_of_all(jointed, self.particles());
        crossed(&all, t, x)
    }

    /// Checks that no surfaces pass through one another at time t (s) at x (m), n x 3.
    ///
    /// # Errors
    /// Surfaces cross: the message names the first pair of triangles or edges, its place, and the
    /// connected parts that cross. Or too many are at one place to be tested pair by pair.
    pub fn check_apart(&self, t: f64, x: &[f64]) -> Result<(), Error> {
        crossings::check_apart(self, t, x)
    }

    /// Returns the energy in the state (x, v) at time 0, and at all times if no obstacle moves.
    /// Drag, damping and wind have no energy.
    #[must_use]
    pub fn energy(&self, x: &[f64], v: &[f64]) -> Energy {
        self.energy_at(0.0, x, v)
    }

    /// Returns the energy in the state (x, v) at time t (s), where obstacles are then.
    #[must_use]
    pub fn energy_at(&self, t: f64, x: &[f64], v: &[f64]) -> Energy {
        evaluation::energy_at(self, t, x, v)
    }

    /// Returns the energy of the state y at time t (s), that of rotations included.
    #[must_use]
    pub fn energy_of(&self, t: f64, y: &[f64]) -> Energy {
        evaluation::energy_of(self, t, y)
    }
}
