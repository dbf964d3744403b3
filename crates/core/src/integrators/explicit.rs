//! Explicit Runge-Kutta methods in which each stage depends only on the one before it.

use super::method::{Create, Method, View};
use super::runge_kutta;
use crate::control::Control;

/// Explicit Euler: y1 = y + h f(t, y). Order 1.
pub(super) const EULER: Method = Method {
    name: "euler",
    letter: Some('e'),
    aliases: &["explicit-euler", "forward-euler"],
    title: "explicit Euler",
    order: 1,
    default_control: Control::Step(0.0002),
    evaluations: 1,
    damped_evaluations: 1,
    view: View::Derivative,
    create: Create::RungeKutta(runge_kutta::EULER),
};

/// Heun's method, the explicit trapezoid:
/// f0 = f(t, y), f1 = f(t + h, y + h f0), y1 = y + h/2 (f0 + f1). Order 2.
pub(super) const HEUN: Method = Method {
    name: "trapezoid",
    letter: Some('t'),
    aliases: &["heun", "trapezoidal", "explicit-trapezoid"],
    title: "explicit trapezoid (Heun)",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 2,
    damped_evaluations: 2,
    view: View::Derivative,
    create: Create::RungeKutta(runge_kutta::HEUN),
};

/// Explicit midpoint: y1 = y + h f(t + h/2, y + h/2 f(t, y)). Order 2.
pub(super) const MIDPOINT: Method = Method {
    name: "midpoint",
    letter: Some('m'),
    aliases: &["explicit-midpoint"],
    title: "explicit midpoint",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 2,
    damped_evaluations: 2,
    view: View::Derivative,
    create: Create::RungeKutta(runge_kutta::MIDPOINT),
};

/// The classical Runge-Kutta method (Kutta 1901):
/// k1 = f(t, y), k2 = f(t + h/2, y + h/2 k1), k3 = f(t + h/2, y + h/2 k2), k4 = f(t + h, y + h k3),
/// y1 = y + h/6 (k1 + 2 k2 + 2 k3 + k4). Order 4.
pub(super) const RK4: Method = Method {
    name: "rk4",
    letter: Some('r'),
    aliases: &["runge-kutta", "runge-kutta-4"],
    title: "classical Runge-Kutta",
    order: 4,
    default_control: Control::Step(0.01),
    evaluations: 4,
    damped_evaluations: 4,
    view: View::Derivative,
    create: Create::RungeKutta(runge_kutta::RK4),
};
