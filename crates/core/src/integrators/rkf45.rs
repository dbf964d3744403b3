//! Runge-Kutta-Fehlberg 4(5) (Fehlberg, NASA TR R-315, 1969). The state is advanced by the method
//! of order 5, and its error is estimated by the method of order 4. Neither is stable on the
//! imaginary axis, so that undamped motion grows at any step.
//!
//! The dense output is a polynomial of degree 4. It takes states and derivatives at both ends of
//! the step, and one more derivative at a quarter of it, at the state of the cubic Hermite
//! polynomial through both ends (Shampine, *Interpolation for Runge-Kutta methods*, 1985).

use super::embedded::{EmbeddedPair, Tableau};
use super::method::{Create, Method, View};
use crate::control::Control;

pub(super) const METHOD: Method = Method {
    name: "rkf45",
    letter: Some('f'),
    aliases: &["fehlberg"],
    title: "Runge-Kutta-Fehlberg 4(5), adaptive",
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
        (1.0 / 4.0, &[1.0 / 4.0]),
        (3.0 / 8.0, &[3.0 / 32.0, 9.0 / 32.0]),
        (12.0 / 13.0, &[1932.0 / 2197.0, -7200.0 / 2197.0, 7296.0 / 2197.0]),
        (1.0, &[439.0 / 216.0, -8.0, 3680.0 / 513.0, -845.0 / 4104.0]),
        (1.0 / 2.0, &[-8.0 / 27.0, 2.0, -3544.0 / 2565.0, 1859.0 / 4104.0, -11.0 / 40.0]),
    ],
    weights: &[16.0 / 135.0, 0.0, 6656.0 / 12825.0, 28561.0 / 56430.0, -9.0 / 50.0, 2.0 / 55.0],
    errors: &[
        &[1.0 / 360.0, 0.0, -128.0 / 4275.0, -2197.0 / 75240.0, 1.0 / 50.0, 2.0 / 55.0],
    ],
    exponent: 5.0,
    extra: &[
        (1.0 / 4.0, &[
            275.0 / 1728.0, 0.0, 208.0 / 2565.0, 28561.0 / 361_152.0, -9.0 / 320.0, 1.0 / 176.0,
            -3.0 / 64.0,
        ]),
    ],
    dense: &[
        &[
            -77.0 / 45.0, 0.0, -13312.0 / 4275.0, -28561.0 / 9405.0, 27.0 / 25.0, -12.0 / 55.0,
            5.0 / 3.0, 16.0 / 3.0,
        ],
    ],
};
