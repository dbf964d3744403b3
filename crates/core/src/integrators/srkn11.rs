//! SRKN11, a symplectic Runge-Kutta-Nyström method of order 6 (Blanes, Moan, *Practical symplectic
//! partitioned Runge-Kutta and Runge-Kutta-Nyström methods*, J. Comput. Appl. Math. 142, 2002,
//! table 3): a symmetric sequence of twelve kicks and eleven drifts. The kick at the end of a step
//! is not kept for the next one.
//!
//! Each drift is the exact flow under drag and gravity. The order of the sequence rests on kicks
//! that do not depend on the velocity.

use super::method::{Create, Method, View};
use super::runge_kutta::EULER;
use super::splitting::{Kicks, Plan};
use crate::control::Control;
use crate::rows::Terms;

pub(super) const METHOD: Method = Method {
    name: "srkn11",
    letter: Some('k'),
    aliases: &["blanes-moan"],
    title: "SRKN11, symplectic",
    order: 6,
    default_control: Control::Step(0.01),
    evaluations: 12,
    damped_evaluations: 12,
    view: View::Accelerations,
    create: Create::Table(|system| PLAN.integrator(system)),
    trial: None,
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

pub(super) static PLAN: Plan = Plan {
    name: METHOD.name,
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
