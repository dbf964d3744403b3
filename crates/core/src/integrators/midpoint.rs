//! Explicit midpoint: y1 = y + h f(t + h/2, y + h/2 f(t, y)). Order 2.

use super::method::{Create, Method, View};
use super::runge_kutta::{MIDPOINT, RungeKutta};
use crate::control::Control;

pub(super) const METHOD: Method = Method {
    name: "midpoint",
    letter: Some('m'),
    aliases: &["explicit-midpoint"],
    title: "explicit midpoint",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 2,
    damped_evaluations: 2,
    view: View::Derivative,
    create: Create::Table(|system| Box::new(RungeKutta::new(MIDPOINT, system))),
    trial: None,
};
