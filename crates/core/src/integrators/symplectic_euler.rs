//! Symplectic (semi-implicit) Euler: v1 = v + h M^-1 F(t, x, v), x1 = x + h v1. Order 1.

use super::method::{Create, Method, View};
use super::runge_kutta::EULER;
use super::splitting::{Kicks, Plan};
use crate::control::Control;
use crate::rows::Terms;

pub(super) const METHOD: Method = Method {
    name: "symplectic",
    letter: Some('s'),
    aliases: &["symplectic-euler", "semi-implicit-euler"],
    title: "symplectic Euler",
    order: 1,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 1,
    view: View::Kicks,
    create: Create::Table(|system| PLAN.integrator(system)),
    trial: None,
};

pub(super) static PLAN: Plan = Plan {
    name: METHOD.name,
    terms: Terms::AllForces,
    free: KICK,
    damped: Some(KICK),
};

const KICK: Kicks = Kicks {
    steps: &[(0.0, 1.0)],
    last: 1.0,
    table: EULER,
    ahead: &[],
};
