//! Gas in a closed surface, at constant pressure or at constant temperature. With the volume V =
//! sum of a . (b x c) / 6 over the triangles (a, b, c), anticlockwise from outside, it pushes a
//! particle at x by p dV/dx, where p is the pressure above that outside (Pa). Its energy is -p V at
//! constant p. A fixed amount of ideal gas has p = P (w / V - 1) under the outer pressure P, where
//! w is the volume that it takes at P, and the energy P (V - w - w ln(V / w)).

use super::force::{At, Cost, Force, check_particle};
use crate::coupling::{Coupling, GeneralCoupling};
use crate::energy::Energy;
use crate::error::{Error, at_least};

/// Pressure of the atmosphere at sea level (Pa).
pub const ATMOSPHERE: f64 = 101_325.0;

/// Share of its volume at outer pressure below which an amount of gas is not compressed further: a
/// surface that is turned inside out has no positive volume.
const LEAST_VOLUME: f64 = 1e-3;

/// Law of the pressure in a closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GasLaw {
    /// Constant pressure above that outside (Pa).
    Pressure(f64),
    /// Amount of gas at constant temperature under the pressure of the [`ATMOSPHERE`], as the
    /// volume that it takes at that pressure (m3).
    Amount(f64),
}

/// Gas in a closed surface.
///
/// ```
/// use a3_core::elements::{ATMOSPHERE, Gas, GasLaw};
///
/// // A tetrahedron of 1/6 m3, with gas that takes twice as much in the open.
/// let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
/// let gas = Gas::new(GasLaw::Amount(2.0 / 6.0), triangles)?;
/// let x = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// assert!((gas.volume(&x) - 1.0 / 6.0).abs() < 1e-15);
/// let [above_outside, _] = gas.pressure(1.0 / 6.0);
/// assert!((above_outside / ATMOSPHERE - 1.0).abs() < 1e-12);
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gas {
    law: GasLaw,
    triangles: Vec<[u32; 3]>,
}

impl Gas {
    /// Creates the gas in the surface of these triangles, which are anticlockwise from outside.
    ///
    /// # Errors
    /// The surface is not closed: an edge is not the side of two triangles of the same orientation.
    /// Or the pressure is not finite, or the volume not a finite number above or equal to 0.
    pub fn new(law: GasLaw, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        match law {
            GasLaw::Pressure(p) if p.is_finite() => {}
            GasLaw::Pressure(p) => {
                return Err(Error::Invalid(format!(
                    "the pressure must be a finite number, not {p}"
                )));
            }
            GasLaw::Amount(volume) => at_least(0.0, "the amount of gas", volume)?,
        }
        let mut sides: Vec<_> = sides(&triangles).collect();
        sides.sort_unstable();
        let twice = sides.windows(2).find(|pair| pair[0] == pair[1]);
        let mut open = sides.iter();
        let open = open.find(|[i, j]| sides.binary_search(&[*j, *i]).is_err());
        match twice.map(|pair| &pair[0]).or(open) {
            None => Ok(Self { law, triangles }),
            Some([i, j]) => Err(Error::Invalid(format!(
                "a surface that holds gas must be closed, but particles {i} and {j} are not \
                 neighbours in two triangles of the same orientation"
            ))),
        }
    }

    /// Returns the law of the pressure.
    #[must_use]
    pub fn law(&self) -> GasLaw {
        self.law
    }

    /// Returns the enclosed volume (m3) at x (m), n x 3.
    #[must_use]
    pub fn volume(&self, x: &[f64]) -> f64 {
        let of_one = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(t, x);
            dot(a, cross(b, c)) / 6.0
        };
        self.triangles.iter().map(of_one).sum()
    }

    /// Returns the pressure above that outside (Pa), and its derivative by the volume (Pa/m3).
    #[must_use]
    pub fn pressure(&self, volume: f64) -> [f64; 2] {
        match self.law {
            GasLaw::Pressure(p) => [p, 0.0],
            GasLaw::Amount(own) if volume > LEAST_VOLUME * own => {
                let ratio = own / volume;
                [ATMOSPHERE * (ratio - 1.0), -ATMOSPHERE * ratio / volume]
            }
            GasLaw::Amount(_) => [ATMOSPHERE * (1.0 / LEAST_VOLUME - 1.0), 0.0],
        }
    }

    /// Returns the corners of a triangle at x, relative to the first particle of the surface.
    fn corners(&self, triangle: &[u32; 3], x: &[f64]) -> [[f64; 3]; 3] {
        let origin = row(x, self.triangles[0][0]);
        triangle.map(|i| {
            let x = row(x, i);
            std::array::from_fn(|axis| x[axis] - origin[axis])
        })
    }
}

