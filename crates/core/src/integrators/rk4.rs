//! The classical Runge-Kutta method (Kutta 1901):
//! k1 = f(t, y), k2 = f(t + h/2, y + h/2 k1), k3 = f(t + h/2, y + h/2 k2), k4 = f(t + h, y + h k3),
//! y1 = y + h/6 (k1 + 2 k2 + 2 k3 + k4). Order 4.

use super::method::{Create, Method, View};
use super::runge_kutta::{RK4, RungeKutta};
use crate::control::Control;

pub(super) const METHOD: Method = Method {
    name: "rk4",
    letter: Some('r'),
    aliases: &["runge-kutta", "runge-kutta-4"],
    title: "classical Runge-Kutta",
    order: 4,
    default_control: Control::Step(0.01),
    evaluations: 4,
    damped_evaluations: 4,
    view: View::Derivative,
    create: Create::Table(|system| Box::new(RungeKutta::new(RK4, system))),
    trial: None,
};
