//! Progress bars on the terminal.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::{interrupt, terminal};
use crate::failure::Failure;
use crate::monitor::Monitor;

/// The bar of a run, which is shown once it takes longer than a second.
pub struct RunBar {
    begun: Instant,
    bar: Option<ProgressBar>,
}

impl RunBar {
    /// Creates the bar of a run that begins now.
    pub fn begin() -> Self {
        Self { begun: Instant::now(), bar: None }
    }

    /// Shows the share of the run that is done.
    pub fn show(&mut self, share: f64) {
        if self.bar.is_none() && self.begun.elapsed() > Duration::from_secs(1) {
            self.bar = Some(new_bar());
        }
        if let Some(bar) = &self.bar {
            bar.set_position((1000.0 * share) as u64);
        }
    }

    /// Removes the bar.
    pub fn clear(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A bar that is shown at once, for work in any unit. Several threads may advance it.
pub struct Bar(ProgressBar);

impl Bar {
    /// Creates a bar for an expected amount of work, and tells the notes on it.
    pub fn new(expected: f64) -> Self {
        terminal::tell_notes();
        let bar = new_bar();
        bar.enable_steady_tick(Duration::from_millis(250));
        let bar = Self(bar);
        bar.expect(expected);
        bar
    }

    /// Adds work that was done.
    pub fn advance(&self, work: f64) {
        self.0.inc(to_units(work));
    }

    /// Starts again at zero, with a new amount of expected work.
    pub fn expect(&self, work: f64) {
        self.0.set_length(to_units(work));
        self.0.set_position(0);
    }

    /// Removes the bar from the terminal while something else is written.
    pub fn pause<T>(&self, write: impl FnOnce() -> T) -> T {
        self.0.suspend(write)
    }

    /// Writes a warning to stderr.
    pub fn warn(&self, line: &str) {
        self.pause(|| terminal::warn(line));
    }

    /// Starts the estimate of the remaining time again.
    pub fn start(&self) {
        self.0.reset_eta();
    }

    /// Shows a text before the bar.
    pub fn say(&self, what: &str) {
        self.0.set_message(terminal::visible(what));
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}

/// The work goes on until a signal.
impl Monitor for Bar {
    fn go_on(&self) -> bool {
        interrupt::go_on()
    }

    fn stage(&self, what: &str) {
        self.say(&format!("{what:<10} "));
    }

    fn expect(&self, work: f64) {
        self.expect(work);
    }

    fn start(&self) {
        self.start();
    }

    fn advance(&self, work: f64) {
        self.advance(work);
    }

    fn clear(&self) {
        self.clear();
    }

    fn warn(&self, line: &str) {
        self.warn(line);
    }

    fn note(&self, line: &str) -> Result<(), Failure> {
        self.pause(|| terminal::say(&format!("{line}\n")))
    }
}

/// Converts work to the integer units of a bar, millionths.
fn to_units(work: f64) -> u64 {
    (1e6 * work) as u64
}

/// Creates a bar on stderr. If that is no terminal, nothing is drawn.
fn new_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg}{wide_bar} {percent:>3} %  {eta} left");
    ProgressBar::new(1000).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
