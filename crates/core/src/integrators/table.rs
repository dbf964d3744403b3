//! The table of all methods, with the rows of those explicit Runge-Kutta methods in which each
//! stage depends only on the one before it.

use super::method::{Create, Method, View, find_own};
use super::{implicit, implicit_damping, kicks, nystrom_pairs, pairs, sweep, vbd, xpbd};
use crate::control::Control;

/// Table of all methods.
pub static METHODS: &[Method] = &[
    EULER,
    HEUN,
    MIDPOINT,
    RK4,
    kicks::SYMPLECTIC_EULER,
    kicks::VERLET,
    kicks::PEFRL,
    pairs::DORMAND_PRINCE,
    pairs::DOP853,
    implicit::EULER,
    pairs::RKF45,
    implicit::TR_BDF2,
    implicit::MIDPOINT,
    pairs::VERNER65,
    kicks::SRKN11,
    nystrom_pairs::DPRKN86,
    nystrom_pairs::DPRKN1210,
    implicit::BDF,
    xpbd::METHOD,
    xpbd::TEN,
    vbd::METHOD,
    implicit_damping::METHOD,
    implicit::RADAU,
];

/// Finds the method with this letter, name or alias: one of the table or, failing that, an own
/// method that was [registered](Method::register).
#[must_use]
pub fn find(name: &str) -> Option<&'static Method> {
    let of_table = METHODS.iter().find(|m| m.is_called(name));
    of_table.or_else(|| find_own(name))
}

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
    create: Create::RungeKutta(sweep::EULER),
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
    create: Create::RungeKutta(sweep::HEUN),
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
    create: Create::RungeKutta(sweep::MIDPOINT),
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
    create: Create::RungeKutta(sweep::RK4),
};

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn no_two_methods_share_a_name() {
        let mut seen = HashSet::new();
        for m in METHODS {
            for name in [m.name, &m.letter.unwrap().to_string()]
                .into_iter()
                .chain(m.aliases.iter().copied())
            {
                assert!(seen.insert(name.to_owned()), "{name} stands for two methods");
                assert!(std::ptr::eq(find(name).unwrap(), m));
            }
        }
        assert!(find("no such method").is_none());
    }
}
