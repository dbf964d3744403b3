//! Schemes of a step that courses ask for, and those that a slip makes of them.

use super::constant::Constant;
use super::plain::{Forces, Plain, Triple};

/// Scheme of a step.
#[derive(Debug, PartialEq)]
pub struct Scheme {
    /// Name of the scheme.
    pub title: &'static str,
    /// Slip that the title does not tell, in a few words, which follow "with".
    pub slip: Option<&'static str>,
    /// Question to the author, if the scheme is seldom meant.
    pub question: Option<&'static str>,
    /// Forces without which the scheme is the same as one before it.
    needs: Needs,
    steps: Steps,
}

/// Forces that depend on velocities.
#[derive(Debug, PartialEq)]
enum Needs {
    None,
    Damping,
    Drag,
}

/// How a scheme takes a step.
#[derive(Debug, PartialEq)]
enum Steps {
    /// Runge-Kutta: where each stage after the first is, with the stage (from 1) whose rates lead
    /// there; the weights of all; and the velocity at which their forces are taken.
    Stages(&'static [(f64, usize)], &'static [f64], At),
    /// Kicks and drifts over shares of the step, and the velocity at which the forces of kicks
    /// after the first are taken.
    Parts(&'static [Part], At),
    /// A kick, and a drift at the velocity after it. The first kick of a run is over this share of
    /// a step: half of one in x2 = 2 x1 - x0 + h2 a1, with forces at the velocity (x1 - x0) / h.
    KickDrift(f64),
    /// A kick that is divided by 1 + h c / m, and a drift.
    ImplicitDrag,
    /// x1 = x0 + h v0 + h2/2 a0 and v1 = v0 + h a0.
    Taylor,
    /// Kick and drift of one particle after another, the drift first if so.
    Sweep(bool),
}

/// Part of a step, over a share of it.
#[derive(Debug, PartialEq)]
enum Part {
    Kick(f64),
    Drift(f64),
}

/// Velocity at which forces are taken.
#[derive(Debug, PartialEq)]
enum At {
    Present,
    /// That which the first kick predicts for the end of the step.
    Predicted,
    Old,
}

use Part::{Drift, Kick};
use Steps::{ImplicitDrag, KickDrift, Parts, Stages, Sweep, Taylor};

const HEUN: &str = "explicit trapezoid (Heun)";
const MIDPOINT: &str = "explicit midpoint";
const RK4: &str = "classical Runge-Kutta";
const VERLET: &str = "velocity Verlet";
/// Stages of the classical method, and its weights.
const RK4_STAGES: &[(f64, usize)] = &[(0.5, 1), (0.5, 2), (1.0, 3)];
const SIXTHS: &[f64] = &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
const KICK_DRIFT_KICK: &[Part] = &[Kick(0.5), Drift(1.0), Kick(0.5)];
const OLD_VELOCITY: Option<&str> = Some("the second evaluation at the old velocity");
const WHICH_VELOCITY: Option<&str> =
    Some("is the second evaluation at the old velocity? It belongs to the predicted one");
const ALL_FORCES_FIRST: Option<&str> =
    Some("does each particle move before the forces on the next are taken? All forces come first");

/// Row of a scheme that serves all networks, and has no slip.
const PLAIN: Scheme =
    Scheme { title: "", slip: None, question: None, needs: Needs::None, steps: Taylor };

/// All schemes: first those of textbooks, then those with a question.
#[rustfmt::skip]
pub static SCHEMES: [Scheme; 20] = [
    Scheme { title: "explicit Euler", steps: Stages(&[], &[1.0], At::Present), ..PLAIN },
    Scheme { title: "symplectic Euler", steps: KickDrift(1.0), ..PLAIN },
    Scheme { title: HEUN, steps: Stages(&[(1.0, 1)], &[0.5, 0.5], At::Present), ..PLAIN },
    Scheme { title: MIDPOINT, steps: Stages(&[(0.5, 1)], &[0.0, 1.0], At::Present), ..PLAIN },
    Scheme { title: RK4, steps: Stages(RK4_STAGES, SIXTHS, At::Present), ..PLAIN },
    Scheme { title: VERLET, steps: Parts(KICK_DRIFT_KICK, At::Present), ..PLAIN },
    Scheme { title: "velocity Verlet with a predicted velocity in the forces",
             needs: Needs::Damping, steps: Parts(KICK_DRIFT_KICK, At::Predicted), ..PLAIN },
    Scheme { title: "leapfrog (drift, kick, drift)",
             steps: Parts(&[Drift(0.5), Kick(1.0), Drift(0.5)], At::Present), ..PLAIN },
    Scheme { title: "Störmer's method", needs: Needs::Damping, steps: KickDrift(0.5), ..PLAIN },
    Scheme { title: "symplectic Euler with implicit drag",
             needs: Needs::Drag, steps: ImplicitDrag, ..PLAIN },
    Scheme { title: "symplectic Euler, positions first",
             question: Some("are the forces taken at the new positions? Explicit Euler takes them \
                             at the old ones"),
             steps: Parts(&[Drift(1.0), Kick(1.0)], At::Present), ..PLAIN },
    Scheme { title: "explicit Euler with h²/2 a in the positions",
             question: Some("is h²/2 a meant in the positions? The order stays 1"), ..PLAIN },
    Scheme { title: VERLET, slip: Some("forces at the end of a step at its old velocity"),
             question: Some("are drag and damping at the end of a step taken at the old velocity? \
                             The order is 1 then"),
             needs: Needs::Damping, steps: Parts(KICK_DRIFT_KICK, At::Old) },
    Scheme { title: HEUN, slip: OLD_VELOCITY, question: WHICH_VELOCITY,
             needs: Needs::Damping, steps: Stages(&[(1.0, 1)], &[0.5, 0.5], At::Old) },
    Scheme { title: MIDPOINT, slip: OLD_VELOCITY, question: WHICH_VELOCITY,
             needs: Needs::Damping, steps: Stages(&[(0.5, 1)], &[0.0, 1.0], At::Old) },
    Scheme { title: RK4, slip: Some("k3 computed from k1"),
             question: Some("is k3 computed from k2? It is computed from k1 here"),
             steps: Stages(&[(0.5, 1), (0.5, 1), (1.0, 3)], SIXTHS, At::Present), ..PLAIN },
    Scheme { title: RK4, slip: Some("k4 half a step ahead"),
             question: Some("is k4 a whole step ahead? It is half a step ahead here"),
             steps: Stages(&[(0.5, 1), (0.5, 2), (0.5, 3)], SIXTHS, At::Present), ..PLAIN },
    Scheme { title: RK4, slip: Some("equal weights"),
             question: Some("are the weights 1/6, 1/3, 1/3, 1/6? They are equal here"),
             steps: Stages(RK4_STAGES, &[0.25; 4], At::Present), ..PLAIN },
    Scheme { title: "symplectic Euler, particle by particle",
             question: ALL_FORCES_FIRST, steps: Sweep(false), ..PLAIN },
    Scheme { title: "symplectic Euler, positions first, particle by particle",
             question: ALL_FORCES_FIRST, steps: Sweep(true), ..PLAIN },
];

impl Scheme {
    /// Returns the number of evaluations in a step of that many particles.
    pub fn evaluations(&self, particles: usize) -> usize {
        match self.steps {
            Stages(_, weights, _) => weights.len(),
            Parts(parts, _) => parts.iter().filter(|it| matches!(it, Kick(_))).count(),
            KickDrift(_) | ImplicitDrag | Taylor => 1,
            Sweep(_) => particles,
        }
    }

