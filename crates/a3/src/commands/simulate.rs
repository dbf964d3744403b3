//! `a3 simulate`: the final state of a run, or all its frames, in files that other programs read,
//! and the summary of the run.

use std::path::Path;
use std::time::{Duration, Instant};

use a3_core::{Network, Simulation};
use a3_files::bar::Bar;
use a3_files::checkpoint::{Energy, Extremes, Kept};
use a3_files::failure::Failure;
use a3_files::frames::{FrameTimes, Sequence};
use a3_files::keeper::Keeper;
use a3_files::output;
use a3_files::setup::{Request, Run};
use a3_files::{interrupt, progress, terminal, verdict};
use a3_media::export::{self, Export};
use serde::Serialize;

use crate::cli::Simulate;

/// Runs the simulation and writes its files.
pub fn run(options: &Simulate) -> Result<(), Failure> {
    let begun = Instant::now();
    export::check_ending(&options.output)?;
    let kept = options.resume.as_deref();
    let kept = kept.map(|path| Kept::read(path).map(|kept| (path, kept)));
    let kept = kept.transpose()?;
    let solver = kept.as_ref().map(|(_, kept)| kept.checkpoint.run.method);
    let mut run = options.run.prepare(solver)?;
    check_summary(options)?;
    let extremes = begin(options, kept, &mut run)?;
    let (frames, mut export) = export::begin(&options.output, options.fps, &run)?;
    warn_of_first_frame(options, &frames);
    let every = Duration::from_secs_f64(options.every);
    let keeper = options.checkpoint.as_deref();
    let (mut simulation, end) = (run.simulation, run.until);
    let mut observer = Observer {
        options,
        request: run.request,
        extremes,
        keeper: keeper.map(|path| Keeper::new(path, every)).transpose()?,
        crossed: None,
        failure: None,
    };
    advance(&mut simulation, end, &frames, &mut *export, &mut observer)?;
    export.finish()?;
    observer.save(&simulation)?;
    warn_of_tears(options, &simulation);
    verdict::warn(&simulation);
    if let (Some(path), Some(extremes)) = (&options.summary, &observer.extremes) {
        write(path, &simulation, frames.count, extremes, begun)?;
    }
    Ok(())
}

/// Checks that the summary can be written.
fn check_summary(options: &Simulate) -> Result<(), Failure> {
    let stdout = Path::new("-");
    match options.summary.as_deref() {
        Some(path) if path != stdout => output::check(path, &["json"]),
        Some(_) if options.output == stdout => {
            Err(Failure::usage("standard output can take either --output or --summary, not both"))
        }
        _ => Ok(()),
    }
}

/// Brings the run to its checkpoint, if it resumes one. Returns the extremes until then, if any
/// are wanted.
fn begin(
    options: &Simulate,
    kept: Option<(&Path, Kept)>,
    run: &mut Run,
) -> Result<Option<Extremes>, Failure> {
    let wanted = options.summary.is_some() || options.checkpoint.is_some();
    let fresh = wanted.then(Extremes::default);
    let Some((path, kept)) = kept else {
        return Ok(fresh);
    };
    resume((path, &kept), options, run)?;
    Ok(fresh.map(|fresh| kept.extremes.unwrap_or(fresh)))
}

/// Advances the simulation from frame to frame, and exports each.
fn advance(
    simulation: &mut Simulation,
    end: f64,
    frames: &FrameTimes,
    export: &mut dyn Export,
    observer: &mut Observer,
) -> Result<(), Failure> {
    interrupt::listen();
    let bar = Bar::new(end - simulation.time());
    let mut may_continue = observer.observe(simulation);
    for (k, time) in frames.times().enumerate() {
        let mut before = simulation.time();
        let reached = progress::march(simulation, time, |simulation| {
            bar.advance(simulation.time() - before);
            before = simulation.time();
            may_continue &= observer.observe(simulation);
            may_continue
        });
        // The energy is checked last before any file is complete.
        let reached = match reached {
            Ok(true) if k + 1 == frames.count => simulation.conclude().map(|()| true),
            other => other,
        };
        if reached != Ok(true) {
            bar.clear();
            let written = written(&observer.options.output, k, frames.count);
            return Err(match reached {
                Err(error) => verdict::lost(simulation, &error, &written, end),
                Ok(_) => observer.stopped(simulation, &written),
            });
        }
        export.add(simulation)?;
    }
    bar.clear();
    Ok(())
}

