//! Faults on request, by which tests see that no failure of the system loses a file or is passed
//! over: in a build with debug assertions, `A3_FAULT=n` makes the n-th operation and all later ones
//! fail, as on a disk that is full.

use std::io;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// `Ok` before every operation that can fail, unless a fault is requested by now.
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
