//! The own methods that are found by their names, beside those of the table.

use std::sync::{PoisonError, RwLock};

use super::method::Method;

/// Own methods, in the order in which they were added.
static OWN: RwLock<Vec<&'static Method>> = RwLock::new(vec![]);

/// Adds an own method. If another one has its name, the new one takes its place.
pub(super) fn add(method: &'static Method) {
    let mut own = OWN.write().unwrap_or_else(PoisonError::into_inner);
    own.retain(|other| *other != method);
    own.push(method);
}

/// Returns the own method with this name, if there is one.
pub(super) fn find(name: &str) -> Option<&'static Method> {
    let own = OWN.read().unwrap_or_else(PoisonError::into_inner);
    own.iter().copied().find(|method| method.name == name)
}
