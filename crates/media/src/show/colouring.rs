//! Colours by a quantity, and their scale.

use a3_core::Simulation;
use a3_files::rounding::{MANY, round_up};
use a3_render::ramp;

use super::quantity::{Quantity, lengths};

/// Largest value that counts as 0, because it is rounding error.
const MAX_ROUNDING_ERROR: f64 = 1e-9;

/// Share of a scale below which the largest value makes the scale shrink.
const MIN_USED_SHARE: f64 = 0.2;

/// Number of powers of ten on a logarithmic scale.
pub const DECADES: i32 = 5;

/// A scale from 0 to a round number, or a logarithmic one of [`DECADES`] powers of ten up to a
/// power of ten. Its end follows the recent largest value, or is fixed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scale {
    /// The fixed end, if there is one.
    pub fixed: Option<f64>,
    /// The end that fits the recent largest values; 0 if there were none.
    pub fitting: f64,
    /// Whether the scale is logarithmic.
    pub logarithmic: bool,
}

impl Scale {
    /// Follows the largest value. Small changes do not move the end.
    pub fn follow(&mut self, largest: f64) {
        let fits = largest <= self.fitting && largest >= MIN_USED_SHARE * self.fitting;
        if !fits && largest.is_finite() {
            let rounds = if self.logarithmic { &[1.0, 10.0] } else { MANY };
            // A logarithmic scale shows errors of any size.
            let nothing = if self.logarithmic { 0.0 } else { MAX_ROUNDING_ERROR };
            self.fitting = if largest > nothing { round_up(largest, rounds) } else { 0.0 };
        }
    }

    /// Returns the end of the scale.
    pub fn end(&self) -> f64 {
        self.fixed.unwrap_or(self.fitting)
    }

    /// Returns the place of a value on the scale, from 0 to 1.
    pub fn share(&self, value: f64) -> f32 {
        if value > 0.0 && value < self.end() && self.logarithmic {
            let below = (value / self.end()).log10() / f64::from(DECADES);
            (1.0 + below).max(0.0) as f32
        } else if value > 0.0 && value < self.end() {
            (value / self.end()) as f32
        } else {
            let least = if self.end() > 0.0 { 0.0 } else { MAX_ROUNDING_ERROR };
            f32::from(value.is_nan() || value > least)
        }
    }
}

/// The colours of particles by a quantity.
#[derive(Clone, Debug, Default)]
pub struct Colouring {
    /// The quantity, if particles are coloured by one.
    pub quantity: Option<Quantity>,
    /// Scale of the quantity.
    pub scale: Scale,
    /// Vectors from the particles of the reference to those of the run (m), n x 3; empty without a
    /// reference.
    pub errors: Vec<f64>,
    /// Largest error of this run and of the other runs that share its scale (m).
    pub beside: f64,
    /// Value of each particle, NaN where it has none; empty where the run has none.
    values: Vec<f64>,
    /// Vectors whose lengths are the values, n x 3; empty if the values are no lengths.
    vectors: Vec<f64>,
}

impl Colouring {
    /// Sets the quantity, or none.
    pub fn set_quantity(&mut self, quantity: Option<Quantity>) {
        self.quantity = quantity;
        self.forget();
    }

    /// Resets the scale, for another scene.
    pub fn forget(&mut self) {
        self.scale =
            Scale { logarithmic: self.quantity == Some(Quantity::Error), ..Scale::default() };
    }

    /// Returns the largest distance of a particle from its place in the reference (m); 0 without a
    /// reference.
    pub fn largest_error(&self) -> f64 {
        lengths(&self.errors).into_iter().fold(0.0, f64::max)
    }

    /// Updates the values with those of a run.
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

    /// Returns the quantity that colours anything now, if there is one.
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

    /// Returns the place of a particle's value on the scale, from 0 to 1, if it has one.
    pub fn share(&self, i: usize) -> Option<f32> {
        let value = self.values.get(i).filter(|value| !value.is_nan())?;
        Some(self.scale.share(*value))
    }

    /// Returns a vector of a particle whose length is the place of its value on the scale. If the
    /// quantity is the length of a vector, the result is parallel to that vector, so that it can be
    /// interpolated between the points of a rigid body.
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

    /// Returns the colour of a particle by its value, or `otherwise` if it has none.
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
        assert_eq!((scale.end(), scale.share(0.0), scale.share(1.0)), (0.0, 0.0, 1.0));
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
