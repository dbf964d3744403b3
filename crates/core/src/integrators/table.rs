//! The table of all methods.

use super::method::Method;
use super::registry;
use super::{explicit, implicit, implicit_damping, kicks, nystrom_pairs, pairs, vbd, xpbd};

/// Table of all methods.
pub static METHODS: &[Method] = &[
    explicit::EULER,
    explicit::HEUN,
    explicit::MIDPOINT,
    explicit::RK4,
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
