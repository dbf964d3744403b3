//! Injected faults, with which tests check that no failure of the system loses a file or goes
//! unnoticed: in a build with debug assertions, `A3_FAULT=n` makes the n-th operation on the disk
//! and all later ones fail, as if the disk were full.

use std::io;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts an operation that can fail, and returns an error from the n-th on. It is called before
/// each such operation.
pub fn point() -> io::Result<()> {
    static FIRST: LazyLock<Option<u64>> = LazyLock::new(|| {
        let asked = std::env::var("A3_FAULT").ok()?;
        asked.parse().ok().filter(|_| cfg!(debug_assertions))
    });
    static COUNT: AtomicU64 = AtomicU64::new(0);
    match *FIRST {
        Some(first) if COUNT.fetch_add(1, Ordering::Relaxed) + 1 >= first => {
            Err(io::ErrorKind::StorageFull.into())
        }
        _ => Ok(()),
    }
}
