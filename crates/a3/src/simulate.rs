//! `a3 simulate`: the final state of a run, or all its frames, in files that other programs read.

use std::path::Path;
use std::time::Instant;

use a3_core::Simulation;
use serde::Serialize;

use crate::cli::Simulate;
use crate::failure::Failure;
use crate::frames::Sequence;
use crate::progress::{self, Bar};
use crate::{export, interrupt, output, setup};

/// Summary of a run.
#[derive(Serialize)]
struct Summary {
    scene: String,
    solver: &'static str,
    frames: usize,
    /// Simulated time (s).
    time: f64,
    steps: u64,
    evaluations: u64,
    /// Total energy; none for a system without forces.
    energy: Option<Energy>,
    /// Largest length over rest length of a spring; none without springs.
    largest_stretch: Option<f64>,
    /// Number of springs that broke.
    torn: usize,
    /// What the guard of surfaces did; none where surfaces do not touch.
    contact: Option<Contact>,
    /// Real time (s).
    wall_time: f64,
}

/// What the guard of surfaces did.
#[derive(Serialize)]
struct Contact {
    /// Number of impulses.
    impulses: usize,
    /// Number of vertices whose way was cut.
    cuts: usize,
    /// Momentum that cuts took (N s).
    momentum_lost: f64,
}

impl Contact {
    fn of(simulation: &Simulation) -> Option<Self> {
        simulation.model().network()?.contact_layer()?;
        let guarded = simulation.guarded();
        Some(Self {
            impulses: guarded.impulses,
            cuts: guarded.cuts,
            momentum_lost: guarded.lost,
        })
    }
}

/// Total energy (J).
#[derive(Clone, Copy, Serialize)]
struct Energy {
    begin: f64,
    end: f64,
    /// Largest distance from the energy at the beginning.
    largest_drift: f64,
}

/// Energy and stretch on the way, for the summary.
#[derive(Default)]
struct Extremes {
    energy: Option<Energy>,
    stretch: Option<f64>,
}

impl Extremes {
    /// Takes the values of the state as it is now.
    fn look(&mut self, simulation: &Simulation) {
        if let Some(total) = simulation.energy().map(|energy| energy.total()) {
            let energy = self.energy.get_or_insert(Energy {
                begin: total,
                end: total,
                largest_drift: 0.0,
            });
            energy.end = total;
            energy.largest_drift = energy.largest_drift.max((total - energy.begin).abs());
        }
        if let Some(stretch) = simulation.largest_stretch() {
            self.stretch = Some(self.stretch.map_or(stretch, |most| most.max(stretch)));
        }
    }
}

/// Runs the simulation and writes its files.
pub fn run(options: &Simulate) -> Result<(), Failure> {
    let begun = Instant::now();
    let (mut simulation, presentation) = setup::simulation(&options.run)?;
    let stdout = Path::new("-");
    if let Some(path) = options.summary.as_deref() {
        if path == stdout && options.output == stdout {
            return Err(Failure::usage(
                "standard output can take either --output or --summary, not both",
            ));
        }
        if path != stdout {
            output::check(path, &["json"])?;
        }
    }
    let (frames, mut export) = export::begin(options, &simulation, &presentation)?;
    let mut extremes = options.summary.is_some().then(Extremes::default);
    if let Some(extremes) = &mut extremes {
        extremes.look(&simulation);
    }
    interrupt::listen();
    let bar = Bar::new(options.run.end()?);
    let mut crossed = check(&simulation, options.check);
    for (k, time) in frames.times().enumerate() {
        let mut before = simulation.time();
        let reached = progress::march(&mut simulation, time, |simulation| {
            if let Some(extremes) = &mut extremes {
                extremes.look(simulation);
            }
            bar.advance(simulation.time() - before);
            before = simulation.time();
            if crossed.is_ok() {
                crossed = check(simulation, options.check);
            }
            crossed.is_ok() && interrupt::go_on()
        });
        if reached != Ok(true) {
            bar.clear();
        }
        let kept = || kept(&options.output, k, frames.count);
        match reached {
            Ok(true) => {}
            Ok(false) if crossed.is_err() => {
                let why = crossed.err().unwrap_or_default();
                return Err(Failure::run(format!("{why}; {}", kept())));
            }
            Ok(false) => return Err(Failure::Interrupted(format!("interrupted: {}", kept()))),
            Err(error) if k > 0 => return Err(Failure::run(format!("{error}; {}", kept()))),
            Err(error) => return Err(Failure::run(error)),
        }
        export.add(&simulation)?;
    }
    bar.clear();
    export.finish()?;
    let one_mesh = |ending: &&str| output::ends_in(&options.output, ending);
    if simulation.tears() > 0 && ["pc2", "glb"].iter().any(one_mesh) {
        output::warn(&format!(
            "{} springs broke, but {} has one mesh for all its frames: a sequence such as torn-####.obj has the holes",
            simulation.tears(),
            options.output.display()
        ));
    }
    let (Some(path), Some(extremes)) = (&options.summary, extremes) else {
        return Ok(());
    };
    let summary = Summary {
        scene: simulation.scene().name.clone(),
        solver: simulation.method().name,
        frames: frames.count,
        time: simulation.time(),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: extremes.energy,
        largest_stretch: extremes.stretch,
        torn: simulation.tears(),
        contact: Contact::of(&simulation),
        wall_time: begun.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::run)? + "\n";
    if path == stdout {
        output::send(&text)
    } else {
        output::write(path, text.as_bytes())
    }
}

/// `Ok` if no surfaces pass through one another, or none shall be looked for; else what does.
fn check(simulation: &Simulation, wanted: bool) -> Result<(), String> {
    let Some(network) = simulation.model().network().filter(|_| wanted) else {
        return Ok(());
    };
    let state = simulation.state();
    let apart = network.check_apart(simulation.time(), &state[..state.len() / 2]);
    apart.map_err(|why| format!("at t = {:.4} s {why}", simulation.time()))
}

/// What an interrupted run has written: a file is complete or absent, and so is each file of a
/// sequence.
fn kept(path: &Path, done: usize, count: usize) -> String {
    if Sequence::of(path).is_some() && done > 0 {
        format!("{} has the first {done} of {count} frames", path.display())
    } else {
        "nothing was written".into()
    }
}
