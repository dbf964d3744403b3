//! Lattices on which the particles of fluids and tanks begin.

use std::ops::Range;

use a3_core::Vector3;

use crate::check::{at, positive};
use crate::description::Fluid;
use crate::fault::Fault;

/// Number of layers of particles in a wall: with three, the fluid particles next to a wall have all
/// their neighbours.
pub const LAYERS: u32 = 3;

/// Lattice of the particles of a fluid, a tank or a column that flows in.
pub(super) struct Places {
    /// Number of lattice points along each axis.
    counts: [i64; 3],
    /// Corner of the lattice (m).
    corner: Vector3<f64>,
    spacing: f64,
    flat: bool,
}

impl Places {
    /// Creates the lattice that fills a box.
    pub fn new(fluid: &Fluid, size: [f64; 3], center: [f64; 3]) -> Result<Self, Fault> {
        let flat = fluid.dimensions == 2;
        let mut counts = [1; 3];
        for (axis, (count, size)) in counts.iter_mut().zip(size).enumerate() {
            if flat && axis == 2 {
                if size != 0.0 {
                    let why = format!("in two dimensions, its last number is 0, not {size}");
                    return Err(Fault::new("size", why));
                }
                continue;
            }
            at("size", positive("each edge", size))?;
            let whole = (size / fluid.spacing).round();
            if whole < 1.0 || (whole * fluid.spacing - size).abs() > 1e-6 * size {
                let why = format!(
                    "each edge must be a whole multiple of the spacing {}, not {size}",
                    fluid.spacing
                );
                return Err(Fault::new("size", why));
            }
            *count = whole as i64;
        }
        Ok(Self {
            counts,
            corner: Vector3::from(center) - 0.5 * Vector3::from(size),
            spacing: fluid.spacing,
            flat,
        })
    }

    /// Counts the points of the lattice with `layers` more around its sides and its bottom.
    pub fn count(&self, layers: i64) -> usize {
        let ends = (0..3).map(|axis| self.range(axis, layers));
        ends.fold(1, |all, range| {
            all.saturating_mul((range.end - range.start) as usize)
        })
    }

    /// Returns the indices along an axis, with `layers` more outside.
    fn range(&self, axis: usize, layers: i64) -> Range<i64> {
        let n = self.counts[axis];
        match axis {
            2 if self.flat => 0..1,
            1 => -layers..n,
            _ => -layers..n.saturating_add(layers),
        }
    }

    /// Lists the points of the lattice with `layers` more around its sides and its bottom, x
    /// fastest, and tells whether each is inside.
    pub fn all(&self, layers: i64) -> impl Iterator<Item = (Vector3<f64>, bool)> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.range(axis, layers));
        let places = z.flat_map(move |k| {
            let x = x.clone();
            y.clone()
                .flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        });
        places.map(move |place| {
            let inside = (0..3).all(|axis| (0..self.counts[axis]).contains(&place[axis]));
            let depth = if self.flat { -0.5 } else { 0.0 };
            let [i, j, k] = place.map(|k| k as f64 + 0.5);
            let offset = Vector3::new(i, j, k + depth);
            (self.corner + self.spacing * offset, inside)
        })
    }
}
