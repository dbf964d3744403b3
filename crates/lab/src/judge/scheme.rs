//! Schemes of a step that courses ask for, and those that a slip makes of them.

use super::constant::Constant;
use super::plain::{Forces, Plain};

/// Vector of a particle.
type Triple = [f64; 3];

/// Scheme of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    Euler,
    Symplectic,
    Trapezoid,
    Midpoint,
    Rk4,
    /// Kick, drift, kick; the second kick takes forces at the velocity after the first.
    Verlet,
    /// The same, with forces at the velocity that the first kick predicts for the end.
    VerletPredicted,
    DriftKickDrift,
    /// x2 = 2 x1 - x0 + h2 a1, with forces at the velocity (x1 - x0) / h.
    Stormer,
    ImplicitDrag,
    PositionFirst,
    /// x1 = x0 + h v0 + h2/2 a0 and v1 = v0 + h a0.
    Taylor,
    VerletOldVelocity,
    TrapezoidOldVelocity,
    MidpointOldVelocity,
    Rk4FirstTwice,
    Rk4HalfLast,
    Rk4EqualWeights,
    SweepVelocityFirst,
    SweepPositionFirst,
}

impl Scheme {
    /// All schemes: first those of textbooks, then those with a question.
    pub const ALL: [Self; 20] = [
        Self::Euler,
        Self::Symplectic,
        Self::Trapezoid,
        Self::Midpoint,
        Self::Rk4,
        Self::Verlet,
        Self::VerletPredicted,
        Self::DriftKickDrift,
        Self::Stormer,
        Self::ImplicitDrag,
        Self::PositionFirst,
        Self::Taylor,
        Self::VerletOldVelocity,
        Self::TrapezoidOldVelocity,
        Self::MidpointOldVelocity,
        Self::Rk4FirstTwice,
        Self::Rk4HalfLast,
        Self::Rk4EqualWeights,
        Self::SweepVelocityFirst,
        Self::SweepPositionFirst,
    ];

    /// Returns the name of the scheme.
    pub fn title(self) -> &'static str {
        match self {
            Self::Euler => "explicit Euler",
            Self::Symplectic => "symplectic Euler",
            Self::Trapezoid | Self::TrapezoidOldVelocity => "explicit trapezoid (Heun)",
            Self::Midpoint | Self::MidpointOldVelocity => "explicit midpoint",
            Self::Rk4 | Self::Rk4FirstTwice | Self::Rk4HalfLast | Self::Rk4EqualWeights => {
                "classical Runge-Kutta"
            }
            Self::Verlet | Self::VerletOldVelocity => "velocity Verlet",
            Self::VerletPredicted => "velocity Verlet with a predicted velocity in the forces",
            Self::DriftKickDrift => "leapfrog (drift, kick, drift)",
            Self::Stormer => "Störmer's method",
            Self::ImplicitDrag => "symplectic Euler with implicit drag",
            Self::PositionFirst => "symplectic Euler, positions first",
            Self::Taylor => "explicit Euler with h²/2 a in the positions",
            Self::SweepVelocityFirst => "symplectic Euler, particle by particle",
            Self::SweepPositionFirst => "symplectic Euler, positions first, particle by particle",
        }
    }

    /// Returns a slip that the title does not tell, in a few words, which follow "with".
    pub fn slip(self) -> Option<&'static str> {
        Some(match self {
            Self::VerletOldVelocity => "forces at the end of a step at its old velocity",
            Self::TrapezoidOldVelocity | Self::MidpointOldVelocity => {
                "the second evaluation at the old velocity"
            }
            Self::Rk4FirstTwice => "k3 computed from k1",
            Self::Rk4HalfLast => "k4 half a step ahead",
            Self::Rk4EqualWeights => "equal weights",
            _ => return None,
        })
    }

    /// Returns the question to the author, if the scheme is seldom meant.
    pub fn question(self) -> Option<&'static str> {
        Some(match self {
            Self::PositionFirst => {
                "are the forces taken at the new positions? Explicit Euler takes them at the old ones"
            }
            Self::Taylor => "is h²/2 a meant in the positions? The order stays 1",
            Self::VerletOldVelocity => {
                "are drag and damping at the end of a step taken at the old velocity? The order is 1 then"
            }
            Self::TrapezoidOldVelocity | Self::MidpointOldVelocity => {
                "is the second evaluation at the old velocity? It belongs to the predicted one"
            }
            Self::Rk4FirstTwice => "is k3 computed from k2? It is computed from k1 here",
            Self::Rk4HalfLast => "is k4 a whole step ahead? It is half a step ahead here",
            Self::Rk4EqualWeights => "are the weights 1/6, 1/3, 1/3, 1/6? They are equal here",
            Self::SweepVelocityFirst | Self::SweepPositionFirst => {
                "does each particle move before the forces on the next are taken? All forces come first"
            }
            _ => return None,
        })
    }

    /// Returns the number of evaluations in a step of that many particles.
    pub fn evaluations(self, particles: usize) -> usize {
        match self {
            Self::Trapezoid
            | Self::Midpoint
            | Self::Verlet
            | Self::VerletPredicted
            | Self::TrapezoidOldVelocity
            | Self::MidpointOldVelocity
            | Self::VerletOldVelocity => 2,
            Self::Rk4 | Self::Rk4FirstTwice | Self::Rk4HalfLast | Self::Rk4EqualWeights => 4,
            Self::SweepVelocityFirst | Self::SweepPositionFirst => particles,
            _ => 1,
        }
    }

    /// Returns whether the scheme differs from all before it on a network.
    pub fn serves(self, plain: &Plain) -> bool {
        match self {
            Self::VerletPredicted
            | Self::Stormer
            | Self::VerletOldVelocity
            | Self::TrapezoidOldVelocity
            | Self::MidpointOldVelocity => plain.is_damped(),
            Self::ImplicitDrag => plain.has_drag(),
            _ => true,
        }
    }
}

