//! A network as integrators see it: forces, accelerations, kicks and drifts, at once or row by row.

use std::ops::Range;

use nalgebra::Vector3;

use super::Network;
use crate::elements::Sheet;
use crate::elements::buckling;
use crate::elements::flow::{self, Flow};
use crate::elements::sheet::kernel::{self as sheet, Of};
use crate::elements::{columns_mut, drag, ending::Ending, springs};
use crate::path::Place;
use crate::rows::{Part, Registers, Rows, Stage, Sweep};
use crate::system::{Coupling, Matrix, Mechanics, place_pins};

impl Network {
    /// What the ending makes of the springs' forces.
    pub(super) fn evaluate(&self, x: &[f64], v: &[f64], f: &mut [f64], ending: &Ending) {
        if let Some(sheet) = self.only_sheet().filter(|_| ending.air.is_none()) {
            sheet::set(Of::Forces, sheet, x, v, f, ending);
            return;
        }
        let n = self.particles();
        match &self.sheet {
            Some(sheet) => {
                for column in f.chunks_exact_mut(n) {
                    column[sheet.grid().particles()..].fill(0.0);
                }
                sheet::set(Of::Forces, sheet, x, v, f, &Ending::default());
            }
            None => f.fill(0.0),
        }
        springs::add_list(&self.list, x, v, f);
        springs::add_list(&self.strips, x, v, f);
        ending.apply(x, v, f);
    }

    /// The sheet, if it is all that holds the particles together.
    fn only_sheet(&self) -> Option<&Sheet> {
        self.sheet
            .as_ref()
            .filter(|sheet| sheet.grid().particles() == self.particles())
            .filter(|_| self.list.is_empty() && self.strips.is_empty())
    }

    /// The drag and the gravity that a drift carries: with constraints none, which hold against all forces together.
    fn drifting(&self, part: Part) -> (f64, Vector3<f64>) {
        match part {
            Part::Kick if !self.is_constrained() => (
                self.drag.unwrap_or_default(),
                self.gravity.unwrap_or_default(),
            ),
            _ => (0.0, Vector3::zeros()),
        }
    }

    /// Moves particles by what a drift carries. Where pins go is set right afterwards.
    fn flow(
        &self,
        part: Part,
        h: f64,
        particles: Range<usize>,
        x: [&mut [f64]; 3],
        v: [&mut [f64]; 3],
    ) {
        let (c, g) = self.drifting(part);
        match self.same {
            Some(w) => Flow::new(c, g, w, h).apply(x, v),
            None => flow::apply(c, g, &self.inverse_masses[particles], h, x, v),
        }
    }

    /// Pins of a row are where they are, whatever moved them in between.
    fn place_row(&self, t: f64, row: usize, registers: &mut Registers) {
        let cols = Rows::cols(self);
        for pin in self.pins_of(row * cols..(row + 1) * cols) {
            let place = pin.path.at(t);
            for axis in 0..3 {
                let i = pin.particle - row * cols;
                registers.stage.column_mut(row, axis)[i] = place.position[axis];
                registers.stage.column_mut(row, 3 + axis)[i] = place.velocity[axis];
            }
        }
    }

    /// What is added to the springs' forces at time t: of all forces, or of those that kick.
    fn others(&self, part: Part, t: f64) -> Ending<'_> {
        let all = part != Part::Kick || self.is_constrained();
        Ending {
            wind: self.push().map(|wind| (wind, t)),
            air: self.air(t),
            gravity: self.gravity.filter(|_| all).map(|g| (g, &*self.masses)),
            drag: self.drag.filter(|_| all),
            inertia: None,
            inverse_masses: None,
        }
    }
}

