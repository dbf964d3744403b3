//! A row of J, with its elements of the vectors in a solution.

use nalgebra::Vector3;

/// A row of J, scaled so that the diagonal of J W J^T is 1.
#[derive(Debug, Default)]
pub(super) struct Row {
    /// Places of the particles and rotations that it moves, and its parts there.
    parts: [(usize, Vector3<f64>); 4],
    used: usize,
    scale: f64,
    /// Its element of J W J^T lambda in the solution.
    pub target: f64,
    /// Multiplier lambda.
    pub multiplier: f64,
    /// Residual r = b - A lambda.
    pub residual: f64,
    /// Direction p, and its image A p.
    pub direction: f64,
    pub image: f64,
}

impl Row {
    /// Adds a part at a place; place 0 moves nothing.
    pub fn add(&mut self, place: usize, part: Vector3<f64>) {
        if place == 0 {
            return;
        }
        let (parts, rest) = self.parts.split_at_mut(self.used);
        // Both ends of a rod may be on one body.
        if let Some((_, own)) = parts.iter_mut().find(|(own, _)| *own == place) {
            *own += part;
        } else {
            rest[0] = (place, part);
            self.used += 1;
        }
    }

    /// Returns its parts, with their places.
    fn parts(&self) -> &[(usize, Vector3<f64>)] {
        &self.parts[..self.used]
    }

    /// Returns its product with a vector.
    pub fn product(&self, vectors: &[Vector3<f64>]) -> f64 {
        let terms = self.parts().iter().map(|(i, part)| part.dot(&vectors[*i]));
        terms.sum()
    }

    /// Adds its transpose times a number to a vector.
    pub fn spread(&self, number: f64, out: &mut [Vector3<f64>]) {
        for (i, part) in self.parts() {
            out[*i] += part * number;
        }
    }

    /// Returns the element J W J^T of this row and another.
    pub fn element(&self, other: &Self, weights: &[Vector3<f64>]) -> f64 {
        let mut sum = 0.0;
        for (i, part) in self.parts() {
            for (j, others) in other.parts() {
                if i == j {
                    sum += part.dot(&weights[*i].component_mul(others));
                }
            }
        }
        sum
    }

    /// Sets the right-hand side of the row, and scales the row. If all that it moves has infinite
    /// mass, no force can have the effect, and the row is left out.
    pub fn set_target(&mut self, target: f64, weights: &[Vector3<f64>]) {
        let diagonal = self.element(self, weights);
        self.scale = if diagonal > 0.0 {
            1.0 / diagonal.sqrt()
        } else {
            0.0
        };
        for (_, part) in &mut self.parts[..self.used] {
            *part *= self.scale;
        }
        self.target = target * self.scale;
    }

    /// Returns whether the row is left out, because no force has an effect.
    pub fn is_left_out(&self) -> bool {
        self.scale == 0.0
    }

    /// Returns the multiplier of the row as it was before it was scaled.
    pub fn unscaled(&self) -> f64 {
        self.scale * self.multiplier
    }

    /// Returns the product J^T lambda at a place.
    pub fn at(&self, place: usize) -> Vector3<f64> {
        let own = self.parts().iter().filter(|(own, _)| *own == place);
        own.map(|(_, part)| part * self.multiplier).sum()
    }

    /// Returns the force J^T lambda on its first particle (N).
    pub fn force(&self) -> Vector3<f64> {
        self.parts[0].1 * self.multiplier
    }
}
