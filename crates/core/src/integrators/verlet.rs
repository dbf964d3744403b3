//! Verlet's method as drift-kick-drift: half a step of the exact flow under drag and gravity, a
//! kick of a whole step by the other forces, and half a step of the flow again. Without drag and
//! gravity: xm = x + h/2 v, v1 = v + h M^-1 F(t + h/2, xm), x1 = xm + h/2 v1. Order 2, also with
//! drag.
//!
//! The method is conjugate to velocity Verlet, kick-drift-kick, by half a drift, and so has the
//! same order and the same stability limit. Kick-drift-kick evaluates the forces at both ends of a
//! step, and would have to keep one evaluation from step to step in order to pay for it only once.
//! Drift-kick-drift takes one evaluation in each step and keeps none.
//!
//! Where forces depend on the velocity, as those of damped springs do, a kick is a step of the
//! explicit midpoint rule in v, of two evaluations. A single evaluation at the old velocity would
//! reduce the order to 1.

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
    needs_mechanics: true,
    positions_only: false,
    needs_springs: false,
    create: |system| PLAN.integrator(system),
    trial: None,
};

pub(super) static PLAN: Plan = Plan {
    name: METHOD.name,
    steps: &[(0.5, 1.0)],
    last: 0.5,
    terms: Terms::KickForces,
    damped: Some(MIDPOINT),
};
