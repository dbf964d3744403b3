//! Requests to end, as signals: Ctrl-C (SIGINT), SIGTERM, and SIGHUP when the terminal is closed. A
//! command that listens comes to an end of its own, with what it has; every other, and one that
//! goes on computing, ends within a second. No unfinished file stays.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Time after a request in which a command has to stop computing, before it is ended at once.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time for the last message, which nobody may read.
const LAST_WORDS: Duration = Duration::from_millis(200);
/// SIGINT, for systems without signals.
const INTERRUPT: u8 = 2;

/// The signal that was last received, or 0.
static SIGNAL: AtomicU8 = AtomicU8::new(0);
/// Whether the command comes to an end of its own.
static LISTENING: AtomicBool = AtomicBool::new(false);
/// Whether the command computes no more, and only writes what it has.
static WRITING: AtomicBool = AtomicBool::new(false);
/// What must not outlive the program.
static LOOSE: Mutex<Vec<Loose>> = Mutex::new(vec![]);

/// Receives signals from now on, in a thread of its own. All threads that are started later leave
/// them to it.
#[cfg(unix)]
pub fn start() {
    use nix::sys::signal::{SigSet, Signal};
    let mut ends: SigSet = [Signal::SIGINT, Signal::SIGTERM].into_iter().collect();
    if !hangups_are_ignored() {
        ends.add(Signal::SIGHUP);
    }
    // At the limit for the size of files, the write shall fail, and not the program.
    let _ = SigSet::from(Signal::SIGXFSZ).thread_block();
    let _ = ends.thread_block();
    let wait = move || {
        while let Ok(signal) = ends.wait() {
            request(signal as u8);
        }
    };
    if thread::Builder::new().spawn(wait).is_err() {
        // Each signal then ends the program as systems do.
        let _ = ends.thread_unblock();
    }
}

/// Receives Ctrl-C from now on.
#[cfg(not(unix))]
pub fn start() {
    // Where no handler can be set, Ctrl-C ends the program as systems do.
    let _ = ctrlc::set_handler(|| request(INTERRUPT));
}

/// Whether the program was started by `nohup`, to go on when the terminal is closed.
#[cfg(unix)]
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 1 == 1)
}

/// Makes the first signal a request, from now on.
pub fn listen() {
    LISTENING.store(true, Ordering::SeqCst);
}

/// Whether no end has been requested.
pub fn go_on() -> bool {
    SIGNAL.load(Ordering::SeqCst) == 0
}

/// Lets a command of which an end was requested write what it has, however long that takes.
pub fn write_on() {
    WRITING.store(!go_on(), Ordering::SeqCst);
}

/// Exit code of a program that was ended by a signal, as shells have it.
pub fn exit_code() -> u8 {
    match SIGNAL.load(Ordering::SeqCst) {
        0 => 128 + INTERRUPT,
        signal => 128 + signal,
    }
}

/// Does what a signal asks for.
fn request(signal: u8) {
    let first = SIGNAL.swap(signal, Ordering::SeqCst) == 0;
    if !first || !LISTENING.load(Ordering::SeqCst) {
        end();
    }
    thread::spawn(|| {
        thread::sleep(PATIENCE);
        if !WRITING.load(Ordering::SeqCst) {
            end();
        }
    });
}

/// Ends the program at once.
fn end() -> ! {
    // Nothing is begun any more: the list is never given back.
    let loose = loose();
    for loose in loose.iter().rev() {
        loose.undo();
    }
    let words =
        thread::spawn(|| writeln!(io::stderr(), "interrupted: no unfinished file was kept"));
    let begun = Instant::now();
    while !words.is_finished() && begun.elapsed() < LAST_WORDS {
        thread::sleep(Duration::from_millis(1));
    }
    // Drivers of the GPU that are at work in other threads would crash in their exit handlers.
    #[cfg(all(unix, feature = "window"))]
    signal_hook::low_level::exit(i32::from(exit_code()));
    #[cfg(not(all(unix, feature = "window")))]
    std::process::exit(i32::from(exit_code()))
}

/// Something that must not outlive the program.
#[derive(Clone, PartialEq)]
pub enum Loose {
    /// A temporary file.
    File(PathBuf),
    /// Another program that writes one, by the number of its process.
    Program(u32),
}

impl Loose {
    /// Removes it, as far as that can be done.
    fn undo(&self) {
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

fn loose() -> MutexGuard<'static, Vec<Loose>> {
    LOOSE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Something loose that is removed if the program ends at once while this value exists.
pub struct Temporary(Loose);

/// Creates a temporary file and registers it for clean-up, with signals held back in between.
pub fn temporary<T>(
    make: impl FnOnce() -> io::Result<T>,
    part: impl FnOnce(&T) -> Loose,
) -> io::Result<(T, Temporary)> {
    let mut loose = loose();
    let made = make()?;
    let part = part(&made);
    loose.push(part.clone());
    Ok((made, Temporary(part)))
}

impl Drop for Temporary {
    fn drop(&mut self) {
        loose().retain(|loose| *loose != self.0);
    }
}