/// Warns that a resumed run has no frames from before its checkpoint.
fn warn_of_first_frame(options: &Simulate, frames: &FrameTimes) {
    if frames.first > 0 && Sequence::of(&options.output).is_none() {
        terminal::warn(&format!(
            "{} begins with frame {}, the first since the checkpoint",
            options.output.display(),
            frames.first
        ));
    }
}

/// Warns that a format with one mesh for all frames does not show broken springs.
fn warn_of_tears(options: &Simulate, simulation: &Simulation) {
    let one_mesh = |ending: &&str| output::ends_in(&options.output, ending);
    if simulation.tears() > 0 && ["glb", "usda"].iter().any(one_mesh) {
        terminal::warn(&format!(
            "{} springs broke, but {} has one mesh for all its frames: a sequence such as torn-####.obj has the holes",
            simulation.tears(),
            options.output.display()
        ));
    }
}

/// Observer of a run: it writes checkpoints, and checks for crossings and interrupts.
struct Observer<'a> {
    options: &'a Simulate,
    request: Request,
    extremes: Option<Extremes>,
    keeper: Option<Keeper>,
    /// Message about the first crossing of surfaces.
    crossed: Option<String>,
    /// Failure of a checkpoint.
    failure: Option<Failure>,
}

impl Observer<'_> {
    /// Observes the run. Returns whether it may continue.
    fn observe(&mut self, run: &Simulation) -> bool {
        if let Some(extremes) = &mut self.extremes {
            extremes.observe(run);
        }
        self.crossed = check(run, self.options.check).err();
        if let Some(mut keeper) = self.keeper.take() {
            self.failure = keeper.write_if_due(|| self.kept(run)).err();
            self.keeper = Some(keeper);
        }
        self.crossed.is_none() && self.failure.is_none() && interrupt::go_on()
    }

    /// Returns the present run, as a checkpoint stores it.
    fn kept(&self, run: &Simulation) -> Kept {
        let Request { source, options } = &self.request;
        Kept::new(source, options.grid, run, self.extremes)
    }

    /// Writes a last checkpoint, if --checkpoint is given. Returns a clause that says so.
    fn save(&self, run: &Simulation) -> Result<String, Failure> {
        let Some(keeper) = &self.keeper else {
            return Ok(String::new());
        };
        Ok(format!("; {}", keeper.write(&self.kept(run))?))
    }

    /// Returns the failure of a run that was stopped. `written` says what it has written.
    fn stopped(&mut self, run: &Simulation, written: &str) -> Failure {
        interrupt::write_on();
        if let Some(failure) = self.failure.take() {
            return failure;
        }
        if let Some(why) = &self.crossed {
            return Failure::run(format!("{why}; {written}"));
        }
        match self.save(run) {
            Ok(kept) => Failure::Interrupted(format!("interrupted: {written}{kept}")),
            Err(failure) => failure,
        }
    }
}

