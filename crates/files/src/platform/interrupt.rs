//! Signals that end the program: Ctrl-C (SIGINT), SIGTERM, and SIGHUP when the terminal is closed.
//! A command that listens stops by itself and writes its results so far; any other command, and one
//! that continues to compute, is ended within a second. No unfinished file stays.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Time after a signal in which a command has to stop computing, before it is ended at once.
const GRACE_PERIOD: Duration = Duration::from_millis(500);
/// Longest time to wait for the last message to be written: a blocked reader must not delay the
/// end.
const MESSAGE_TIMEOUT: Duration = Duration::from_millis(200);
/// SIGINT, for systems without signals.
const INTERRUPT: u8 = 2;

/// The signal that was last received, or 0.
static SIGNAL: AtomicU8 = AtomicU8::new(0);
/// Whether the command stops by itself after a signal.
static LISTENING: AtomicBool = AtomicBool::new(false);
/// Whether the command has stopped computing, and only writes its results.
static WRITING: AtomicBool = AtomicBool::new(false);
/// Temporary files and child processes that must not outlive the program.
static CLEANUPS: Mutex<Vec<Cleanup>> = Mutex::new(vec![]);

/// Starts a thread that receives the signals. Threads that are started later inherit the mask that
/// blocks them.
#[cfg(unix)]
pub fn start() {
    use nix::sys::signal::{SigSet, Signal};
    let mut ends: SigSet = [Signal::SIGINT, Signal::SIGTERM].into_iter().collect();
    if !hangups_are_ignored() {
        ends.add(Signal::SIGHUP);
    }
    // At the limit for the size of files, only the write shall fail, not the program.
    let _ = SigSet::from(Signal::SIGXFSZ).thread_block();
    let _ = ends.thread_block();
    let wait = move || {
        while let Ok(signal) = ends.wait() {
            on_signal(signal as u8);
        }
    };
    if thread::Builder::new().spawn(wait).is_err() {
        // Each signal then has its default effect: it ends the program.
        let _ = ends.thread_unblock();
    }
}

/// Sets a handler for Ctrl-C.
#[cfg(not(unix))]
pub fn start() {
    // Where no handler can be set, Ctrl-C has its default effect: it ends the program.
    let _ = ctrlc::set_handler(|| on_signal(INTERRUPT));
}

/// Returns whether SIGHUP is ignored, as after `nohup`, so that the program continues when the
/// terminal is closed.
#[cfg(unix)]
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 1 == 1)
}

/// Declares that the command stops by itself after the first signal.
pub fn listen() {
    LISTENING.store(true, Ordering::SeqCst);
}

/// Returns whether no signal has been received.
pub fn go_on() -> bool {
    SIGNAL.load(Ordering::SeqCst) == 0
}

/// Declares that a command that was interrupted has stopped computing: it may take any time to
/// write its results.
pub fn write_on() {
    WRITING.store(!go_on(), Ordering::SeqCst);
}

/// Returns the exit code of a program that was ended by a signal, as shells define it.
pub fn exit_code() -> u8 {
    match SIGNAL.load(Ordering::SeqCst) {
        0 => 128 + INTERRUPT,
        signal => 128 + signal,
    }
}

/// Ends the program, or gives a command that listens some time to stop by itself.
fn on_signal(signal: u8) {
    let first = SIGNAL.swap(signal, Ordering::SeqCst) == 0;
    if !first || !LISTENING.load(Ordering::SeqCst) {
        end();
    }
    thread::spawn(|| {
        thread::sleep(GRACE_PERIOD);
        if !WRITING.load(Ordering::SeqCst) {
            end();
        }
    });
}

/// Ends the program at once.
fn end() -> ! {
    // The lock is never released, so no temporary file can be created any more.
    let cleanups = cleanups();
    for cleanup in cleanups.iter().rev() {
        cleanup.run();
    }
    let said = last_words(&cleanups);
    let words = thread::spawn(move || writeln!(io::stderr(), "{said}"));
    let begun = Instant::now();
    while !words.is_finished() && begun.elapsed() < MESSAGE_TIMEOUT {
        thread::sleep(Duration::from_millis(1));
    }
    // Drivers of the GPU that are at work in other threads would crash in their exit handlers.
    #[cfg(unix)]
    signal_hook::low_level::exit(i32::from(exit_code()));
    #[cfg(not(unix))]
    std::process::exit(i32::from(exit_code()))
}

/// Returns the message of a program that ends after these cleanups.
fn last_words(cleanups: &[Cleanup]) -> &'static str {
    if cleanups.is_empty() { "interrupted" } else { "interrupted: no unfinished file was kept" }
}

/// A temporary file or child process that must not outlive the program.
#[derive(Clone, PartialEq)]
pub enum Cleanup {
    /// A temporary file.
    File(PathBuf),
    /// Another program that writes a file, by its process id.
    Program(u32),
}

impl Cleanup {
    /// Removes the file or kills the program; errors are ignored.
    fn run(&self) {
        match self {
            Self::File(path) => {
                let _ = std::fs::remove_file(path);
            }
            #[cfg(unix)]
            Self::Program(process) => {
                use nix::{sys, unistd::Pid};
                let process = Pid::from_raw(*process as i32);
                let _ = sys::signal::kill(process, sys::signal::SIGKILL);
                let _ = sys::wait::waitpid(process, None);
            }
            #[cfg(not(unix))]
            Self::Program(_) => {}
        }
    }
}

fn cleanups() -> MutexGuard<'static, Vec<Cleanup>> {
    CLEANUPS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Registration of a temporary file or child process, which is removed if the program ends at once
/// while this value exists.
pub struct Temporary(Cleanup);

/// Creates a temporary file and registers it for clean-up, with signals held back in between.
pub fn temporary<T>(
    make: impl FnOnce() -> io::Result<T>,
    part: impl FnOnce(&T) -> Cleanup,
) -> io::Result<(T, Temporary)> {
    let mut cleanups = cleanups();
    let made = make()?;
    let part = part(&made);
    cleanups.push(part.clone());
    Ok((made, Temporary(part)))
}

impl Drop for Temporary {
    fn drop(&mut self) {
        cleanups().retain(|cleanup| *cleanup != self.0);
    }
}
