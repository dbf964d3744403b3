//! The options of runs: what is simulated, how, and until when; and the measures of their errors
//! and costs.

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Disturbances, Grid, Method, StepLength, StepLimits};
use a3_files::arguments::{absolute, grid, max_step, particle, step, threads};
use a3_files::failure::Failure;
use a3_files::setup::{Request, Run, SceneOptions};
use a3_files::{holding, terminal};
use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};

use super::values::{SCENE, SOLVER, choice, until};

/// Options of a scene: its name or file, its grid, wind, swing and self-collision.
#[derive(Args)]
pub struct SceneArgs {
    /// Scene: a name that `a3 scenes` lists, or a file of your own: TOML, JSON, or a mesh
    #[arg(long, value_name = "NAME|FILE", default_value = "cloth", value_parser = SCENE, hide_possible_values = true)]
    pub scene: String,
    /// Rows and columns of the cloth, such as 30x40
    #[arg(long, value_name = "ROWSxCOLS", value_parser = grid, allow_hyphen_values = true)]
    pub grid: Option<Grid>,
    /// Let the wind blow
    #[arg(long)]
    pub wind: bool,
    /// Swing the pinned particles to and fro
    #[arg(long)]
    pub swing: bool,
    /// Keep surfaces from passing through one another and themselves
    #[arg(long)]
    pub self_collision: bool,
    /// Number of threads; by default one for each processor, or as many as the environment variable
    /// `RAYON_NUM_THREADS` says
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
}

impl SceneArgs {
    /// Returns the options of the scene.
    pub fn options(&self) -> SceneOptions {
        SceneOptions {
            grid: self.grid,
            on: Disturbances { wind: self.wind, swing: self.swing, contact: self.self_collision },
        }
    }

    /// Reads the scene, after it has limited the program's threads.
    ///
    /// # Errors
    /// There is no such scene, or its file has a fault.
    pub fn request(&self) -> Result<Request, Failure> {
        limit_threads(self.threads);
        Request::read(&self.scene, self.options())
    }
}

/// Limits the program to the number of threads that is asked for, if one is.
pub fn limit_threads(threads: Option<usize>) {
    if let Some(count) = threads {
        // Only the first call has an effect; later ones fail because the threads are there already.
        let threads = rayon::ThreadPoolBuilder::new().num_threads(count);
        let _ = threads.build_global();
    }
}

/// Limits of adaptive steps.
#[derive(Args)]
pub struct StepOptions {
    /// Error of positions that a step of an adaptive solver may make, in m; by default the
    /// tolerance times the radius of the scene
    #[arg(long, value_name = "M", value_parser = absolute, allow_negative_numbers = true)]
    pub absolute: Option<f64>,
    /// Longest step of an adaptive solver, in s; by default the scene's own, if it has one
    #[arg(long, value_name = "S", value_parser = max_step, allow_negative_numbers = true)]
    pub max_step: Option<f64>,
}

impl StepOptions {
    /// Returns the limits that were given.
    pub fn given(&self) -> StepLimits {
        StepLimits { absolute: self.absolute, max_step: self.max_step }
    }
}

/// A run without a window.
#[derive(Args)]
pub struct RunOptions {
    /// Solver by letter or name, as `a3 solvers` lists them; by default the scene's own, or else t
    #[arg(value_parser = SOLVER, hide_possible_values = true)]
    pub solver: Option<&'static Method>,
    /// Step in seconds, or relative tolerance of an adaptive solver; by default the scene's own, or
    /// else the solver's
    #[arg(value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Simulated seconds, by default the scene's own; a single state is that at exactly this time,
    /// and the last of several frames is at it or before
    #[arg(long, value_name = "T", value_parser = until, allow_negative_numbers = true)]
    pub until: Option<f64>,
    #[command(flatten)]
    pub limits: StepOptions,
    #[command(flatten)]
    pub what: SceneArgs,
}

impl RunOptions {
    /// Reads the scene and prepares its run: by the solver that the options name, or else by
    /// `own`, or else by that of the scene. A default step that would not hold is shortened, and a
    /// note says so.
    ///
    /// # Errors
    /// The scene has a fault or no end, or the options do not fit it.
    pub fn prepare(&self, own: Option<&'static Method>) -> Result<Run, Failure> {
        let request = self.what.request()?;
        if let Some(solver) = self.solver.filter(|solver| !solver.is_adaptive()) {
            let given =
                [(self.limits.absolute, "--absolute"), (self.limits.max_step, "--max-step")];
            if let Some((_, option)) = given.iter().find(|(value, _)| value.is_some()) {
                return Err(Failure::usage(format!(
                    "{} takes a step, not a tolerance: leave out {option}",
                    solver.name
                )));
            }
        }
        let duration = request.source.description.duration;
        let until = self.until.or(duration).ok_or_else(|| {
            Failure::usage("the scene has no duration of its own: give --until T in seconds, such as --until 10")
        })?;
        let mut setup = request.build()?;
        let solver = request.source.solver_or(self.solver.or(own));
        setup.scene.limits = self.limits.given().or(setup.scene.limits);
        let mut simulation = request.simulate(&setup, solver, self.step)?;
        let is_asked = self.step.is_some() || setup.defaults.own_control(solver).is_some();
        if !is_asked
            && own.is_none()
            && let Some(usual) = holding::shorten(&mut simulation)
        {
            let [step, usual] = [simulation.control().value(), usual].map(StepLength);
            terminal::note(&format!(
                "step {step}: a longer one, such as the default {usual}, would not hold"
            ));
        }
        Ok(Run { request, simulation, presentation: setup.presentation, until })
    }
}

/// Creates a parser of the metric of errors.
pub fn metric() -> impl TypedValueParser<Value = Metric> {
    choice(&Metric::OF_PARTICLES, |metric| {
        let help = match metric {
            Metric::Position => "Positions, root mean square over the particles (m)",
            Metric::State => "Numbers of a state without particles",
            Metric::Energy => "Total energy (J)",
            Metric::Strain => "Lengths of the springs over their rest lengths, root mean square",
            Metric::Momentum => "Total momentum of the particles that are not pinned (kg m/s)",
            Metric::Phase => "Time by which the motion is ahead or behind (s)",
            Metric::Penetration => {
                "Largest depth of a surface within the thickness of another, over that thickness"
            }
            Metric::Impact => {
                "Times at which surfaces first touch, and at which nothing touches any more (s)"
            }
        };
        (metric.name(), help)
    })
}

/// Particles and times at which errors are taken.
#[derive(Args)]
pub struct ErrorScope {
    /// Take the errors of position and phase from particle I alone
    #[arg(long, value_name = "I", value_parser = particle, allow_negative_numbers = true)]
    pub particle: Option<usize>,
    /// Take the error at the end, instead of the largest one during the run
    #[arg(long)]
    pub at_end: bool,
}

impl ErrorScope {
    /// Returns the particle and the times that were given.
    pub fn given(&self) -> Scope {
        Scope { particle: self.particle, at_end: self.at_end }
    }
}

/// Measure of the cost.
#[derive(Clone, Copy, ValueEnum, PartialEq)]
pub enum WorkMeasure {
    /// Computing time on this machine
    #[value(alias = "seconds")]
    Time,
    /// Evaluations of the forces, the same on every machine
    Evaluations,
}
