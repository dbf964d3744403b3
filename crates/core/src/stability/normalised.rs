//! Stiffness and damping over mass, as operators on the shapes of modes.

use super::mode::Mode;
use crate::random::SplitMix;
use crate::system::{Linearized, kick_reads_velocity};

/// Part of a shape's damping that acts on other shapes, over the part that acts on its own, from
/// which on damping counts as mixing shapes.
pub(super) const MIN_MIXING: f64 = 0.02;
/// The same part, over the frequency, from which on damping counts as mixing shapes strongly: it
/// changes the frequency by about a percent.
const MIN_STRONG_MIXING: f64 = 0.1;

/// Degree to which damping couples a shape of the undamped motion to others.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Mixing {
    /// Each shape has its own damping.
    #[default]
    None,
    /// The damping of a shape depends on others.
    Weak,
    /// The frequency depends on others, too.
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

    /// Replaces z by M^-1/2 z.
    fn scale(&self, z: &mut [f64]) {
        let w = self.mechanics.inverse_masses();
        for column in z.chunks_exact_mut(w.len()) {
            for (z, w) in column.iter_mut().zip(w) {
                *z *= w.sqrt();
            }
        }
    }

    /// Computes out = K z, or D z if `damping` is set, both mass-normalised.
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

    /// Returns the drag over mass of the mode of shape z (1/s).
    fn drag(&self, z: &[f64]) -> f64 {
        let w = self.mechanics.inverse_masses();
        let share = z
            .chunks_exact(w.len())
            .flat_map(|z| z.iter().zip(w).map(|(z, w)| z * z * w))
            .sum::<f64>();
        self.mechanics.drag_coefficient() * share
    }

    /// Returns the mode of shape z and of this stiffness over mass (1/s2), and the degree to which
    /// damping couples z to other shapes.
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
        let mixing = if turned > MIN_STRONG_MIXING * stiffness.abs().sqrt()
            && turned > MIN_MIXING * all.abs()
        {
            Mixing::Strong
        } else if turned > MIN_MIXING * all.abs() {
            Mixing::Weak
        } else {
            Mixing::None
        };
        (mode, mixing)
    }

    /// Returns a random shape of length 1, which has a component along every mode.
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
