//! Dormand-Prince 5(4), known as ode45 (Dormand, Prince, *A family of embedded Runge-Kutta
//! formulae*, J. Comput. Appl. Math. 6, 1980). The state is advanced by the method of order 5, and
//! its error is estimated by a method of order 4. The dense output has order 4 (Hairer, Norsett,
//! Wanner, *Solving Ordinary Differential Equations I*, 1993, II.6).

use super::embedded::{EmbeddedPair, Tableau};
use super::method::{Create, Method, View};
use crate::control::Control;

pub(super) const METHOD: Method = Method {
    name: "dopri5",
    letter: Some('a'),
    aliases: &["ode45", "dormand-prince"],
    title: "Dormand-Prince 5(4), adaptive",
    order: 5,
    default_control: Control::Tolerance(1e-3),
    evaluations: 6,
    damped_evaluations: 6,
    view: View::Derivative,
    create: Create::Table(|system| Box::new(EmbeddedPair::new(&TABLEAU, system.dim()))),
    trial: Some(|system| Box::new(EmbeddedPair::new(&TABLEAU, system.dim()))),
};

#[rustfmt::skip]
static TABLEAU: Tableau = Tableau {
    stages: &[
        (1.0 / 5.0, &[1.0 / 5.0]),
        (3.0 / 10.0, &[3.0 / 40.0, 9.0 / 40.0]),
        (4.0 / 5.0, &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0]),
        (8.0 / 9.0, &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0]),
        (1.0, &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0]),
    ],
    weights: &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    errors: &[
        &[
            71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0,
            -1.0 / 40.0,
        ],
    ],
    exponent: 5.0,
    extra: &[],
    dense: &[
        &[
            -12_715_105_075.0 / 11_282_082_432.0, 0.0, 87_487_479_700.0 / 32_700_410_799.0,
            -10_690_763_975.0 / 1_880_347_072.0, 701_980_252_875.0 / 199_316_789_632.0,
            -1_453_857_185.0 / 822_651_844.0, 69_997_945.0 / 29_380_423.0,
        ],
    ],
};