/// Resumes a run from a checkpoint. A solver, a step or a disturbance on the command line has to be
/// that of the checkpoint.
fn resume(
    (path, kept): (&Path, &Kept),
    options: &Simulate,
    begun: &mut Run,
) -> Result<(), Failure> {
    let (source, run) = (&begun.request.source, &mut begun.simulation);
    let (solver, control) = (run.method(), run.control());
    let asked = &options.run;
    kept.check(path, source, asked.what.grid, run.scene())?;
    let refuse = |why: String| Err(Failure::usage(format!("{}: {why}", path.display())));
    if let Some((row, _)) = kept.tuned.first() {
        return refuse(format!(
            "this run was tuned in the window ({row}): a3 --resume opens it there"
        ));
    }
    if kept.edited.is_some() {
        let why = "the scene of this run was edited in the window: a3 --resume opens it there";
        return refuse(why.into());
    }
    if let Err(why) = run.restore(&kept.checkpoint) {
        return refuse(why.to_string());
    }
    if asked.solver.is_some() && solver.name != run.method().name
        || asked.step.is_some() && control != run.control()
    {
        return refuse(format!(
            "this run continues with {} {}, which need not be given",
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
            return refuse(format!("this run continues without {option}: leave out --{option}"));
        }
    }
    let (now, end) = (run.time(), begun.until);
    if now > end {
        return refuse(format!("this run is at t = {now} s already, past --until {end}"));
    }
    Ok(())
}

/// Checks for crossings of surfaces, if --check is given.
fn check(simulation: &Simulation, wanted: bool) -> Result<(), String> {
    let Some(network) = simulation.model().network().filter(|_| wanted) else {
        return Ok(());
    };
    let state = simulation.state();
    let apart = network.check_apart(simulation.time(), network.halves(state).0);
    apart.map_err(|why| format!("at t = {:.4} s {why}", simulation.time()))
}

/// Says what an interrupted run has written: a file is complete or absent, and so is each file of a
/// sequence.
fn written(path: &Path, done: usize, count: usize) -> String {
    if Sequence::of(path).is_some() && done > 0 {
        format!("{} has the first {done} of {count} frames", path.display())
    } else {
        "nothing was written".into()
    }
}

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
    /// Energy that the method added (J), if it is large enough for a warning.
    energy_gained: Option<f64>,
    /// Energy gained or, below 0, lost (percent); none where forces do not conserve energy.
    energy_change_percent: Option<f64>,
    /// Largest change (m/s) of a velocity at the start, so that it fits the constraints; none if
    /// all did.
    start_changed_by: Option<f64>,
    /// The constraint with the largest error; none if all were met.
    constraint: Option<Violation>,
    /// Largest length over rest length of a spring; none without springs.
    largest_stretch: Option<f64>,
    /// Number of springs that broke.
    torn: usize,
    /// Mass of the liquid that flowed out (kg); none without an outflow.
    flowed_out: Option<f64>,
    /// Actions of the collision safeguard; none where surfaces do not touch.
    contact: Option<Contact>,
    /// Real time (s).
    wall_time: f64,
}

/// Least error of a constraint, over its length, that a summary reports.
const MIN_REPORTED_ERROR: f64 = 1e-4;

/// Constraint that was not met.
#[derive(Serialize)]
struct Violation {
    /// Number, counted from 0.
    number: usize,
    /// Description.
    name: String,
    /// Largest error over its length (percent).
    off_by_percent: f64,
}

/// Actions of the collision safeguard of surfaces.
#[derive(Serialize)]
struct Contact {
    /// Number of impulses.
    impulses: usize,
    /// Number of displacements of vertices that were cut.
    cuts: usize,
    /// Momentum that cuts took (N s).
    momentum_lost: f64,
}

/// Writes the summary of a run that began at the instant `begun` and has written `frames` frames:
/// to a file, or for - to standard output.
pub fn write(
    path: &Path,
    simulation: &Simulation,
    frames: usize,
    extremes: &Extremes,
    begun: Instant,
) -> Result<(), Failure> {
    let network = simulation.model().network();
    let fluid = network.and_then(Network::fluid);
    let fluid = fluid.filter(|fluid| !fluid.members().outflows().is_empty());
    let unmet = simulation.worst_constraint();
    let unmet = unmet.filter(|unmet| unmet.share > MIN_REPORTED_ERROR);
    let guarded = network.and_then(Network::contact_layer).map(|_| simulation.guarded());
    let summary = Summary {
        scene: simulation.scene().name.clone(),
        solver: simulation.method().name,
        frames,
        time: simulation.time(),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: extremes.energy,
        energy_gained: simulation.gained().map(|gain| gain.energy),
        energy_change_percent: simulation.energy_change().map(|share| 100.0 * share),
        start_changed_by: Some(simulation.scene().fitted).filter(|fitted| *fitted > 0.0),
        constraint: unmet.map(|unmet| Violation {
            number: unmet.number,
            name: unmet.constraint.to_string(),
            off_by_percent: 100.0 * unmet.share,
        }),
        largest_stretch: extremes.stretch,
        torn: simulation.tears(),
        flowed_out: fluid.map(|it| it.members().drained().len() as f64 * it.law().mass()),
        contact: guarded.map(|guarded| Contact {
            impulses: guarded.impulses,
            cuts: guarded.cuts,
            momentum_lost: guarded.lost,
        }),
        wall_time: begun.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::run)? + "\n";
    if path == Path::new("-") {
        terminal::send(&text)
    } else {
        output::write(path, text.as_bytes())
    }
}
