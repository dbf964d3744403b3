//! What the parts of a scene cost and change, as far as it was measured.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError};

use a3_core::{Control, Simulation};

/// Distance of the motion without a part from that with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Largest root mean square distance of the particles (m).
    pub distance: f64,
    /// Error of this distance (m).
    pub error: f64,
    /// Simulated time over which the motions were compared (s).
    pub time: f64,
}

/// What a part costs and changes; `None` where that could not be measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effect {
    /// Share of the computing time of the scene with the part.
    pub cost: Option<f64>,
    /// Change of the motion.
    pub change: Option<Deviation>,
}

/// What a measurement depends on, besides the state of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Situation {
    /// Index of the pane of the run.
    pub pane: usize,
    /// Values of the panel, and parts that are left out.
    pub tuned: Vec<(String, f64)>,
    pub method: &'static str,
    pub control: Control,
    /// Whether the wind blows, the pins swing, and surfaces touch.
    pub switches: [bool; 3],
    /// Number of pins.
    pub pins: usize,
}

/// Measurement on its own thread, which ends when this is dropped.
pub struct Job {
    effects: Receiver<(usize, Effect)>,
    ended: Arc<AtomicBool>,
}

/// Effects of the parts, as far as they are known.
#[derive(Default)]
pub struct Effects {
    known: Vec<Option<Effect>>,
    job: Option<Job>,
    /// Situation and simulated time (s) in which they were measured.
    at: Option<(Situation, f64)>,
}

impl Job {
    /// Creates the handle of a measurement: where it sends the effects of parts, by their indices,
    /// and what tells it to end.
    pub fn new(effects: Receiver<(usize, Effect)>, ended: Arc<AtomicBool>) -> Self {
        Self { effects, ended }
    }
}

impl Drop for Job {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}

impl Situation {
    /// Returns the situation of the run of a pane, with these values of the panel.
    pub fn of(pane: usize, run: &Simulation, tuned: Vec<(String, f64)>) -> Self {
        let network = run.model().network();
        Self {
            pane,
            tuned,
            method: run.method().name,
            control: run.control(),
            switches: [run.windy(), run.swinging(), run.touching()],
            pins: network.map_or(0, |network| network.pins().count()),
        }
    }
}

impl Effects {
    /// Returns the effect of a part, if it was measured.
    pub fn of(&self, part: usize) -> Option<Effect> {
        self.known.get(part).copied().flatten()
    }

    /// Returns the simulated time (s) from which the effects were measured, if they were.
    pub fn time(&self) -> Option<f64> {
        self.at.as_ref().map(|(_, time)| *time)
    }

    /// Returns the pane whose run the effects were measured in, if they were.
    pub fn pane(&self) -> Option<usize> {
        self.at.as_ref().map(|(situation, _)| situation.pane)
    }

    /// Returns the numbers of parts that are measured and of all parts, while they are measured.
    pub fn progress(&self) -> Option<[usize; 2]> {
        let done = self.known.iter().flatten().count();
        self.job.is_some().then_some([done, self.known.len()])
    }

    /// Starts to collect the effects of parts, which are measured in a situation from a simulated
    /// time (s) on.
    pub fn begin(&mut self, parts: usize, job: Job, at: (Situation, f64)) {
        *self = Self {
            known: vec![None; parts],
            job: Some(job),
            at: Some(at),
        };
    }

    /// Forgets the effects, and ends their measurement.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Collects new effects. Forgets all if the situation is another, or if the run is at an
    /// earlier time (s) than when they were measured.
    pub fn update(&mut self, situation: &Situation, time: f64) {
        let Some((measured, from)) = &self.at else {
            return;
        };
        if time < *from || situation != measured {
            return self.forget();
        }
        while let Some(job) = &self.job {
            match job.effects.try_recv() {
                Ok((part, effect)) => self.known[part] = Some(effect),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => self.job = None,
            }
        }
    }

    /// Shows these effects of all parts.
    #[cfg(test)]
    pub fn show(&mut self, effects: &[Effect]) {
        self.known = effects.iter().copied().map(Some).collect();
    }
}
