//! A network as integrators see it: forces, accelerations, kicks and drifts, at once or row by row.

use std::ops::Range;

use nalgebra::Vector3;

use super::Network;
use crate::columns::columns_mut;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::force::{At, ByParticle, Carried};
use crate::elements::sheet::{Advance, LAWS, Quantity, SPRING_FORCES, begin, set};
use crate::elements::{Element, Finish, Flow, Sheet, flow_each};
use crate::path::Place;
use crate::rows::{Patch, Registers, Rows, Stage, SweepScratch, Terms};
use crate::system::{
    Compliant, Linearized, Mechanics, Rigid, Splitting, divide_by_masses, place_pins,
};

impl Network {
    /// The arguments of elements.
    pub(super) fn at<'a>(&'a self, t: f64, x: &'a [f64], v: &'a [f64]) -> At<'a> {
        At {
            t,
            x,
            v,
            masses: &self.masses,
            triangles: &self.triangles,
        }
    }

    /// Writes all forces but those of constraints to f.
    pub(super) fn other_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(&self.at(t, x, v), f, &self.finish(Terms::AllForces));
    }

    /// Gravity and drag together.
    pub(super) fn carried(&self) -> Carried {
        let all = self.elements.iter().filter_map(|e| e.force().carried());
        all.fold(Carried::default(), |a, b| Carried {
            gravity: a.gravity + b.gravity,
            drag: a.drag + b.drag,
        })
    }

    /// Whether drifts carry gravity and drag: not with constraints, which hold against all forces
    /// together.
    pub(super) fn drifts_carry(&self, terms: Terms) -> bool {
        terms == Terms::KickForces && !self.is_constrained()
    }

    /// The gravity and drag that a drift carries.
    fn drifting(&self, terms: Terms) -> Carried {
        if self.drifts_carry(terms) {
            self.carried()
        } else {
            Carried::default()
        }
    }

    /// The gravity and drag that no drift carries.
    fn finish(&self, terms: Terms) -> Finish<'_> {
        if self.drifts_carry(terms) {
            return Finish::default();
        }
        let Carried { gravity, drag } = self.carried();
        Finish {
            gravity: (gravity != Vector3::zeros()).then_some((gravity, &self.masses)),
            drag: (drag > 0.0).then_some(drag),
            ..Finish::default()
        }
    }

    /// Sets f to the finished sum of all forces that no drift carries.
    pub(super) fn evaluate(&self, at: &At, f: &mut [f64], finish: &Finish) {
        let is_other = |e: &&Element| e.force().carried().is_none();
        self.sum(self.elements.iter().filter(is_other), at, f, finish);
    }

    /// Sets f to the finished sum of some elements: first those that are no sheets, in their order;
    /// on top of these each sheet, which finishes its own particles, so that nothing passes through
    /// memory twice.
    pub(super) fn sum<'a>(
        &'a self,
        elements: impl Iterator<Item = &'a Element> + Clone,
        at: &At,
        f: &mut [f64],
        finish: &Finish,
    ) {
        let is_other = |element: &&Element| element.sheet().is_none();
        let mut others = elements.clone().filter(is_other).peekable();
        let added = others.peek().is_some();
        if added {
            f.fill(0.0);
        } else {
            self.clear_single(f);
        }
        others.for_each(|element| element.force().add_forces(at, f));
        for sheet in elements.filter_map(Element::sheet) {
            set(Quantity::Forces, sheet, &[at.x, at.v], f, added, finish);
        }
        self.finish_single(at.v, f, finish);
    }

    /// Sets f to zero on the particles of no sheet.
    pub(super) fn clear_single(&self, f: &mut [f64]) {
        for column in f.chunks_exact_mut(self.particles()) {
            for particles in &self.single {
                column[particles.clone()].fill(0.0);
            }
        }
    }

    /// Finishes f on the particles of no sheet.
    pub(super) fn finish_single(&self, v: &[f64], f: &mut [f64], finish: &Finish) {
        for particles in &self.single {
            finish.apply(particles, v, f);
        }
    }

    /// Moves particles by what a drift carries. Pins are put in their places afterwards.
    fn flow(
        &self,
        terms: Terms,
        h: f64,
        particles: Range<usize>,
        x: [&mut [f64]; 3],
        v: [&mut [f64]; 3],
    ) {
        let Carried { drag, gravity } = self.drifting(terms);
        match self.uniform_inverse_mass {
            Some(w) => Flow::new(drag, gravity, w, h).apply(x, v),
            None => flow_each(drag, gravity, &self.inverse_masses[particles], h, x, v),
        }
    }

    /// Puts the pins of a row in their places at time t, wherever they were moved.
    fn place_row(&self, t: f64, particles: Range<usize>, row: usize, registers: &mut Registers) {
        for pin in self.pins_of(particles.clone()) {
            let place = pin.path.at(t);
            let columns = registers.stage_mut(row);
            for axis in 0..3 {
                let i = pin.particle - particles.start;
                columns[axis][i] = place.position[axis];
                columns[3 + axis][i] = place.velocity[axis];
            }
        }
    }

    /// The sheet that is a patch of rows.
    fn patch_sheet(&self, patch: usize) -> Option<&Sheet> {
        self.sheets().nth(patch)
    }

    /// The forces on each particle by itself.
    fn by_particle(&self) -> impl Iterator<Item = &dyn ByParticle> {
        self.elements.iter().filter_map(|e| e.force().by_particle())
    }
}