/// A run of a scheme.
pub struct PlainRun<'a> {
    forces: Forces<'a>,
    scheme: Scheme,
    /// Step (s).
    h: f64,
    /// Whether no step was taken yet.
    is_new: bool,
    x: Vec<Triple>,
    v: Vec<Triple>,
}

impl<'a> PlainRun<'a> {
    /// Creates a run from a state of positions (m) and velocities (m/s).
    pub fn new(mut forces: Forces<'a>, scheme: Scheme, h: f64, [x, v]: [Vec<Triple>; 2]) -> Self {
        forces.without_drag = scheme == Scheme::ImplicitDrag;
        let start = forces.factor(Constant::Start);
        let v = v.into_iter().map(|v| v.map(|v| start * v)).collect();
        let mut run = Self {
            h: forces.rounded(h),
            forces,
            scheme,
            is_new: true,
            x,
            v,
        };
        run.round();
        run
    }

    /// Rounds the state as the program does.
    fn round(&mut self) {
        if self.forces.is_single {
            for number in [&mut self.x, &mut self.v].into_iter().flatten().flatten() {
                *number = self.forces.rounded(*number);
            }
        }
    }

    /// Returns the positions (m).
    pub fn positions(&self) -> &[Triple] {
        &self.x
    }

    /// Returns the velocities (m/s).
    pub fn velocities(&self) -> &[Triple] {
        &self.v
    }

