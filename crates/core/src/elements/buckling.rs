//! Bend springs that buckle. A strip of rest length r whose ends are closer together than that is
//! an arc of this length: its curvature kappa has L / r = sinc(kappa r / 2), sinc x = sin x / x,
//! its energy is `k_b` kappa2 r / 2, and so its pull is `k_b` kappa2 / (cos(kappa r / 2) -
//! sinc(kappa r / 2)) < 0: a push of 12 `k_b` / r2 when it has just buckled, and of three times
//! that when its ends meet. The strip stays straight, with the pull `c_b` (L - r), while that is
//! the weaker push. Choi, Ko, *Stable but Responsive Cloth*, 2002.
//!
//! All these are functions of y = (kappa r / 2)2, by series that hold for every arc up to a full
//! circle, y = pi2: 1 - sinc = y/6 (1 - y/20 (1 - y/42 ...)), and sinc - cos = y/3 P with P = 1 -
//! y/10 (1 - y/28 ...).

use std::f64::consts::PI;

use super::axial::{self, Elastic};
use super::force::{At, Cost, Force, Matter, check_ends, ends};
use crate::coupling::Coupling;
use crate::energy::Energy;
use crate::error::{Error, at_least, positive};
use crate::spring::{Spring, SpringKind, SpringLaw};

/// Number of terms of the series: the next is below rounding.
const TERMS: usize = 13;
/// Number of iterations of Newton's method: after the third, only rounding is left.
const ITERATIONS: u32 = 3;
/// Price of a buckling spring, in evaluations of an ordinary spring.
const PRICE: f64 = 30.0;

/// A strip between particles i and j, straight at its rest length, that buckles when it is
/// compressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Buckling {
    /// Particle at one end.
    pub i: usize,
    /// Particle at the other end.
    pub j: usize,
    /// Rest length r (m).
    pub rest_length: f64,
    /// Stiffness against bending `k_b` (N m2).
    pub bending: f64,
    /// Stiffness while it is compressed and still straight, `c_b` (N/m).
    pub compression: f64,
    /// Stiffness when it is stretched (N/m): 0 where other springs resist that.
    pub tension: f64,
    /// Damping c along it (N s/m).
    pub damping: f64,
}

/// Bend springs that buckle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BucklingSprings(Vec<Strip>);

impl BucklingSprings {
    /// Returns all springs, in the order in which they were added.
    pub fn all(&self) -> impl Iterator<Item = Buckling> {
        self.0.iter().map(|strip| strip.parameters)
    }

    /// Adds a spring.
    ///
    /// # Errors
    /// A number is negative or not finite; the rest length or the stiffness against bending is 0,
    /// or the compression stiffness less than 4 pi2 `k_b` / r3.
    pub fn push(&mut self, buckling: Buckling) -> Result<(), Error> {
        self.0.push(Strip::new(buckling)?);
        Ok(())
    }

    /// Returns the springs as they are before they buckle.
    pub(crate) fn straight(&self) -> impl Iterator<Item = Spring> {
        self.0.iter().map(Strip::straight)
    }
}

impl Force for BucklingSprings {
    fn name(&self) -> &'static str {
        "buckling"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Elastic)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        self.0.iter().try_for_each(|strip| check_ends(strip.ends(), particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        axial::add_all(&self.0, at.x, at.v, f);
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        for strip in &self.0 {
            axial::add_differential(strip, at, d, df);
        }
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for strip in &self.0 {
            visit(axial::coupling(strip, x, clamped));
        }
    }

    fn energy(&self, at: &At) -> Energy {
        axial::energy(self.0.iter().copied(), at.x)
    }

    fn reads_velocity(&self) -> bool {
        self.0.iter().any(|strip| strip.parameters.damping > 0.0)
    }

    fn cost(&self) -> Cost {
        let couplings = self.0.len() as f64;
        Cost { couplings, price: couplings * PRICE }
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        for Strip { parameters, .. } in &mut self.0 {
            parameters.bending *= stiffness;
            parameters.compression *= stiffness;
            parameters.tension *= stiffness;
            parameters.damping *= damping;
        }
    }

    fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        self.0.retain(|strip| torn.binary_search(&ends(&strip.straight())).is_err());
    }
}

/// A buckling spring, and the length at which it buckles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strip {
    parameters: Buckling,
    /// Length below which the strip is an arc (m).
    buckles: f64,
}

impl Strip {
    /// Returns # Errors
    /// A number is out of its range, or the straight strip pushes less than the arc whose ends
    /// meet.
    fn new(parameters: Buckling) -> Result<Self, Error> {
        let r = parameters.rest_length;
        positive("a buckling spring's rest length", r)?;
        positive("a buckling spring's stiffness against bending", parameters.bending)?;
        at_least(0.0, "a buckling spring's tension stiffness", parameters.tension)?;
        at_least(0.0, "a buckling spring's damping", parameters.damping)?;
        let least = 4.0 * PI * PI * parameters.bending / (r * r * r);
        at_least(
            least,
            "a buckling spring's compression stiffness, so that it buckles only once,",
            parameters.compression,
        )?;
        // The two pushes are equal where c_b r s = 12 k_b / (r2 P). The difference is convex, so
        // that Newton's method approaches this s from below.
        let c = parameters.compression * r * r * r / parameters.bending;
        let newton = |s| {
            let [push, slope] = arc(s).push();
            s + (push - c * s) / (c - slope)
        };
        let (mut s, mut next) = (0.0, newton(0.0));
        while next > s {
            (s, next) = (next, newton(next));
        }
        Ok(Self { parameters, buckles: r * (1.0 - s) })
    }

