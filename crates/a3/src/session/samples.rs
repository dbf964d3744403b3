//! What a run did in the last seconds, for the plots.

use std::collections::VecDeque;

use a3_core::{Energy, Simulation};

/// Simulated time that is remembered (s).
pub const SPAN: f64 = 20.0;
/// From one sample to the next (s), at least: a little less than a tenth, so that ten a second stay ten.
const APART: f64 = 0.09;

/// A run at one time.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// In s.
    pub time: f64,
    pub energy: Option<Energy>,
    /// The largest length over rest length.
    pub stretch: Option<f64>,
    /// Since the sample before, per simulated second: evaluations, and computing (ms).
    pub cost: Option<[f64; 2]>,
    /// Evaluations and computing (s) so far.
    total: [f64; 2],
}

/// Samples in the order of their times.
#[derive(Default)]
pub struct History {
    samples: VecDeque<Sample>,
}

impl History {
    /// Remembers the run as it is, if it is time. What it had not done yet is forgotten: time may go back.
    pub fn take(
        &mut self,
        run: &Simulation,
        energy: Option<Energy>,
        stretch: Option<f64>,
        computing: f64,
    ) {
        let time = run.time();
        while self.samples.back().is_some_and(|last| last.time > time) {
            self.samples.pop_back();
        }
        let before = self.samples.back();
        if before.is_some_and(|last| time - last.time < APART) {
            return;
        }
        let total = [run.work().total(), computing];
        let cost = before.map(|last| {
            let elapsed = time - last.time;
            [
                (total[0] - last.total[0]) / elapsed,
                1e3 * (total[1] - last.total[1]) / elapsed,
            ]
        });
        self.samples.push_back(Sample {
            time,
            energy,
            stretch,
            cost: cost.filter(|[evaluations, _]| *evaluations >= 0.0),
            total,
        });
        while self.samples[0].time < time - SPAN {
            self.samples.pop_front();
        }
    }

    pub fn clear(&mut self) {
        self.samples.clear();
    }

    pub fn samples(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, integrators};

    #[test]
    fn twenty_seconds_are_remembered_ten_times_a_second() {
        let scene = a3_scenes::find("pendulum").unwrap().build(None).unwrap();
        let mut run =
            Simulation::new(scene, integrators::find("r").unwrap(), Control::Step(0.01)).unwrap();
        let mut history = History::default();
        let mut computing = 0.0;
        for _ in 0..600 {
            run.take_steps(5).unwrap();
            computing += 0.001;
            history.take(&run, run.energy(), run.largest_stretch(), computing);
        }
        let samples: Vec<_> = history.samples().copied().collect();
        assert!((200..=202).contains(&samples.len()), "{}", samples.len());
        for pair in samples.windows(2) {
            assert!((pair[1].time - pair[0].time - 0.1).abs() < 1e-9);
            let [evaluations, computing] = pair[1].cost.unwrap();
            assert!((evaluations - 400.0).abs() < 1e-6 && (computing - 20.0).abs() < 1e-6);
        }
        assert!(samples[0].time >= 29.9 - SPAN && samples[0].energy.is_some());
        // From the beginning again.
        run.reset();
        history.take(&run, run.energy(), None, computing);
        assert_eq!(history.samples().count(), 1);
    }
}