    /// Takes a step.
    pub fn step(&mut self) {
        let (h, forces) = (self.h, &mut self.forces);
        let slower = forces.factor(Constant::Velocities);
        let slowed = |v: Vec<Triple>| -> Vec<Triple> {
            if slower == 1.0 {
                return v;
            }
            v.into_iter().map(|v| v.map(|v| slower * v)).collect()
        };
        let (x0, v0) = (std::mem::take(&mut self.x), std::mem::take(&mut self.v));
        let [x1, v1] = match self.scheme {
            Scheme::Euler => {
                let a = forces.accelerations(&x0, &v0);
                [moved(&x0, h, &v0), moved(&v0, h, &a)]
            }
            Scheme::Symplectic | Scheme::Stormer => {
                let a = forces.accelerations(&x0, &v0);
                let starts = self.scheme == Scheme::Stormer && self.is_new;
                let v1 = slowed(moved(&v0, if starts { 0.5 * h } else { h }, &a));
                return self.take([moved(&x0, h, &v1), v1]);
            }
            Scheme::ImplicitDrag => {
                let a = forces.accelerations(&x0, &v0);
                let slower =
                    |(i, v): (usize, Triple)| v.map(|v| v / (1.0 + h * forces.drag_rate(i)));
                let v1: Vec<_> = moved(&v0, h, &a)
                    .into_iter()
                    .enumerate()
                    .map(slower)
                    .collect();
                [moved(&x0, h, &v1), v1]
            }
            Scheme::PositionFirst => {
                let x1 = moved(&x0, h, &v0);
                let a = forces.accelerations(&x1, &v0);
                [x1, moved(&v0, h, &a)]
            }
            Scheme::Taylor => {
                let a = forces.accelerations(&x0, &v0);
                [
                    moved(&moved(&x0, h, &v0), 0.5 * h * h, &a),
                    moved(&v0, h, &a),
                ]
            }
            Scheme::Trapezoid | Scheme::TrapezoidOldVelocity => {
                let a0 = forces.accelerations(&x0, &v0);
                let v1 = moved(&v0, h, &a0);
                let at = if self.scheme == Scheme::Trapezoid {
                    &v1
                } else {
                    &v0
                };
                let a1 = forces.accelerations(&moved(&x0, h, &v0), at);
                let mean = |y: &[Triple], f0: &[Triple], f1: &[Triple]| {
                    moved(&moved(y, 0.5 * h, f0), 0.5 * h, f1)
                };
                [mean(&x0, &v0, &v1), mean(&v0, &a0, &a1)]
            }
            Scheme::Midpoint | Scheme::MidpointOldVelocity => {
                let a0 = forces.accelerations(&x0, &v0);
                let middle = moved(&v0, 0.5 * h, &a0);
                let at = if self.scheme == Scheme::Midpoint {
                    &middle
                } else {
                    &v0
                };
                let a = forces.accelerations(&moved(&x0, 0.5 * h, &v0), at);
                [moved(&x0, h, &middle), moved(&v0, h, &a)]
            }
            Scheme::Rk4 => runge_kutta(forces, h, &x0, &v0, [0.5, 0.5, 1.0], [1, 2, 3], SIXTHS),
            Scheme::Rk4FirstTwice => {
                runge_kutta(forces, h, &x0, &v0, [0.5, 0.5, 1.0], [1, 1, 3], SIXTHS)
            }
            Scheme::Rk4HalfLast => runge_kutta(forces, h, &x0, &v0, [0.5; 3], [1, 2, 3], SIXTHS),
            Scheme::Rk4EqualWeights => {
                runge_kutta(forces, h, &x0, &v0, [0.5, 0.5, 1.0], [1, 2, 3], [0.25; 4])
            }
            Scheme::Verlet | Scheme::VerletPredicted | Scheme::VerletOldVelocity => {
                let a0 = forces.accelerations(&x0, &v0);
                let half = moved(&v0, 0.5 * h, &a0);
                let x1 = moved(&x0, h, &half);
                let a1 = match self.scheme {
                    Scheme::Verlet => forces.accelerations(&x1, &half),
                    Scheme::VerletPredicted => forces.accelerations(&x1, &moved(&v0, h, &a0)),
                    _ => forces.accelerations(&x1, &v0),
                };
                [x1, moved(&half, 0.5 * h, &a1)]
            }
            Scheme::DriftKickDrift => {
                let middle = moved(&x0, 0.5 * h, &v0);
                let a = forces.accelerations(&middle, &v0);
                let v1 = moved(&v0, h, &a);
                [moved(&middle, 0.5 * h, &v1), v1]
            }
            Scheme::SweepVelocityFirst => sweep(forces, h, x0, v0, false),
            Scheme::SweepPositionFirst => sweep(forces, h, x0, v0, true),
        };
        self.take([x1, slowed(v1)]);
    }

    /// Takes the state at the end of a step.
    fn take(&mut self, state: [Vec<Triple>; 2]) {
        [self.x, self.v] = state;
        self.is_new = false;
        self.round();
    }
}

/// Weights of the classical method.
const SIXTHS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Takes a step of a method with four stages: where each stage after the first is, the stage (from
/// 1) whose rates lead there, and the weights of all.
fn runge_kutta(
    forces: &mut Forces,
    h: f64,
    x0: &[Triple],
    v0: &[Triple],
    ahead: [f64; 3],
    from: [usize; 3],
    weights: [f64; 4],
) -> [Vec<Triple>; 2] {
    let mut rates = vec![(v0.to_vec(), forces.accelerations(x0, v0))];
    for (share, from) in ahead.into_iter().zip(from) {
        let (v, a) = &rates[from - 1];
        let (x, v) = (moved(x0, share * h, v), moved(v0, share * h, a));
        let a = forces.accelerations(&x, &v);
        rates.push((v, a));
    }
    let (mut x1, mut v1) = (x0.to_vec(), v0.to_vec());
    for ((v, a), weight) in rates.iter().zip(weights) {
        (x1, v1) = (moved(&x1, weight * h, v), moved(&v1, weight * h, a));
    }
    [x1, v1]
}

/// Moves particles one by one, each by forces of those that have moved already.
fn sweep(
    forces: &mut Forces,
    h: f64,
    mut x: Vec<Triple>,
    mut v: Vec<Triple>,
    positions_first: bool,
) -> [Vec<Triple>; 2] {
    for i in 0..x.len() {
        if positions_first {
            x[i] = ahead(x[i], h, v[i]);
        }
        v[i] = ahead(v[i], h, forces.accelerations(&x, &v)[i]);
        if !positions_first {
            x[i] = ahead(x[i], h, v[i]);
        }
    }
    [x, v]
}

/// Returns y + h f of one particle.
fn ahead(y: Triple, h: f64, f: Triple) -> Triple {
    std::array::from_fn(|axis| y[axis] + h * f[axis])
}

/// Returns y + h f of all particles.
fn moved(y: &[Triple], h: f64, f: &[Triple]) -> Vec<Triple> {
    y.iter().zip(f).map(|(y, f)| ahead(*y, h, *f)).collect()
}
