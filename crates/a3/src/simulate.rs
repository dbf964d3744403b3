//! `a3 simulate`: the final state of a run, or all its frames, in files that other programs read.

use std::path::Path;
use std::time::{Duration, Instant};

use a3_core::Simulation;
use serde::Serialize;

use crate::checkpoint::{Keeper, Kept};
use crate::cli::Simulate;
use crate::extremes::{Energy, Extremes};
use crate::failure::Failure;
use crate::frames::Sequence;
use crate::progress::{self, Bar};
use crate::{export, interrupt, output, setup, verdict};

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
    /// Energy that nothing put in, if it is much (J).
    energy_gained: Option<f64>,
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
    let wanted = options.summary.is_some() || options.checkpoint.is_some();
    let mut extremes = wanted.then(Extremes::default);
    if let Some(path) = &options.resume {
        let kept = resume(path, options, &mut simulation)?;
        extremes = extremes.map(|fresh| kept.extremes.unwrap_or(fresh));
    }
    let (frames, mut export) = export::begin(options, &simulation, &presentation)?;
    if frames.first > 0 && Sequence::of(&options.output).is_none() {
        eprintln!(
            "{} begins with frame {}, the first since the checkpoint",
            options.output.display(),
            frames.first
        );
    }
    let every = Duration::from_secs_f64(options.every);
    let keeper = options.checkpoint.as_deref();
    let mut keeper = keeper.map(|path| Keeper::new(path, every)).transpose()?;
    if let Some(extremes) = &mut extremes {
        extremes.look(&simulation);
    }
    interrupt::listen();
    let bar = Bar::new(options.run.end()? - simulation.time());
    let mut crossed = check(&simulation, options.check);
    let what = &options.run.what;
    let kept = |run: &Simulation, extremes| Kept::new(&what.scene, what.grid, run, extremes);
    let mut written = Ok(());
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
            if let Some(keeper) = &mut keeper {
                written = keeper.look(|| kept(simulation, extremes));
            }
            crossed.is_ok() && written.is_ok() && interrupt::go_on()
        });
        if reached != Ok(true) {
            bar.clear();
        }
        let written_so_far = || written_of(&options.output, k, frames.count);
        match reached {
            Ok(true) => {}
            Ok(false) if crossed.is_err() => {
                let why = crossed.err().unwrap_or_default();
                return Err(Failure::run(format!("{why}; {}", written_so_far())));
            }
            Ok(false) => {
                std::mem::replace(&mut written, Ok(()))?;
                let saved = match &keeper {
                    Some(keeper) => {
                        let kept = kept(&simulation, extremes);
                        format!("; {}", keeper.write(&kept)?)
                    }
                    None => String::new(),
                };
                return Err(Failure::Interrupted(format!(
                    "interrupted: {}{saved}",
                    written_so_far()
                )));
            }
            Err(error) => return Err(verdict::lost(&simulation, &error, &written_so_far())),
        }
        export.add(&simulation)?;
    }
    bar.clear();
    export.finish()?;
    if let Some(keeper) = &keeper {
        keeper.write(&kept(&simulation, extremes))?;
    }
    let one_mesh = |ending: &&str| output::ends_in(&options.output, ending);
    if simulation.tears() > 0 && ["pc2", "glb"].iter().any(one_mesh) {
        eprintln!(
            "{} springs broke, but {} has one mesh for all its frames: a sequence such as torn-####.obj has the holes",
            simulation.tears(),
            options.output.display()
        );
    }
    verdict::warn_of_gain(&simulation);
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
        energy_gained: simulation.gained().map(|gain| gain.energy),
        largest_stretch: extremes.stretch,
        torn: simulation.tears(),
        contact: Contact::of(&simulation),
        wall_time: begun.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::run)? + "\n";
    if path == stdout {
        output::say(&text)
    } else {
        output::write(path, text.as_bytes())
    }
}

/// Takes a run up where it was kept in a file. A solver, a step or a disturbance that is asked for
/// has to be the one that it was kept with.
fn resume(path: &Path, options: &Simulate, run: &mut Simulation) -> Result<Kept, Failure> {
    let kept = Kept::read(path)?;
    let (solver, control) = (run.method(), run.control());
    let asked = &options.run;
    kept.check(path, &asked.what.scene, asked.what.grid, run)?;
    let refuse = |why: String| Err(Failure::usage(format!("{}: {why}", path.display())));
    if let Some((row, _)) = kept.tuned.first() {
        return refuse(format!(
            "this run was tuned in the window ({row}): a3 --resume opens it there"
        ));
    }
    if let Err(why) = run.restore(&kept.checkpoint) {
        return refuse(why.to_string());
    }
    if asked.solver.is_some() && solver.name != run.method().name
        || asked.step.is_some() && control != run.control()
    {
        return refuse(format!(
            "this run goes on with {} {}, which need not be given",
            run.method().name,
            run.control().value()
        ));
    }
    for (asked, there, option) in [
        (asked.what.wind, run.windy(), "wind"),
        (asked.what.swing, run.swinging(), "swing"),
        (asked.what.self_collision, run.touching(), "self-collision"),
    ] {
        if asked && !there {
            return refuse(format!(
                "this run goes on without {option}: leave out --{option}"
            ));
        }
    }
    let (now, end) = (run.time(), asked.end()?);
    if now > end {
        return refuse(format!(
            "this run is at t = {now} s already, past --until {end}"
        ));
    }
    Ok(kept)
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
fn written_of(path: &Path, done: usize, count: usize) -> String {
    if Sequence::of(path).is_some() && done > 0 {
        format!("{} has the first {done} of {count} frames", path.display())
    } else {
        "nothing was written".into()
    }
}