    /// Returns the spring as it is before it buckles.
    fn straight(&self) -> Spring {
        Spring {
            kind: SpringKind::Bend,
            i: self.parameters.i,
            j: self.parameters.j,
            law: SpringLaw {
                stiffness: self.parameters.compression,
                rest_length: self.parameters.rest_length,
                damping: self.parameters.damping,
            },
        }
    }

    fn arc(&self, length: f64) -> Arc {
        arc(1.0 - length / self.parameters.rest_length)
    }
}

impl Elastic for Strip {
    #[inline]
    fn ends(&self) -> [usize; 2] {
        [self.parameters.i, self.parameters.j]
    }

    fn pull(&self, length: f64) -> f64 {
        let r = self.parameters.rest_length;
        if length >= r {
            self.parameters.tension * (length - r)
        } else if length >= self.buckles {
            self.parameters.compression * (length - r)
        } else {
            -self.parameters.bending * self.arc(length).push()[0] / (r * r)
        }
    }

    fn stiffness(&self, length: f64) -> f64 {
        let r = self.parameters.rest_length;
        if length >= r {
            self.parameters.tension
        } else if length >= self.buckles {
            self.parameters.compression
        } else {
            self.parameters.bending * self.arc(length).push()[1] / (r * r * r)
        }
    }

    fn energy(&self, length: f64) -> f64 {
        let r = self.parameters.rest_length;
        let straight = |length: f64| 0.5 * self.parameters.compression * (length - r).powi(2);
        if length >= r {
            0.5 * self.parameters.tension * (length - r).powi(2)
        } else if length >= self.buckles {
            straight(length)
        } else {
            let bent = |length: f64| 2.0 * self.parameters.bending * self.arc(length).y / r;
            straight(self.buckles) + bent(length) - bent(self.buckles)
        }
    }

    #[inline]
    fn damping(&self, _: f64) -> f64 {
        self.parameters.damping
    }
}

/// Curvature of an arc, as y, with P and dP/dy.
struct Arc {
    y: f64,
    p: f64,
    slope: f64,
}

/// Returns the arc whose ends are closer than its length by the fraction s of that, from 0 to 1. It
/// solves 1 - sinc = s by Newton's method in y.
fn arc(s: f64) -> Arc {
    // Exact to the third order in small s, and where s is 1.
    let mut y = s * (6.0 + s * (1.8 + s * (0.822_857_142_857 + s * 1.246_747_258_232)));
    for _ in 0..ITERATIONS {
        let shortening = y / 6.0 * sum(&SHORTENING, y)[0];
        y += (s - shortening) * 6.0 / sum(&P, y)[0];
    }
    let [p, slope] = sum(&P, y);
    Arc { y, p, slope }
}

impl Arc {
    /// Returns the push in units of `k_b` / r2, and its derivative with respect to s.
    fn push(&self) -> [f64; 2] {
        // dy/ds = 6 / P.
        let push = 12.0 / self.p;
        [push, -push * self.slope / self.p * 6.0 / self.p]
    }
}

const SHORTENING: [f64; TERMS] = ratios(4);
const P: [f64; TERMS] = ratios(2);

/// Returns 1 / (m 5), 1 / ((m + 2) 7), 1 / ((m + 4) 9) ...
const fn ratios(m: usize) -> [f64; TERMS] {
    let mut ratios = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        ratios[k] = 1.0 / ((m + 2 * k) * (5 + 2 * k)) as f64;
        k += 1;
    }
    ratios
}

/// Returns 1 - a y (1 - b y (1 - c y ...)), and its derivative.
fn sum(ratios: &[f64; TERMS], y: f64) -> [f64; 2] {
    ratios
        .iter()
        .rev()
        .fold([1.0, 0.0], |[sum, slope], ratio| [1.0 - ratio * y * sum, -ratio * (sum + y * slope)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By bisection.
    #[test]
    fn the_inverse_of_sinc_is_found_to_the_last_digits() {
        for k in 1..=1000 {
            let s = f64::from(k) / 1000.0;
            let (mut low, mut high) = (0.0, PI);
            for _ in 0..60 {
                let x: f64 = 0.5 * (low + high);
                if 1.0 - x.sin() / x < s {
                    low = x;
                } else {
                    high = x;
                }
            }
            let found = arc(s).y.sqrt();
            // Error of the bisection, where 1 - sinc is flat.
            let rounding = 1e-15 / found;
            assert!((found - high).abs() < 1e-14 + rounding, "{s}: {found} {high}");
        }
        assert!((arc(1.0).y.sqrt() - PI).abs() < 1e-14);
        assert_eq!(arc(0.0).y, 0.0);
    }
}
