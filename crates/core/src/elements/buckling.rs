//! Bend springs that buckle. A strip of rest length r whose ends are closer together than that is an arc of this length:
//! its curvature kappa has L / r = sinc(kappa r / 2), sinc x = sin x / x, its energy is `k_b` kappa2 r / 2, and so it pulls
//! with `k_b` kappa2 / (cos(kappa r / 2) - sinc(kappa r / 2)) < 0: it pushes, by 12 `k_b` / r2 when it has just buckled, and
//! three times that when its ends meet. It is straight, and pulls with `c_b` (L - r), while that is the weaker push.
//! Choi, Ko, *Stable but Responsive Cloth*, 2002.
//!
//! All is a function of y = (kappa r / 2)2, by series that hold for every arc up to a full circle, y = pi2:
//! 1 - sinc = y/6 (1 - y/20 (1 - y/42 ...)), and sinc - cos = y/3 P with P = 1 - y/10 (1 - y/28 ...).

use std::f64::consts::PI;

use super::springs::Elastic;
use crate::error::{Error, at_least, positive};
use crate::spring::{Spring, SpringKind, SpringLaw};

/// Terms of the series: the next is lost in rounding.
const TERMS: usize = 13;
/// Iterations of Newton's method: the third is the last that changes anything but rounding.
const ITERATIONS: u32 = 3;
/// What it costs, in ordinary springs.
pub(crate) const PRICE: f64 = 30.0;

/// A strip between particles i and j, straight at its rest length, that buckles when it is compressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Buckling {
    /// One end.
    pub i: usize,
    /// The other end.
    pub j: usize,
    /// r (m).
    pub rest_length: f64,
    /// `k_b`, its stiffness against bending (N m2).
    pub bending: f64,
    /// `c_b`, its stiffness while it is compressed and still straight (N/m).
    pub compression: f64,
    /// Its stiffness when it is stretched (N/m): 0 where other springs resist that.
    pub tension: f64,
    /// c, along it (N s/m).
    pub damping: f64,
}

/// One that has been looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strip {
    pub of: Buckling,
    /// The length below which it is an arc (m).
    buckles: f64,
}

impl Strip {
    /// # Errors
    /// A number makes no sense, or the straight strip is weaker than the arc that it would be when its ends meet.
    pub fn new(of: Buckling) -> Result<Self, Error> {
        let r = of.rest_length;
        positive("a buckling spring's rest length", r)?;
        positive("a buckling spring's stiffness against bending", of.bending)?;
        at_least(0.0, "a buckling spring's tension stiffness", of.tension)?;
        at_least(0.0, "a buckling spring's damping", of.damping)?;
        let least = 4.0 * PI * PI * of.bending / (r * r * r);
        at_least(
            least,
            "a buckling spring's compression stiffness, so that it buckles only once,",
            of.compression,
        )?;
        // Where both push alike: c_b r s = 12 k_b / (r2 P). The difference is convex, so that s grows up to there.
        let c = of.compression * r * r * r / of.bending;
        let newton = |s| {
            let [push, slope] = arc(s).push();
            s + (push - c * s) / (c - slope)
        };
        let (mut s, mut next) = (0.0, newton(0.0));
        while next > s {
            (s, next) = (next, newton(next));
        }
        Ok(Self {
            of,
            buckles: r * (1.0 - s),
        })
    }

    /// The spring that it is before it buckles.
    pub fn straight(&self) -> Spring {
        Spring {
            kind: SpringKind::Bend,
            i: self.of.i,
            j: self.of.j,
            law: SpringLaw {
                stiffness: self.of.compression,
                rest_length: self.of.rest_length,
                damping: self.of.damping,
            },
        }
    }

    fn arc(&self, length: f64) -> Arc {
        arc(1.0 - length / self.of.rest_length)
    }
}

impl Elastic for Strip {
    #[inline]
    fn ends(&self) -> [usize; 2] {
        [self.of.i, self.of.j]
    }

    fn pull(&self, length: f64) -> f64 {
        let r = self.of.rest_length;
        if length >= r {
            self.of.tension * (length - r)
        } else if length >= self.buckles {
            self.of.compression * (length - r)
        } else {
            -self.of.bending * self.arc(length).push()[0] / (r * r)
        }
    }

    fn stiffness(&self, length: f64) -> f64 {
        let r = self.of.rest_length;
        if length >= r {
            self.of.tension
        } else if length >= self.buckles {
            self.of.compression
        } else {
            self.of.bending * self.arc(length).push()[1] / (r * r * r)
        }
    }

    fn energy(&self, length: f64) -> f64 {
        let r = self.of.rest_length;
        let straight = |length: f64| 0.5 * self.of.compression * (length - r).powi(2);
        if length >= r {
            0.5 * self.of.tension * (length - r).powi(2)
        } else if length >= self.buckles {
            straight(length)
        } else {
            let bent = |length: f64| 2.0 * self.of.bending * self.arc(length).y / r;
            straight(self.buckles) + bent(length) - bent(self.buckles)
        }
    }

    #[inline]
    fn damping(&self) -> f64 {
        self.of.damping
    }
}

/// An arc, with P and dP/dy.
struct Arc {
    y: f64,
    p: f64,
    slope: f64,
}

/// The one whose ends are closer by this share of its length, 0 to 1: 1 - sinc = s, by Newton's method in y.
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
    /// How it pushes, in `k_b` / r2, and how that grows with s.
    fn push(&self) -> [f64; 2] {
        // dy/ds = 6 / P.
        let push = 12.0 / self.p;
        [push, -push * self.slope / self.p * 6.0 / self.p]
    }
}

const SHORTENING: [f64; TERMS] = ratios(4);
const P: [f64; TERMS] = ratios(2);

/// 1 / (m 5), 1 / ((m + 2) 7), 1 / ((m + 4) 9) ...
const fn ratios(m: usize) -> [f64; TERMS] {
    let mut ratios = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        ratios[k] = 1.0 / ((m + 2 * k) * (5 + 2 * k)) as f64;
        k += 1;
    }
    ratios
}

/// 1 - a y (1 - b y (1 - c y ...)), and its derivative.
fn sum(ratios: &[f64; TERMS], y: f64) -> [f64; 2] {
    ratios.iter().rev().fold([1.0, 0.0], |[sum, slope], ratio| {
        [1.0 - ratio * y * sum, -ratio * (sum + y * slope)]
    })
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
            // What bisection loses where 1 - sinc is flat.
            let rounding = 1e-15 / found;
            assert!(
                (found - high).abs() < 1e-14 + rounding,
                "{s}: {found} {high}"
            );
        }
        assert!((arc(1.0).y.sqrt() - PI).abs() < 1e-14);
        assert_eq!(arc(0.0).y, 0.0);
    }
}
