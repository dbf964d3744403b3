//! A network as integrators see it: forces, accelerations, kicks and drifts, couplings and springs.

use super::elements;
use super::elements::Element;
use super::evaluation::{at, finish, flow, has_motors, other_forces};
use super::holding::hold_particles;
use super::parts::Network;
use crate::columns::columns_mut;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::{Drag, Finish};
use crate::error::Error;
use crate::held::HeldView;
use crate::path::Place;
use crate::products::{Products, SolverHints};
use crate::rows::Terms;
use crate::spring::SpringLaw;
use crate::system::{
    Compliant, Linearized, Mechanics, RigidView, RowsView, Splitting, divide_by_masses, place_pins,
};

impl Mechanics for Network {
    fn inverse_masses(&self) -> &[f64] {
        self.particles.inverse_masses()
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        other_forces(self, t, x, v, f);
        hold_particles(self, t, [x, v], f);
    }

    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        if self.is_constrained() {
            self.forces(t, x, v, a);
            divide_by_masses(self.particles.inverse_masses(), a);
            return;
        }
        let finish = Finish {
            inverse_masses: Some(self.particles.inverse_masses()),
            ..finish(self, Terms::AllForces)
        };
        self.elements.evaluate(&at(self, t, x, v), a, &finish);
    }

    fn drag_coefficient(&self) -> f64 {
        self.elements.drift_forces().drag
    }

    fn pins(&self, t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for pin in self.particles.pins() {
            visit(pin.particle, pin.at(t));
        }
    }

    fn is_rough(&self) -> bool {
        self.obstacles().iter().any(|o| o.friction > 0.0)
    }

    fn take_failure(&self) -> Option<Error> {
        let mut elements = self.elements().iter();
        elements.find_map(|element| element.force().take_failure())
    }

    /// Returns the rows of sheets, if sheets alone couple particles: other couplings would reach
    /// rows that a sweep has left.
    fn rows(&self) -> Option<RowsView<'_>> {
        let sweeps = self.elements.are_in_rows() && !self.is_constrained();
        sweeps.then_some(RowsView(self))
    }

    fn rigid(&self) -> Option<RigidView<'_>> {
        (!self.bodies().is_empty()).then_some(RigidView(self))
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        Some(self)
    }

    fn compliant(&self) -> Option<&dyn Compliant> {
        let by_spring = self.elements.are_springs() && !self.is_constrained();
        by_spring.then_some(self as &dyn Compliant)
    }
}

impl Splitting for Network {
    /// Writes all forces except gravity and drag, which are in the drift, or all forces if there
    /// are constraints.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let finish = finish(self, Terms::KickForces);
        self.elements.evaluate(&at(self, t, x, v), f, &finish);
        hold_particles(self, t, [x, v], f);
    }

    fn kick_reads_velocity(&self) -> bool {
        let reads = |e: &Element| e.force().drift_forces().is_none() && e.force().reads_velocity();
        self.is_constrained() || has_motors(self) || self.elements().iter().any(reads)
    }

    /// Solves x' = v, v' = g - (c/m) v exactly; with constraints, v is constant.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let all = 0..self.particles();
        flow(self, Terms::KickForces, h, all, columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Linearized for Network {
    fn force_differential(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        df.fill(0.0);
        for element in self.elements() {
            let at = at(self, t, x, v);
            element.force().add_differential(&at, [dx, dv], df);
        }
    }

    fn couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for element in self.elements() {
            element.force().couplings(t, x, clamped, visit);
        }
    }

    fn lists_all_couplings(&self) -> bool {
        let mut elements = self.elements().iter();
        elements.all(|element| element.force().lists_all_couplings())
    }

    fn baumgarte_frequency(&self) -> Option<f64> {
        self.is_constrained().then(|| self.constraints.baumgarte_frequency())
    }

    /// Returns the constraints, unless surfaces touch, whose pairs of vertices change.
    fn held(&self) -> Option<HeldView<'_>> {
        let is_served = self.is_constrained() && self.hints().pattern_is_fixed();
        is_served.then_some(HeldView(self))
    }

    fn products(&self) -> Option<&dyn Products> {
        let mut elements = self.elements().iter();
        elements
            .any(|element| element.force().multiplies_together())
            .then_some(self as &dyn Products)
    }

    /// The reach is half the largest thickness of surfaces that touch.
    fn hints(&self) -> SolverHints {
        let thickest = self.contact_layer().map(|layer| layer.surface().thickest());
        let thickest = thickest.filter(|thickness| *thickness > 0.0);
        SolverHints {
            reach: thickest.map_or(f64::INFINITY, |thickness| 0.5 * thickness),
            speed: self.elements.speed(),
            assembly: self.elements.assembly(),
            iteration: self.elements.iteration(),
        }
    }
}

impl Products for Network {
    fn multiply(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
        elements::multiply(&self.elements, matrix, p, out)
    }

    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        elements::add_diagonal(&self.elements, matrix, diagonal)
    }

    fn other_couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        elements::other_couplings(&self.elements, t, x, clamped, visit);
    }
}

impl Compliant for Network {
    /// Visits springs of sheets, direction by direction, and then single ones.
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        self.springs().for_each(|s| visit([s.i, s.j], s.law));
    }

    fn other_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        let is_other = |e: &&Element| !e.is_elastic() && e.get::<Drag>().is_none();
        for element in self.elements().iter().filter(is_other) {
            element.force().add_forces(&at(self, t, x, v), f);
        }
    }
}
