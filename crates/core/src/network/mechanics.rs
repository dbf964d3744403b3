//! A network as integrators see it: forces, accelerations, kicks and drifts, couplings and springs.

use super::evaluation::{at, finish, flow, other_forces};
use super::holding::hold_particles;
use super::matrix;
use super::parts::Network;
use crate::columns::columns_mut;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::{Element, Finish};
use crate::path::Place;
use crate::rows::{Rows, Terms};
use crate::spring::SpringLaw;
use crate::system::{
    Compliant, Linearized, Mechanics, Rigid, Splitting, divide_by_masses, place_pins,
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

    fn pins(&self, t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for pin in self.particles.pins() {
            visit(pin.particle, pin.path.at(t));
        }
    }

    /// Rows of sheets, if nothing else acts on more than one particle: it would reach into rows
    /// that a sweep has left behind.
    fn rows(&self) -> Option<&dyn Rows> {
        let sweeps = self.elements.are_in_rows() && !self.is_constrained();
        sweeps.then_some(self as &dyn Rows)
    }

    fn rigid(&self) -> Option<&dyn Rigid> {
        (!self.bodies().is_empty()).then_some(self as &dyn Rigid)
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
    /// All forces but gravity and drag, which are in the drift, unless there are constraints.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let finish = finish(self, Terms::KickForces);
        self.elements.evaluate(&at(self, t, x, v), f, &finish);
        hold_particles(self, t, [x, v], f);
    }

    fn kick_reads_velocity(&self) -> bool {
        let reads = |e: &Element| e.force().carried().is_none() && e.force().reads_velocity();
        self.is_constrained() || self.elements().iter().any(reads)
    }

    /// x' = v, v' = g - (c/m) v, exactly; with constraints v stays.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let all = 0..self.particles();
        flow(
            self,
            Terms::KickForces,
            h,
            all,
            columns_mut(x),
            columns_mut(v),
        );
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

    fn multiply(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
        matrix::multiply(&self.elements, matrix, p, out)
    }

    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        matrix::add_diagonal(&self.elements, matrix, diagonal)
    }

    fn other_couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        matrix::other_couplings(&self.elements, t, x, clamped, visit);
    }

    fn lists_all_couplings(&self) -> bool {
        self.fluid().is_none()
    }

    /// Half the largest thickness (m) of surfaces that touch; infinite if none do.
    fn reach(&self) -> f64 {
        let thickest = self.contact_layer().map(|layer| layer.surface().thickest());
        let reach = thickest.filter(|thickness| *thickness > 0.0);
        reach.map_or(f64::INFINITY, |thickness| 0.5 * thickness)
    }

    fn speed(&self) -> f64 {
        self.elements.speed()
    }

    fn gathering(&self) -> f64 {
        self.elements.gathering()
    }

    fn drag_coefficient(&self) -> f64 {
        self.elements.carried().drag
    }

    fn baumgarte_frequency(&self) -> Option<f64> {
        self.is_constrained()
            .then(|| self.constraints.baumgarte_frequency())
    }
}

impl Compliant for Network {
    /// Those of sheets direction by direction, then the single ones.
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        for element in self.elements() {
            element.springs().for_each(|s| visit([s.i, s.j], s.law));
        }
    }

    fn other_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        let is_other = |e: &&Element| !e.is_elastic() && !matches!(e, Element::Drag(_));
        for element in self.elements().iter().filter(is_other) {
            element.force().add_forces(&at(self, t, x, v), f);
        }
    }

    fn drag_coefficient(&self) -> f64 {
        Linearized::drag_coefficient(self)
    }
}