    /// Returns whether the scheme differs from all before it on a network.
    pub fn serves(&self, plain: &Plain) -> bool {
        match self.needs {
            Needs::None => true,
            Needs::Damping => plain.is_damped(),
            Needs::Drag => plain.list.drag > 0.0,
        }
    }
}

/// A run of a scheme.
pub struct PlainRun<'a> {
    forces: Forces<'a>,
    scheme: &'static Scheme,
    /// Step (s).
    h: f64,
    /// Whether no step was taken yet.
    is_new: bool,
    /// Positions (m).
    pub x: Vec<Triple>,
    /// Velocities (m/s).
    pub v: Vec<Triple>,
}

impl<'a> PlainRun<'a> {
    /// Creates a run from a state of positions (m) and velocities (m/s).
    pub fn new(
        mut forces: Forces<'a>,
        scheme: &'static Scheme,
        h: f64,
        [x, v]: [Vec<Triple>; 2],
    ) -> Self {
        forces.without_drag = scheme.steps == ImplicitDrag;
        let start = forces.factor(Constant::Start);
        let v = v.into_iter().map(|v| v.map(|v| start * v)).collect();
        let h = forces.rounded(h);
        let mut run = Self { forces, scheme, h, is_new: true, x, v };
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
        let [x1, v1] = match self.scheme.steps {
            Stages(ahead, weights, ref at) => {
                let mut rates = vec![(v0.clone(), forces.accelerations(&x0, &v0))];
                for (share, from) in ahead {
                    let (v, a) = &rates[from - 1];
                    let (x, v) = (moved(&x0, share * h, v), moved(&v0, share * h, a));
                    let a = forces.accelerations(&x, if *at == At::Old { &v0 } else { &v });
                    rates.push((v, a));
                }
                let (mut x1, mut v1) = (x0, v0);
                for ((v, a), weight) in rates.iter().zip(weights) {
                    (x1, v1) = (moved(&x1, weight * h, v), moved(&v1, weight * h, a));
                }
                [x1, v1]
            }
            Parts(parts, ref at) => {
                let (mut x, mut v, mut seen) = (x0, v0.clone(), v0.clone());
                for part in parts {
                    match *part {
                        Drift(share) => x = moved(&x, share * h, &v),
                        Kick(share) => {
                            let at_present = *at == At::Present;
                            let a = forces.accelerations(&x, if at_present { &v } else { &seen });
                            v = moved(&v, share * h, &a);
                            if *at == At::Predicted {
                                seen = moved(&v0, h, &a);
                            }
                        }
                    }
                }
                [x, v]
            }
            KickDrift(first) => {
                let a = forces.accelerations(&x0, &v0);
                let share = if self.is_new { first } else { 1.0 };
                let v1 = moved(&v0, share * h, &a);
                [moved(&x0, h, &slowed(v1.clone())), v1]
            }
            ImplicitDrag => {
                let mut v1 = moved(&v0, h, &forces.accelerations(&x0, &v0));
                for (i, v) in v1.iter_mut().enumerate() {
                    *v = v.map(|v| v / (1.0 + h * forces.drag_rate(i)));
                }
                [moved(&x0, h, &v1), v1]
            }
            Taylor => {
                let a = forces.accelerations(&x0, &v0);
                let x1 = moved(&moved(&x0, h, &v0), 0.5 * h * h, &a);
                [x1, moved(&v0, h, &a)]
            }
            Sweep(drift_first) => sweep(forces, h, [x0, v0], drift_first),
        };
        (self.x, self.v, self.is_new) = (x1, slowed(v1), false);
        self.round();
    }
}

/// Moves particles one by one, each by forces of those that have moved already.
fn sweep(
    forces: &mut Forces,
    h: f64,
    [mut x, mut v]: [Vec<Triple>; 2],
    drift_first: bool,
) -> [Vec<Triple>; 2] {
    for i in 0..x.len() {
        if drift_first {
            x[i] = ahead(x[i], h, v[i]);
        }
        v[i] = ahead(v[i], h, forces.accelerations(&x, &v)[i]);
        if !drift_first {
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
