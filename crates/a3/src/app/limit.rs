//! How far a run's step is from the largest stable one, as it goes.

use std::time::{Duration, Instant};

use a3_core::stability::{LargestMode, Limit, Mode, largest_step, spectrum};
use a3_core::{Method, Simulation};

/// No look sooner than this after the last one ...
const INTERVAL: Duration = Duration::from_millis(250);
/// ... nor than so many times what that took: two percent of the time at most.
const IDLE: u32 = 50;

/// Looks at the fastest motion of a run every now and then.
#[derive(Default)]
pub struct LimitWatch {
    fastest: LargestMode,
    mode: Option<Mode>,
    limit: Option<Limit>,
    next: Option<Instant>,
}

impl LimitWatch {
    /// The limit of the run's method for the fastest motion, as it was when last looked at.
    pub fn limit(&self) -> Option<Limit> {
        self.limit
    }

    /// Looks again, if it is time, or if it must be now.
    pub fn look(&mut self, run: &Simulation, now: bool) {
        let begun = Instant::now();
        if !now && self.next.is_some_and(|next| begun < next) {
            return;
        }
        // What is left of a lost run is crumpled: the limit that counts is that of the scene.
        let y = if run.blow_up().is_some() {
            &run.scene().state
        } else {
            run.state()
        };
        let system = run.model().system();
        self.mode = match system.mechanics() {
            Some(mechanics) => {
                let (x, _) = y.split_at(y.len() / 2);
                self.fastest.estimate(mechanics, run.time(), x)
            }
            None => spectrum(system, run.time(), y).first().copied(),
        };
        self.ask(run.method());
        let after = Instant::now();
        self.next = Some(after + INTERVAL.max(IDLE * after.duration_since(begun)));
    }

    /// The limit of another method, for the motion that was seen last.
    pub fn ask(&mut self, method: &Method) {
        let modes = self.mode.as_slice();
        // No method of the table refuses a mode.
        self.limit = largest_step(method, modes).ok().flatten();
    }
}

/// The longest step of one digit that is within nine tenths of the limit.
pub fn would_hold(limit: f64) -> f64 {
    let most = 0.9 * limit;
    let unit = 10f64.powi(most.log10().floor() as i32);
    // As one would type it.
    let digits = (most / unit + 1e-9).floor() * unit;
    format!("{digits:.0e}").parse().unwrap_or(digits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{integrators, scenes};

    #[test]
    fn a_step_that_would_hold_is_short_and_within() {
        for (limit, expected) in [
            (0.0144, 0.01),
            (0.0349, 0.03),
            (0.000_392, 0.000_3),
            (0.1, 0.09),
        ] {
            assert_eq!(would_hold(limit), expected);
        }
    }

    #[test]
    fn the_limit_follows_the_method_and_the_cloth() {
        let scene = scenes::find("mit").unwrap().build(None).unwrap();
        let method = |name| integrators::find(name).unwrap();
        let mut run = Simulation::new(scene, method("rk4"), 0.01).unwrap();
        let mut watch = LimitWatch::default();
        assert_eq!(watch.limit(), None);
        watch.look(&run, false);
        let flat = watch.limit().unwrap().step;
        assert!((flat - 0.0349).abs() < 0.001, "{flat}");
        run.advance_to(1.5).unwrap();
        // Not yet time to look.
        watch.look(&run, false);
        assert_eq!(watch.limit().unwrap().step, flat);
        for _ in 0..8 {
            watch.look(&run, true);
        }
        let stretched = watch.limit().unwrap().step;
        assert!(
            stretched < 0.985 * flat && stretched > 0.9 * flat,
            "{stretched}"
        );
        watch.ask(method("implicit"));
        assert!(watch.limit().unwrap().step.is_infinite());
        watch.ask(method("trapezoid"));
        assert!(watch.limit().unwrap().step < 0.3 * flat);
    }
}