impl Force for Gas {
    fn name(&self) -> &'static str {
        "gas pressure"
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        let mut all = self.triangles.iter().flatten();
        all.try_for_each(|i| check_particle(*i as usize, particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        let [p, _] = self.pressure(self.volume(at.x));
        for triangle in &self.triangles {
            let [a, b, c] = self.corners(triangle, at.x);
            for (i, push) in triangle.iter().zip([cross(b, c), cross(c, a), cross(a, b)]) {
                add(f, *i, push, p / 6.0);
            }
        }
    }

    fn add_differential(&self, at: &At, [dx, _]: [&[f64]; 2], df: &mut [f64]) {
        let [p, slope] = self.pressure(self.volume(at.x));
        let mut change = 0.0;
        for triangle in &self.triangles {
            let [a, b, c] = self.corners(triangle, at.x);
            let [da, db, dc] = self.corners(triangle, dx);
            change += dot(da, cross(b, c)) + dot(db, cross(c, a)) + dot(dc, cross(a, b));
            for (i, [y, z, dy, dz]) in
                triangle.iter().zip([[b, c, db, dc], [c, a, dc, da], [a, b, da, db]])
            {
                add(df, *i, cross(dy, z), p / 6.0);
                add(df, *i, cross(y, dz), p / 6.0);
            }
        }
        if slope != 0.0 {
            let factor = slope * change / 36.0;
            for triangle in &self.triangles {
                let [a, b, c] = self.corners(triangle, at.x);
                for (i, push) in triangle.iter().zip([cross(b, c), cross(c, a), cross(a, b)]) {
                    add(df, *i, push, factor);
                }
            }
        }
    }

    /// Visits the sides of each triangle. Those of an edge's two triangles together do not depend
    /// on the origin. They have as many negative eigenvalues as positive ones, so with `clamped`
    /// there are none.
    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        if clamped {
            return;
        }
        let [p, _] = self.pressure(self.volume(x));
        for triangle in &self.triangles {
            let corners = self.corners(triangle, x);
            for k in 0..3 {
                let [i, j] = [k, (k + 1) % 3].map(|k| triangle[k] as usize);
                let [x, y, z] = corners[(k + 2) % 3].map(|x| p * x / 6.0);
                visit(Coupling::General(GeneralCoupling {
                    i,
                    j,
                    stiffness: [0.0, z, -y, -z, 0.0, x, y, -x, 0.0],
                    damping: [0.0; 9],
                }));
            }
        }
    }

    /// Returns whether all couplings are listed: an amount of gas couples all particles with one
    /// another.
    fn lists_all_couplings(&self) -> bool {
        matches!(self.law, GasLaw::Pressure(_)) || self.triangles.is_empty()
    }

    fn energy(&self, at: &At) -> Energy {
        let volume = self.volume(at.x);
        let elastic = match self.law {
            GasLaw::Pressure(p) => -p * volume,
            GasLaw::Amount(own) => {
                let least = volume.max(LEAST_VOLUME * own);
                let at_least = ATMOSPHERE * (least - own - own * (least / own).ln());
                at_least + self.pressure(0.0)[0] * (least - volume)
            }
        };
        Energy { elastic, ..Energy::default() }
    }

    fn cost(&self) -> Cost {
        let couplings = 3.0 * self.triangles.len() as f64;
        Cost { couplings, price: couplings }
    }

    /// Lets the gas escape through the first hole.
    fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        let is_torn = |[i, j]: [u32; 2]| {
            let pair = [i.min(j) as usize, i.max(j) as usize];
            torn.binary_search(&pair).is_ok()
        };
        if sides(&self.triangles).any(is_torn) {
            self.triangles.clear();
        }
    }
}

/// Returns the sides of triangles, in their direction.
fn sides(triangles: &[[u32; 3]]) -> impl Iterator<Item = [u32; 2]> {
    triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
}

fn row(x: &[f64], i: u32) -> [f64; 3] {
    let n = x.len() / 3;
    [0, n, 2 * n].map(|column| x[column + i as usize])
}

fn add(f: &mut [f64], i: u32, push: [f64; 3], factor: f64) {
    let n = f.len() / 3;
    for (axis, push) in push.iter().enumerate() {
        f[axis * n + i as usize] += factor * push;
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let [l, m] = [(k + 1) % 3, (k + 2) % 3];
        a[l] * b[m] - a[m] * b[l]
    })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
