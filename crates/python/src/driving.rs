//! Runs on their way: without the global lock, with looks for Ctrl-C and reports of progress.

use std::time::{Duration, Instant};

use a3_core::{Error, Simulation};
use a3_files::bounds::OWN_HORIZONS;
use a3_files::{progress, verdict};
use pyo3::prelude::*;

use super::errors::of_error;
use super::function::Raised;

/// Time between two looks for Ctrl-C and two reports of progress.
const REPORT_PERIOD: Duration = Duration::from_millis(50);
/// Largest number of steps between two looks at the clock.
const MAX_CHUNK: u64 = 1024;

/// Function that returns whether a run may go on.
pub type GoOn<'a> = &'a mut (dyn FnMut(&Simulation) -> bool + Send);
/// The end of the way, or an error with its message.
pub type Driven = Result<(), Box<(Error, String)>>;

/// Runs `work` on a simulation without the global lock. Exceptions of its functions are kept in
/// `raised`; one of them is raised if it ended the work.
pub fn drive(
    py: Python<'_>,
    simulation: &mut Simulation,
    raised: &[Raised],
    progress: Option<&Bound<PyAny>>,
    work: impl Send + FnOnce(&mut Simulation, GoOn) -> Driven,
) -> PyResult<()> {
    for raised in raised {
        raised.take();
    }
    let progress = progress.map(|progress| progress.clone().unbind());
    let (mut stopped, mut last) = (None, Instant::now());
    let done = py.detach(|| {
        let mut go_on = |run: &Simulation| {
            if last.elapsed() < REPORT_PERIOD {
                return true;
            }
            last = Instant::now();
            let looked = Python::attach(|py| {
                if let Some(progress) = &progress {
                    progress.call1(py, (run.time(),))?;
                }
                py.check_signals()
            });
            stopped = looked.err();
            stopped.is_none()
        };
        work(simulation, &mut go_on)
    });
    if let Some(stopped) = stopped {
        return Err(stopped);
    }
    done.map_err(|failed| {
        let (error, message) = *failed;
        let raised = match error {
            Error::Callback(_) => raised.iter().find_map(Raised::take),
            _ => None,
        };
        raised.unwrap_or_else(|| of_error(py, &error, message))
    })
}

/// Takes steps, and looks at the clock after more and more of them.
pub fn take_steps(run: &mut Simulation, count: u64, go_on: GoOn) -> Driven {
    let (mut left, mut chunk) = (count, 1);
    while left > 0 {
        let taken = run.take_steps(chunk.min(left));
        taken.map_err(|error| Box::new((error.clone(), error.to_string())))?;
        left -= chunk.min(left);
        if left > 0 && !go_on(run) {
            break;
        }
        chunk = (2 * chunk).min(MAX_CHUNK);
    }
    Ok(())
}

/// Advances to a time (s). If the run blows up, the message has advice, unless the run `calls`
/// functions of Python: a search for a step that holds would call them too often.
pub fn advance(run: &mut Simulation, time: f64, calls: bool, go_on: GoOn) -> Driven {
    let gone = progress::march(run, time, go_on);
    let gone = gone.and_then(|arrived| if arrived { run.conclude() } else { Ok(()) });
    gone.map_err(|error| {
        let message = if calls {
            error.to_string()
        } else {
            verdict::lost(run, &error, "", time).to_string()
        };
        Box::new((error, message))
    })
}

/// Checks that a run can advance to a time (s).
pub fn check_time(run: &Simulation, time: f64) -> Result<(), String> {
    let now = run.time();
    let own = *OWN_HORIZONS.range.end();
    let most = run.model().network().map_or(own, |_| 1e9);
    if !(0.0..=most).contains(&time) {
        return Err(format!(
            "a time is a number of seconds from 0 to {most:e}, such as 10, not {time}"
        ));
    }
    if time < now {
        return Err(format!(
            "the run is at t = {now} s already, past {time} s: reset() goes back to its beginning"
        ));
    }
    Ok(())
}
