//! PEFRL, the position-extended Forest-Ruth-like method (Omelyan, Mryglod, Folk, *Optimized
//! Forest-Ruth- and Suzuki-like algorithms for integration of motion in many-body systems*, Comput.
//! Phys. Commun. 146, 2002): a symmetric sequence of five drifts and four kicks. Order 4.
//!
//! Each drift is the exact flow under drag and gravity. If the other forces depend on the velocity,
//! as those of damped springs do, each kick is one step of the classical Runge-Kutta method in v at
//! fixed x. A kick of lower order would reduce the order of the whole.

use super::method::{Create, Method, View};
use super::runge_kutta::{EULER, RK4, Table};
use super::splitting::{Kicks, Plan};
use crate::control::Control;
use crate::rows::Terms;

pub(super) const METHOD: Method = Method {
    name: "pefrl",
    letter: Some('p'),
    aliases: &["forest-ruth"],
    title: "PEFRL, symplectic",
    order: 4,
    default_control: Control::Step(0.005),
    evaluations: 4,
    damped_evaluations: 16,
    view: View::Kicks,
    create: Create::Table(|system| PLAN.integrator(system)),
    trial: None,
};

const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

pub(super) static PLAN: Plan = Plan {
    name: METHOD.name,
    terms: Terms::KickForces,
    free: kicks(EULER),
    damped: Some(kicks(RK4)),
};

const fn kicks(table: Table) -> Kicks {
    Kicks {
        steps: &[
            (XI, 0.5 - LAMBDA),
            (CHI, LAMBDA),
            (1.0 - 2.0 * (CHI + XI), LAMBDA),
            (CHI, 0.5 - LAMBDA),
        ],
        last: XI,
        table,
        ahead: &[],
    }
}
