//! The table of all methods.

use super::method::Method;
use super::registry;
use super::{
    dop853, dormand_prince, dprkn86, dprkn1210, euler, heun, implicit, implicit_damping, midpoint,
    pefrl, rk4, rkf45,
};
use super::{srkn11, symplectic_euler, vbd, verlet, verner65, xpbd};

/// Table of all methods.
pub static METHODS: &[Method] = &[
    euler::METHOD,
    heun::METHOD,
    midpoint::METHOD,
    rk4::METHOD,
    symplectic_euler::METHOD,
    verlet::METHOD,
    pefrl::METHOD,
    dormand_prince::METHOD,
    dop853::METHOD,
    implicit::EULER,
    rkf45::METHOD,
    implicit::TR_BDF2,
    implicit::MIDPOINT,
    verner65::METHOD,
    srkn11::METHOD,
    dprkn86::METHOD,
    dprkn1210::METHOD,
    implicit::BDF,
    xpbd::METHOD,
    xpbd::TEN,
    vbd::METHOD,
    implicit_damping::METHOD,
];

/// Finds the method with this letter, name or alias: one of the table or, failing that, an own
/// method that was [registered](Method::register).
#[must_use]
pub fn find(name: &str) -> Option<&'static Method> {
    let of_table = METHODS.iter().find(|m| m.is_called(name));
    of_table.or_else(|| registry::find(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_methods_share_a_name() {
        let mut seen = HashSet::new();
        for m in METHODS {
            for name in [m.name, &m.letter.unwrap().to_string()]
                .into_iter()
                .chain(m.aliases.iter().copied())
            {
                assert!(
                    seen.insert(name.to_owned()),
                    "{name} stands for two methods"
                );
                assert!(std::ptr::eq(find(name).unwrap(), m));
            }
        }
        assert!(find("no such method").is_none());
    }
}