impl Mechanics for Network {
    fn inverse_masses(&self) -> &[f64] {
        &self.inverse_masses
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.other_forces(t, x, v, f);
        self.hold_particles(t, [x, v], f);
    }

    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        if self.is_constrained() {
            self.forces(t, x, v, a);
            divide_by_masses(&self.inverse_masses, a);
            return;
        }
        let finish = Finish {
            inverse_masses: Some(&self.inverse_masses),
            ..self.finish(Terms::AllForces)
        };
        self.evaluate(&self.at(t, x, v), a, &finish);
    }

    fn pins(&self, t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for pin in &self.pins {
            visit(pin.particle, pin.path.at(t));
        }
    }

    /// Rows of sheets, if nothing else acts on more than one particle: it would reach into rows
    /// that a sweep has left behind.
    fn rows(&self) -> Option<&dyn Rows> {
        let in_rows = |element: &Element| {
            let force = element.force();
            element.sheet().is_some() || force.carried().is_some() || force.by_particle().is_some()
        };
        let sweeps =
            self.single.is_empty() && self.elements.iter().all(in_rows) && !self.is_constrained();
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
        self.is_compliant().then_some(self as &dyn Compliant)
    }
}

impl Splitting for Network {
    /// All forces but gravity and drag, which are in the drift, unless there are constraints.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(&self.at(t, x, v), f, &self.finish(Terms::KickForces));
        self.hold_particles(t, [x, v], f);
    }

    fn kick_reads_velocity(&self) -> bool {
        let reads = |e: &Element| e.force().carried().is_none() && e.force().reads_velocity();
        self.is_constrained() || self.elements.iter().any(reads)
    }

    /// x' = v, v' = g - (c/m) v, exactly; with constraints v stays.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let all = 0..self.particles();
        self.flow(Terms::KickForces, h, all, columns_mut(x), columns_mut(v));
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
        for element in &self.elements {
            let at = self.at(t, x, v);
            element.force().add_differential(&at, [dx, dv], df);
        }
    }

    fn couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for element in &self.elements {
            element.force().couplings(t, x, clamped, visit);
        }
    }

    fn multiply(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
        self.multiply_fast(matrix, p, out)
    }

    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        self.add_fast_diagonal(matrix, diagonal)
    }

    fn other_couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        self.slow_couplings(t, x, clamped, visit);
    }

    fn lists_all_couplings(&self) -> bool {
        self.fluid().is_none()
    }

    fn reach(&self) -> f64 {
        self.reach_of_contact()
    }

    fn speed(&self) -> f64 {
        self.speed_of_forces()
    }

    fn gathering(&self) -> f64 {
        self.price_of_gathering()
    }

    fn drag_coefficient(&self) -> f64 {
        self.carried().drag
    }

    fn baumgarte_frequency(&self) -> Option<f64> {
        self.is_constrained()
            .then(|| self.constraints.baumgarte_frequency())
    }
}

impl Rows for Network {
    fn patches(&self) -> usize {
        self.sheets().count()
    }

    fn patch(&self, patch: usize) -> Patch {
        let of = |sheet: &Sheet| Patch {
            first: sheet.particles().start,
            rows: sheet.grid().rows(),
            cols: sheet.grid().cols(),
        };
        self.patch_sheet(patch).map_or_else(Patch::default, of)
    }

    fn kept_columns(&self) -> usize {
        SPRING_FORCES
    }

    fn shared_numbers(&self) -> usize {
        LAWS
    }

    fn begin(&self, patch: usize, scratch: &mut SweepScratch) {
        if let Some(sheet) = self.patch_sheet(patch) {
            begin(sheet, scratch);
        }
    }

    fn drift(
        &self,
        patch: usize,
        terms: Terms,
        (t, h): (f64, f64),
        row: usize,
        registers: &mut Registers,
    ) {
        let particles = self.patch(patch).row(row);
        let [x, y, z, u, v, w] = registers.stage_mut(row);
        self.flow(terms, h, particles.clone(), [x, y, z], [u, v, w]);
        self.place_row(t + h, particles, row, registers);
    }

    fn advance(
        &self,
        patch: usize,
        number: usize,
        stage: &Stage,
        rows: Range<usize>,
        registers: &mut Registers,
        scratch: &mut SweepScratch,
    ) {
        let Some(sheet) = self.patch_sheet(patch) else {
            return;
        };
        let place = self.patch(patch);
        let finish = Finish {
            inverse_masses: Some(&self.inverse_masses),
            ..self.finish(stage.terms)
        };
        let flow = self.uniform_inverse_mass.filter(|_| stage.drift != 0.0);
        let flow = flow.map(|w| {
            let Carried { drag, gravity } = self.drifting(stage.terms);
            Flow::new(drag, gravity, w, stage.drift)
        });
        let added = self.by_particle().next().is_some();
        for row in rows {
            if added {
                let [x, y, z, ..] = registers.stage(row);
                let mut addends = scratch.addends_mut();
                for addends in &mut addends {
                    addends.fill(0.0);
                }
                self.by_particle()
                    .for_each(|force| force.add(stage.t, [x, y, z], &mut addends));
            }
            Advance {
                sheet,
                added,
                finish: &finish,
                flow,
                number,
                stage,
                row,
                registers,
                scratch,
            }
            .run();
            if stage.drift == 0.0 || flow.is_some() {
                self.place_row(stage.until, place.row(row), row, registers);
            } else {
                let times = (stage.t, stage.drift);
                Rows::drift(self, patch, stage.terms, times, row, registers);
            }
        }
    }
}
