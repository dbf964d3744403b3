//! Heun's method, the explicit trapezoid:
//! f0 = f(t, y), f1 = f(t + h, y + h f0), y1 = y + h/2 (f0 + f1). Order 2.

use super::method::{Create, Method, View};
use super::runge_kutta::{HEUN, RungeKutta};
use crate::control::Control;

pub(super) const METHOD: Method = Method {
    name: "trapezoid",
    letter: Some('t'),
    aliases: &["heun", "trapezoidal", "explicit-trapezoid"],
    title: "explicit trapezoid (Heun)",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 2,
    damped_evaluations: 2,
    view: View::Derivative,
    create: Create::Table(|system| Box::new(RungeKutta::new(HEUN, system))),
    trial: None,
};
