//! Splitting methods: sequences of kicks and drifts.

use super::method::{Create, Method, View};
use super::splitting::{Kicks, Plan};
use super::sweep::{EULER, RK4, Table};
use crate::control::Control;
use crate::rows::Terms;

/// Symplectic (semi-implicit) Euler: v1 = v + h M^-1 F(t, x, v), x1 = x + h v1. Order 1.
pub(super) const SYMPLECTIC_EULER: Method = Method {
    name: "symplectic",
    letter: Some('s'),
    aliases: &["symplectic-euler", "semi-implicit-euler"],
    title: "symplectic Euler",
    order: 1,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 1,
    view: View::Kicks,
    create: Create::Kicks(&SYMPLECTIC_EULER_PLAN),
};

pub(super) static SYMPLECTIC_EULER_PLAN: Plan = Plan {
    name: "symplectic",
    terms: Terms::AllForces,
    free: SYMPLECTIC_EULER_KICK,
    damped: Some(SYMPLECTIC_EULER_KICK),
};

const SYMPLECTIC_EULER_KICK: Kicks =
    Kicks { steps: &[(0.0, 1.0)], last: 1.0, table: EULER, ahead: &[] };

/// Verlet's method as drift-kick-drift: half a step of the exact flow under drag and gravity, a
/// kick of a whole step by the other forces, and half a step of the flow again. Without drag and
/// gravity: xm = x + h/2 v, v1 = v + h M^-1 F(t + h/2, xm), x1 = xm + h/2 v1. Order 2, also with
/// drag.
///
/// The method is conjugate to velocity Verlet, kick-drift-kick, by half a drift, and thus has the
/// same order and the same stability limit. Kick-drift-kick evaluates the forces at both ends of a
/// step, and would have to keep one evaluation for the next step. Drift-kick-drift takes one
/// evaluation in each step and keeps none.
///
/// If forces depend on the velocity, as those of damped springs do, a step has three kicks of h/3,
/// between drifts of h/6, h/3, h/3 and h/6. Kicks by forces at the velocity before them would
/// reduce the order to 1. The second kick evaluates them at v0 + h/2 a1, the third at v0 + h (3/5
/// a1 + 2/5 a2), each with the contribution of the drifts to v0: at velocities of the beginning,
/// the middle and the end of the step, whose mean is that of the middle. The weights 3/5 and 2/5
/// are chosen for the limit of the step (docs/methods.md).
pub(super) const VERLET: Method = Method {
    name: "verlet",
    letter: Some('v'),
    aliases: &["velocity-verlet", "leapfrog"],
    title: "velocity Verlet, exact drag",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 3,
    view: View::Kicks,
    create: Create::Kicks(&VERLET_PLAN),
};

pub(super) static VERLET_PLAN: Plan = Plan {
    name: "verlet",
    terms: Terms::KickForces,
    free: Kicks { steps: &[(0.5, 1.0)], last: 0.5, table: EULER, ahead: &[] },
    damped: Some(Kicks {
        steps: &[(1.0 / 6.0, 1.0 / 3.0), (1.0 / 3.0, 1.0 / 3.0), (1.0 / 3.0, 1.0 / 3.0)],
        last: 1.0 / 6.0,
        table: EULER,
        // h/2 a1 and h (3/5 a1 + 2/5 a2), less the previous kicks.
        ahead: &[(0.0, 1.0 / 6.0), (8.0 / 5.0, 1.0 / 15.0)],
    }),
};

/// PEFRL, the position-extended Forest-Ruth-like method (Omelyan, Mryglod, Folk, *Optimized
/// Forest-Ruth- and Suzuki-like algorithms for integration of motion in many-body systems*, Comput.
/// Phys. Commun. 146, 2002): a symmetric sequence of five drifts and four kicks. Order 4.
///
/// Each drift is the exact flow under drag and gravity. If the other forces depend on the velocity,
/// as those of damped springs do, each kick is one step of the classical Runge-Kutta method in v at
/// fixed x. A kick of lower order would reduce the order of the whole.
pub(super) const PEFRL: Method = Method {
    name: "pefrl",
    letter: Some('p'),
    aliases: &["forest-ruth"],
    title: "PEFRL, symplectic",
    order: 4,
    default_control: Control::Step(0.005),
    evaluations: 4,
    damped_evaluations: 16,
    view: View::Kicks,
    create: Create::Kicks(&PEFRL_PLAN),
};

const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

pub(super) static PEFRL_PLAN: Plan = Plan {
    name: "pefrl",
    terms: Terms::KickForces,
    free: pefrl_kicks(EULER),
    damped: Some(pefrl_kicks(RK4)),
};

const fn pefrl_kicks(table: Table) -> Kicks {
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

/// SRKN11, a symplectic Runge-Kutta-Nyström method of order 6 (Blanes, Moan, *Practical symplectic
/// partitioned Runge-Kutta and Runge-Kutta-Nyström methods*, J. Comput. Appl. Math. 142, 2002,
/// table 3): a symmetric sequence of twelve kicks and eleven drifts. The kick at the end of a step
/// is not kept for the next one.
///
/// Each drift is the exact flow under drag and gravity. The order of the sequence rests on kicks
/// that do not depend on the velocity.
pub(super) const SRKN11: Method = Method {
    name: "srkn11",
    letter: Some('k'),
    aliases: &["blanes-moan"],
    title: "SRKN11, symplectic",
    order: 6,
    default_control: Control::Step(0.01),
    evaluations: 12,
    damped_evaluations: 12,
    view: View::Accelerations,
    create: Create::Kicks(&SRKN11_PLAN),
};

const A1: f64 = 0.123_229_775_946_271;
const A2: f64 = 0.290_553_797_799_558;
const A3: f64 = -0.127_049_212_625_417;
const A4: f64 = -0.246_331_761_062_075;
const A5: f64 = 0.357_208_872_795_928;
const A6: f64 = 1.0 - 2.0 * (A1 + A2 + A3 + A4 + A5);
const B1: f64 = 0.041_464_998_518_262_4;
const B2: f64 = 0.198_128_671_918_067;
const B3: f64 = -0.040_006_192_104_153_3;
const B4: f64 = 0.075_253_984_301_580_7;
const B5: f64 = -0.011_511_387_420_687_9;
const B6: f64 = 0.5 - (B1 + B2 + B3 + B4 + B5);

static SRKN11_PLAN: Plan = Plan {
    name: "srkn11",
    terms: Terms::KickForces,
    free: Kicks {
        steps: &[
            (0.0, B1),
            (A1, B2),
            (A2, B3),
            (A3, B4),
            (A4, B5),
            (A5, B6),
            (A6, B6),
            (A5, B5),
            (A4, B4),
            (A3, B3),
            (A2, B2),
            (A1, B1),
        ],
        last: 0.0,
        table: EULER,
        ahead: &[],
    },
    damped: None,
};
