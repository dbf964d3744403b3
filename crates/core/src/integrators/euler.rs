//! Explicit Euler: y1 = y + h f(t, y). Order 1.

use super::method::{Create, Method, View};
use super::runge_kutta::{EULER, RungeKutta};
use crate::control::Control;

pub(super) const METHOD: Method = Method {
    name: "euler",
    letter: Some('e'),
    aliases: &["explicit-euler", "forward-euler"],
    title: "explicit Euler",
    order: 1,
    default_control: Control::Step(0.0002),
    evaluations: 1,
    damped_evaluations: 1,
    view: View::Derivative,
    create: Create::Table(|system| Box::new(RungeKutta::new(EULER, system))),
    trial: None,
};
