//! Verlet's method as drift-kick-drift: half a step of the exact flow under drag and gravity, a
//! kick of a whole step by the other forces, and half a step of the flow again. Without drag and
//! gravity: xm = x + h/2 v, v1 = v + h M^-1 F(t + h/2, xm), x1 = xm + h/2 v1. Order 2, also with
//! drag.
//!
//! The method is conjugate to velocity Verlet, kick-drift-kick, by half a drift, and thus has the
//! same order and the same stability limit. Kick-drift-kick evaluates the forces at both ends of a
//! step, and would have to keep one evaluation for the next step. Drift-kick-drift takes one
//! evaluation in each step and keeps none.
//!
//! If forces depend on the velocity, as those of damped springs do, a step has three kicks of h/3,
//! between drifts of h/6, h/3, h/3 and h/6. Kicks by forces at the velocity before them would
//! reduce the order to 1. The second kick evaluates them at v0 + h/2 a1, the third at v0 + h (3/5
//! a1 + 2/5 a2), each with the contribution of the drifts to v0: at velocities of the beginning,
//! the middle and the end of the step, whose mean is that of the middle. The weights 3/5 and 2/5
//! are chosen for the limit of the step (docs/methods.md).

use super::method::{Create, Method, View};
use super::runge_kutta::EULER;
use super::splitting::{Kicks, Plan};
use crate::control::Control;
use crate::rows::Terms;

pub(super) const METHOD: Method = Method {
    name: "verlet",
    letter: Some('v'),
    aliases: &["velocity-verlet", "leapfrog"],
    title: "velocity Verlet, exact drag",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 3,
    view: View::Kicks,
    create: Create::Table(|system| PLAN.integrator(system)),
    trial: None,
};

pub(super) static PLAN: Plan = Plan {
    name: METHOD.name,
    terms: Terms::KickForces,
    free: Kicks {
        steps: &[(0.5, 1.0)],
        last: 0.5,
        table: EULER,
        ahead: &[],
    },
    damped: Some(Kicks {
        steps: &[
            (1.0 / 6.0, 1.0 / 3.0),
            (1.0 / 3.0, 1.0 / 3.0),
            (1.0 / 3.0, 1.0 / 3.0),
        ],
        last: 1.0 / 6.0,
        table: EULER,
        // h/2 a1 and h (3/5 a1 + 2/5 a2), less the previous kicks.
        ahead: &[(0.0, 1.0 / 6.0), (8.0 / 5.0, 1.0 / 15.0)],
    }),
};