impl Mechanics for Network {
    fn inverse_masses(&self) -> &[f64] {
        &self.inverse_masses
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(x, v, f, &self.others(Part::All, t));
        self.hold(t, x, v, f);
    }

    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        if self.is_constrained() {
            self.forces(t, x, v, a);
            self.divide_by_masses(a);
            return;
        }
        let ending = Ending {
            inverse_masses: Some(&self.inverse_masses),
            ..self.others(Part::All, t)
        };
        self.evaluate(x, v, a, &ending);
    }

    fn rows(&self) -> Option<&dyn Rows> {
        // Triangles reach into rows above, which a sweep has left behind; constraints reach anywhere.
        let sweeps =
            self.only_sheet().is_some() && self.air(0.0).is_none() && !self.is_constrained();
        sweeps.then_some(self as &dyn Rows)
    }

    fn feedback(&self) -> Option<f64> {
        self.is_constrained().then(|| self.constraints.feedback())
    }

    fn force_differential(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        // How the turning of damped springs changes their forces, vectors do not know.
        let turns = self.springs_damped() && v.iter().any(|v| *v != 0.0);
        if let Some(sheet) = self.only_sheet().filter(|_| !turns) {
            let of = |stiffness, damping, p: &[f64], out: &mut [f64]| {
                let (of, sheet) = (
                    Of::Tangent { clamped: false },
                    sheet.scaled(stiffness, damping),
                );
                sheet::set(of, &sheet, x, p, out, &Ending::default());
            };
            of(1.0, 0.0, dx, df);
            if sheet.is_damped() && dv.iter().any(|dv| *dv != 0.0) {
                let mut damping = vec![0.0; df.len()];
                of(0.0, 1.0, dv, &mut damping);
                df.iter_mut()
                    .zip(damping)
                    .for_each(|(df, more)| *df += more);
            }
        } else {
            df.fill(0.0);
            self.couplings(x, &mut |coupling| {
                springs::add_differential(&coupling, x, v, dx, dv, df);
            });
        }
        if let Some(c) = self.drag {
            drag::add(c, dv, df);
        }
        if let Some(wind) = self.push() {
            wind.add_differential(t, x, dx, df);
        }
        if let Some(air) = self.air(t) {
            air.add_differential(x, v, dx, dv, df);
        }
    }

    fn couplings(&self, x: &[f64], visit: &mut dyn FnMut(Coupling)) {
        self.springs()
            .for_each(|spring| visit(springs::coupling(&spring, x)));
        self.strips
            .iter()
            .for_each(|strip| visit(springs::coupling(strip, x)));
    }

    fn multiply(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> bool {
        let Some(sheet) = self.only_sheet() else {
            return false;
        };
        let (of, a) = (
            Of::Tangent {
                clamped: matrix.clamped,
            },
            matrix.a,
        );
        let ending = Ending {
            inertia: Some(matrix.masses),
            inverse_masses: Some(matrix.free),
            ..Ending::default()
        };
        sheet::set(of, &sheet.scaled(a * a, a), matrix.x, p, out, &ending);
        true
    }

    fn speed(&self) -> f64 {
        let sheet = self.sheet.iter().flat_map(Sheet::springs).count() as f64;
        let (list, strips) = (self.list.len() as f64, self.strips.len() as f64);
        let all = sheet + list + strips;
        if all > 0.0 {
            all / (sheet / sheet::SPEED + list + strips * buckling::PRICE)
        } else {
            1.0
        }
    }

    fn drag_coefficient(&self) -> f64 {
        self.drag.unwrap_or(0.0)
    }

    fn pins(&self, t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for pin in &self.pins {
            visit(pin.particle, pin.path.at(t));
        }
    }

    /// Springs and wind. Gravity and drag are in the drift, unless there are constraints.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(x, v, f, &self.others(Part::Kick, t));
        self.hold(t, x, v, f);
    }

    fn kick_reads_velocity(&self) -> bool {
        self.air(0.0).is_some() || self.springs_damped() || self.is_constrained()
    }

    /// x' = v, v' = g - (c/m) v, exactly; with constraints v stays.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let all = 0..self.particles();
        self.flow(Part::Kick, h, all, columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Rows for Network {
    fn rows(&self) -> usize {
        self.sheet.map_or(0, |sheet| sheet.grid().rows())
    }

    fn cols(&self) -> usize {
        self.sheet.map_or(0, |sheet| sheet.grid().cols())
    }

    fn begin(&self, sweep: &mut Sweep) {
        if let Some(sheet) = &self.sheet {
            sheet::begin(sheet, sweep.laws.column_mut(0, 0));
        }
        sweep.found.clear();
    }

    fn drift(&self, part: Part, t: f64, h: f64, row: usize, registers: &mut Registers) {
        let cols = Rows::cols(self);
        let [x, y, z, u, v, w] = registers.stage.columns_mut(row);
        let particles = row * cols..(row + 1) * cols;
        self.flow(part, h, particles, [x, y, z], [u, v, w]);
        self.place_row(t + h, row, registers);
    }

    fn advance(
        &self,
        number: usize,
        stage: &Stage,
        rows: Range<usize>,
        registers: &mut Registers,
        sweep: &mut Sweep,
    ) {
        let Some(sheet) = &self.sheet else { return };
        let ending = Ending {
            inverse_masses: Some(&self.inverse_masses),
            ..self.others(stage.part, stage.t)
        };
        let flow = self.same.filter(|_| stage.drift != 0.0).map(|w| {
            let (c, g) = self.drifting(stage.part);
            Flow::new(c, g, w, stage.drift)
        });
        for row in rows {
            sheet::Advance {
                sheet,
                ending: &ending,
                flow,
                number,
                stage,
                row,
                registers,
                sweep,
            }
            .run();
            if stage.drift == 0.0 || flow.is_some() {
                self.place_row(stage.until, row, registers);
            } else {
                Rows::drift(self, stage.part, stage.t, stage.drift, row, registers);
            }
        }
    }
}
