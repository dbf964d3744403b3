//! A long run, with a bar on the terminal once it takes long.

use std::cell::Cell;
use std::time::{Duration, Instant};

use a3_core::{Error, Simulation};
use indicatif::{ProgressBar, ProgressStyle};

/// Simulated time between two calls of `frame` (s).
const FRAME: f64 = 1.0 / 60.0;

/// Goes on to `until` (s) in whole steps, the last one shortened. Calls `frame` about sixty times a simulated second.
pub fn advance(
    simulation: &mut Simulation,
    until: f64,
    mut frame: impl FnMut(&Simulation),
) -> Result<(), Error> {
    let begun = Instant::now();
    let start = simulation.time();
    let mut bar: Option<ProgressBar> = None;
    let done = march(simulation, until, |simulation| {
        frame(simulation);
        if bar.is_none() && begun.elapsed() > Duration::from_secs(1) {
            bar = Some(new_bar());
        }
        if let Some(bar) = &bar {
            bar.set_position((1000.0 * (simulation.time() - start) / (until - start)) as u64);
        }
        true
    });
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    done.map(drop)
}

/// As [`advance`], without a bar, and only as long as `frame` says to go on. Whether it got there.
pub fn march(
    simulation: &mut Simulation,
    until: f64,
    mut frame: impl FnMut(&Simulation) -> bool,
) -> Result<bool, Error> {
    let control = simulation.control();
    let step = control.step().unwrap_or(FRAME);
    let stride = (FRAME / step).floor().max(1.0);
    loop {
        // Whole steps that end before the last one, which is whole too if only rounding says otherwise.
        let left = (until - simulation.time()) / step;
        let whole = (left - 1.0 - 1e-9).ceil().min(stride);
        if whole < 1.0 {
            break;
        }
        if control.step().is_none() {
            simulation.advance_to(simulation.time() + FRAME)?;
        } else {
            simulation.take_steps(whole as u64)?;
        }
        if !frame(simulation) {
            return Ok(false);
        }
    }
    simulation.advance_to(until)?;
    Ok(frame(simulation))
}

/// The bar of work that is measured in some unit, shown at once.
pub struct Bar {
    drawn: ProgressBar,
    expected: f64,
    done: Cell<f64>,
}

impl Bar {
    pub fn new(expected: f64) -> Self {
        let bar = new_bar();
        bar.enable_steady_tick(Duration::from_millis(250));
        Self {
            drawn: bar,
            expected,
            done: Cell::new(0.0),
        }
    }

    /// So much more is done.
    pub fn advance(&self, work: f64) {
        self.done.set(self.done.get() + work);
        self.drawn
            .set_position((1000.0 * self.done.get() / self.expected) as u64);
    }

    /// What is left is estimated from here on.
    pub fn start(&self) {
        self.drawn.reset_eta();
    }

    /// What is being done.
    pub fn say(&self, what: String) {
        self.drawn.set_message(what);
    }

    pub fn clear(&self) {
        self.drawn.finish_and_clear();
    }
}

/// Draws to stderr, and nothing at all where that is no terminal.
fn new_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg}{wide_bar} {percent:>3} %  {eta} left");
    ProgressBar::new(1000).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
