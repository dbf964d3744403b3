//! Stiffness and damping over mass, as operators on the shapes of modes.

use super::mode::Mode;
use crate::random::SplitMix;
use crate::system::{Linearized, kick_reads_velocity};

/// Length of the part of a shape's damping in other shapes, over that in its own, from which
/// damping is said to mix shapes; and over the frequency, from which it changes the frequency by
/// about a percent.
pub(super) const MIXED: f64 = 0.02;
const STRONG: f64 = 0.1;

/// How much damping turns a shape of the undamped motion into others.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Mixing {
    /// Each has its own damping.
    #[default]
    None,
    /// Its damping is not that of the shape alone.
    Weak,
    /// Its frequency is not, either.
    Strong,
}

/// Mass-normalised stiffness M^-1/2 K M^-1/2 and damping M^-1/2 D M^-1/2 at the positions x, as
/// operators. The modes are those at zero velocity.
pub(super) struct Normalised<'a> {
    mechanics: &'a dyn Linearized,
    t: f64,
    x: &'a [f64],
    zero: Vec<f64>,
    scaled: Vec<f64>,
}

impl<'a> Normalised<'a> {
    pub fn new(mechanics: &'a dyn Linearized, t: f64, x: &'a [f64]) -> Self {
        Self {
            mechanics,
            t,
            x,
            zero: vec![0.0; x.len()],
            scaled: vec![0.0; x.len()],
        }
    }

    /// z = M^-1/2 z.
    fn scale(&self, z: &mut [f64]) {
        let w = self.mechanics.inverse_masses();
        for column in z.chunks_exact_mut(w.len()) {
            for (z, w) in column.iter_mut().zip(w) {
                *z *= w.sqrt();
            }
        }
    }

    /// out = K z, or D z if `damping` is set, both mass-normalised.
    pub fn product(&mut self, z: &[f64], damping: bool, out: &mut [f64]) {
        let mut scaled = std::mem::take(&mut self.scaled);
        scaled.copy_from_slice(z);
        self.scale(&mut scaled);
        let (dx, dv) = if damping {
            (&self.zero, &scaled)
        } else {
            (&scaled, &self.zero)
        };
        self.mechanics
            .force_differential(self.t, self.x, &self.zero, dx, dv, out);
        self.scaled = scaled;
        self.scale(out);
        for out in out {
            *out = -*out;
        }
    }

    /// Drag over mass of the mode with the shape z (1/s).
    fn drag(&self, z: &[f64]) -> f64 {
        let w = self.mechanics.inverse_masses();
        let share = z
            .chunks_exact(w.len())
            .flat_map(|z| z.iter().zip(w).map(|(z, w)| z * z * w))
            .sum::<f64>();
        self.mechanics.drag_coefficient() * share
    }

    /// Mode with the shape z and this stiffness over mass (1/s2), and how much damping turns z into
    /// other shapes.
    pub fn mode(&mut self, stiffness: f64, z: &[f64], scratch: &mut [f64]) -> (Mode, Mixing) {
        self.product(z, true, scratch);
        let drag = self.drag(z);
        let all = dot(z, scratch);
        let turned = (dot(scratch, scratch) - all * all).max(0.0).sqrt();
        // Without damped springs both terms are equal up to rounding.
        let damping = all - drag;
        let mode = Mode {
            stiffness,
            drag,
            damping: if damping > 1e-9 * drag { damping } else { 0.0 },
            reads_velocity: kick_reads_velocity(self.mechanics),
        };
        let mixing = if turned > STRONG * stiffness.abs().sqrt() && turned > MIXED * all.abs() {
            Mixing::Strong
        } else if turned > MIXED * all.abs() {
            Mixing::Weak
        } else {
            Mixing::None
        };
        (mode, mixing)
    }

    /// Random shape of length 1, which contains a share of every mode.
    pub fn any_shape(&self) -> Vec<f64> {
        let mut random = SplitMix(1);
        let free = self.mechanics.inverse_masses();
        let mut z: Vec<_> = (0..self.x.len())
            .map(|k| {
                let z = random.between(-1.0, 1.0);
                if free[k % free.len()] == 0.0 { 0.0 } else { z }
            })
            .collect();
        normalise(&mut z);
        z
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Scales z to length 1 and returns its former length.
pub(super) fn normalise(z: &mut [f64]) -> f64 {
    let length = dot(z, z).sqrt();
    if length > 0.0 {
        for z in z {
            *z /= length;
        }
    }
    length
}
