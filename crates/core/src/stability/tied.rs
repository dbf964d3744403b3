//! Mode as a system that any method can step.

use nalgebra::Vector3;

use super::mode::Mode;
use crate::columns::columns_mut;
use crate::coupling::{AxialCoupling, Coupling};
use crate::elements::Flow;
use crate::path::Place;
use crate::spring::SpringLaw;
use crate::system::{Compliant, Linearized, Mechanics, Splitting, place_pins};

/// Mode as a mechanical system along one axis: particles 0 and 1, of unit mass, are each tied to
/// particle 2, which is pinned at the origin.
pub(super) struct Tied(pub Mode);

impl Mechanics for Tied {
    fn inverse_masses(&self) -> &[f64] {
        &[1.0, 1.0, 0.0]
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.kick_forces(t, x, v, f);
        for (f, v) in f.iter_mut().zip(v) {
            *f -= self.0.drag * v;
        }
    }

    fn drag_coefficient(&self) -> f64 {
        self.0.drag
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        visit(2, Place::still(Vector3::zeros()));
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        Some(self)
    }

    fn compliant(&self) -> Option<&dyn Compliant> {
        Some(self)
    }
}

impl Compliant for Tied {
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        let law = SpringLaw {
            stiffness: self.0.stiffness,
            rest_length: 0.0,
            damping: self.0.damping,
        };
        visit([0, 2], law);
        visit([1, 2], law);
    }

    fn other_forces(&self, _t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
    }
}

impl Splitting for Tied {
    fn kick_forces(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for ((f, x), v) in f.iter_mut().zip(x).zip(v) {
            *f = -self.0.stiffness * x - self.0.damping * v;
        }
    }

    fn kick_reads_velocity(&self) -> bool {
        self.0.reads_velocity || self.0.damping != 0.0
    }

    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let flow = Flow::new(self.0.drag, Vector3::zeros(), 1.0, h);
        flow.apply(columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Linearized for Tied {
    fn force_differential(
        &self,
        t: f64,
        _x: &[f64],
        _v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        self.forces(t, dx, dv, df);
    }

    fn couplings(&self, _t: f64, _x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for i in 0..2 {
            visit(Coupling::Axial(AxialCoupling {
                i,
                j: 2,
                direction: [1.0, 0.0, 0.0],
                along: self.0.stiffness,
                across: self.0.stiffness,
                damping: self.0.damping,
            }));
        }
    }
}
