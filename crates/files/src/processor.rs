//! Processor time.

use std::time::Duration;

/// Returns the processor time that the program has used so far.
#[cfg(unix)]
pub fn time() -> Duration {
    let told = nix::time::clock_gettime(nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID);
    told.map_or(Duration::ZERO, Duration::from)
}

/// Returns the real time since the first call, where the system does not tell processor time.
#[cfg(not(unix))]
pub fn time() -> Duration {
    use std::sync::OnceLock;
    static FIRST: OnceLock<web_time::Instant> = OnceLock::new();
    FIRST.get_or_init(web_time::Instant::now).elapsed()
}
