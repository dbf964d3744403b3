//! Verlet's method, drift-kick-drift: half a step of the exact flow under drag and gravity, the other forces' kick of
//! a whole step, half a step of the flow again. Order 2, drag included.
//!
//! This is velocity Verlet seen from the middle of its step: the same map up to half a drift at either end, so it has
//! the same order and the same limit. Kick-drift-kick would evaluate the forces at both ends, and have to remember
//! one of them from step to step to pay for it once; here one evaluation is all there is, and nothing to go stale.
//!
//! Forces that depend on the velocity (springs damped along their length) are kicked by the explicit midpoint rule in
//! v, two evaluations, because one at the old velocity alone would drop the order to 1.

use super::Method;
use super::runge_kutta::MIDPOINT;
use super::splitting::Plan;
use crate::control::Control;
use crate::rows::Terms;

pub(super) const METHOD: Method = Method {
    name: "verlet",
    letter: 'v',
    aliases: &["velocity-verlet", "leapfrog"],
    title: "velocity Verlet, exact drag",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 2,
    implicit: false,
    pair: None,
    needs_mechanics: true,
    create: |system| PLAN.integrator(system),
};

pub(super) static PLAN: Plan = Plan {
    name: METHOD.name,
    steps: &[(0.5, 1.0)],
    last: 0.5,
    terms: Terms::KickForces,
    damped: MIDPOINT,
};
