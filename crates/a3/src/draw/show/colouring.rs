//! Colours by a quantity, and the scale of what is drawn to scale.

use a3_core::Simulation;
use a3_render::ramp;

use super::quantity::{Quantity, lengths};
use crate::base::rounding::{MANY, round_up};

/// What is not larger is the rounding of nothing.
const NOTHING: f64 = 1e-9;

/// The end of a scale shrinks where all that it measures is less than this share of it.
const SHRINKS: f64 = 0.2;

/// Powers of ten on a logarithmic scale.
pub const DECADES: i32 = 5;

/// A scale from 0 to a round number, or a logarithmic one of [`DECADES`] to a power of ten: that
/// of the largest value lately, or a fixed one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scale {
    /// The end that was chosen, if one was.
    pub fixed: Option<f64>,
    /// The end that fits what was measured last; 0 if that was nothing.
    pub fitting: f64,
    /// Whether it is logarithmic.
    pub logarithmic: bool,
}

impl Scale {
    /// Follows the largest value. Little changes do not move the end.
    pub fn follow(&mut self, largest: f64) {
        let fits = largest <= self.fitting && largest >= SHRINKS * self.fitting;
        if !fits && largest.is_finite() {
            let rounds = if self.logarithmic { &[1.0, 10.0] } else { MANY };
            // A logarithmic scale says how small an error is, in scenes of any size.
            let nothing = if self.logarithmic { 0.0 } else { NOTHING };
            self.fitting = if largest > nothing {
                round_up(largest, rounds)
            } else {
                0.0
            };
        }
    }

    /// Its end.
    pub fn end(&self) -> f64 {
        self.fixed.unwrap_or(self.fitting)
    }

    /// The share of the scale at which a value is, from 0 to 1.
    pub fn share(&self, value: f64) -> f32 {
        if value > 0.0 && value < self.end() && self.logarithmic {
            let below = (value / self.end()).log10() / f64::from(DECADES);
            (1.0 + below).max(0.0) as f32
        } else if value > 0.0 && value < self.end() {
            (value / self.end()) as f32
        } else {
            let least = if self.end() > 0.0 { 0.0 } else { NOTHING };
            f32::from(value.is_nan() || value > least)
        }
    }
}

/// The colours of particles by a quantity.
#[derive(Clone, Debug, Default)]
pub struct Colouring {
    /// The quantity, if they are coloured by one.
    pub quantity: Option<Quantity>,
    /// Its scale.
    pub scale: Scale,
    /// The ways to the particles from where a reference has them (m), n x 3, if there is one.
    pub errors: Vec<f64>,
    /// The largest error of this and other runs, with which it shares a scale (m).
    pub beside: f64,
    /// Value of each particle, NaN where it has none; empty where the run has none.
    values: Vec<f64>,
    /// The vectors of which these are the lengths, n x 3, if they are.
    vectors: Vec<f64>,
}

impl Colouring {
    /// Colours by another quantity, or by none.
    pub fn set_quantity(&mut self, quantity: Option<Quantity>) {
        self.quantity = quantity;
        self.forget();
    }

    /// Forgets the scale, as for another scene.
    pub fn forget(&mut self) {
        self.scale = Scale {
            logarithmic: self.quantity == Some(Quantity::Error),
            ..Scale::default()
        };
    }

    /// The largest distance of a particle from where a reference has it (m); 0 without one.
    pub fn largest_error(&self) -> f64 {
        lengths(&self.errors).into_iter().fold(0.0, f64::max)
    }

    /// Takes the values of a run.
    pub fn update(&mut self, simulation: &Simulation) {
        self.values = self
            .quantity
            .map(|quantity| quantity.values(simulation, &self.errors))
            .unwrap_or_default();
        self.vectors = self
            .quantity
            .map(|quantity| quantity.vectors(simulation, &self.errors))
            .unwrap_or_default();
        let least = match self.quantity {
            Some(Quantity::Error) => self.beside,
            _ => 0.0,
        };
        let largest = self.values.iter().copied().fold(least, f64::max);
        self.scale.follow(largest);
    }

    /// The quantity by which anything is coloured now.
    pub fn shown(&self) -> Option<Quantity> {
        self.quantity.filter(|_| !self.values.is_empty())
    }

    /// Colours the points of the particles by their values.
    pub fn paint(&self, points: &mut [[f32; 4]]) {
        for (i, point) in points.iter_mut().enumerate() {
            if let Some(share) = self.share(i) {
                point[3] = a3_render::shaded_by(share);
            }
        }
    }

    /// The share of the scale at which the value of a particle is, if it has one.
    pub fn share(&self, i: usize) -> Option<f32> {
        let value = self.values.get(i).filter(|value| !value.is_nan())?;
        Some(self.scale.share(*value))
    }

    /// A vector of a particle whose length is that share; where the quantity is the length of a
    /// vector, along it, so that such vectors of a rigid body tell all between its points.
    pub fn vector(&self, i: usize) -> Option<[f32; 3]> {
        let (share, n) = (self.share(i)?, self.vectors.len() / 3);
        let end = self.scale.end();
        Some(if i < n && end > 0.0 {
            let vector = [0, 1, 2].map(|axis| self.vectors[axis * n + i]);
            let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
            let unit = f64::from(share) / length.max(f64::MIN_POSITIVE);
            vector.map(|part| (part * unit) as f32)
        } else {
            [share, 0.0, 0.0]
        })
    }

    /// The colour of a particle, or that which it has otherwise.
    pub fn of(&self, i: usize, otherwise: [f32; 4]) -> [f32; 4] {
        self.share(i).map_or(otherwise, ramp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_follows_what_is_measured_unless_it_is_fixed() {
        let mut scale = Scale::default();
        assert_eq!(
            (scale.end(), scale.share(0.0), scale.share(1.0)),
            (0.0, 0.0, 1.0)
        );
        scale.follow(1e-12);
        assert_eq!(scale.share(1e-12), 0.0, "the rounding of nothing");
        for (largest, end) in [(1.3, 1.5), (1.4, 1.5), (0.4, 1.5), (0.29, 0.3), (8.5, 10.0)] {
            scale.follow(largest);
            assert_eq!(scale.end(), end, "{largest}");
        }
        scale.follow(f64::NAN);
        scale.follow(f64::INFINITY);
        assert_eq!(scale.end(), 10.0);
        assert_eq!(
            [0.0, 5.0, 10.0, 99.0, f64::NAN].map(|v| scale.share(v)),
            [0.0, 0.5, 1.0, 1.0, 1.0]
        );
        scale.fixed = Some(4.0);
        assert_eq!((scale.end(), scale.share(1.0)), (4.0, 0.25));
        scale.follow(0.0);
        assert_eq!((scale.end(), scale.fitting), (4.0, 0.0));
    }
}
