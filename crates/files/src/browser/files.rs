//! The files of a page: those that were dropped on it, and those that it wrote.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

thread_local! {
    static FILES: RefCell<BTreeMap<PathBuf, Vec<u8>>> = const { RefCell::new(BTreeMap::new()) };
}

/// Stores a file, in place of one of the same name.
pub fn keep(path: &Path, bytes: &[u8]) {
    FILES.with_borrow_mut(|files| files.insert(path.into(), bytes.into()));
}

/// Returns the bytes of a file, if there is one.
pub fn read(path: &Path) -> Option<Vec<u8>> {
    FILES.with_borrow(|files| files.get(path).cloned())
}
