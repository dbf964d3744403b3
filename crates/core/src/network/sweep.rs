//! A network as sweeps see it, row by row of its sheets.

use std::ops::Range;

use super::evaluation::{drift_forces, finish, flow};
use super::parts::Network;
use crate::elements::force::DriftForces;
use crate::elements::sheet::{Advance, LAWS, SPRING_FORCES, begin};
use crate::elements::{Finish, Flow, Sheet};
use crate::rows::{Patch, Registers, Rows, Stage, SweepScratch, Terms};

/// Writes the positions and velocities of the pins of a row at time t (s).
fn place_row(
    network: &Network,
    t: f64,
    particles: Range<usize>,
    row: usize,
    registers: &mut Registers,
) {
    for pin in network.particles.pins_of(particles.clone()) {
        let place = pin.at(t);
        let columns = registers.stage_mut(row);
        for axis in 0..3 {
            let i = pin.particle - particles.start;
            columns[axis][i] = place.position[axis];
            columns[3 + axis][i] = place.velocity[axis];
        }
    }
}

/// Returns the sheet whose rows are this patch, if there is one.
fn patch_sheet(network: &Network, patch: usize) -> Option<&Sheet> {
    network.elements.sheets().nth(patch)
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
        patch_sheet(self, patch).map_or_else(Patch::default, of)
    }

    fn kept_columns(&self) -> usize {
        SPRING_FORCES
    }

    fn shared_numbers(&self) -> usize {
        LAWS
    }

    fn begin(&self, patch: usize, scratch: &mut SweepScratch) {
        if let Some(sheet) = patch_sheet(self, patch) {
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
        flow(self, terms, h, particles.clone(), [x, y, z], [u, v, w]);
        place_row(self, t + h, particles, row, registers);
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
        let Some(sheet) = patch_sheet(self, patch) else {
            return;
        };
        let place = self.patch(patch);
        let finish = Finish {
            inverse_masses: Some(self.particles.inverse_masses()),
            ..finish(self, stage.terms)
        };
        let flow = self
            .particles
            .uniform_inverse_mass()
            .filter(|_| stage.drift != 0.0);
        let flow = flow.map(|w| {
            let DriftForces { drag, gravity } = drift_forces(self, stage.terms);
            Flow::new(drag, gravity, w, stage.drift)
        });
        let added = self.elements.by_particle().next().is_some();
        for row in rows {
            if added {
                let [x, y, z, ..] = registers.stage(row);
                let mut addends = scratch.addends_mut();
                for addends in &mut addends {
                    addends.fill(0.0);
                }
                self.elements
                    .by_particle()
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
                place_row(self, stage.until, place.row(row), row, registers);
            } else {
                let times = (stage.t, stage.drift);
                Rows::drift(self, patch, stage.terms, times, row, registers);
            }
        }
    }
}
