//! Trials on the course of a scene: a method, or a scheme with a mistake, against the rows of a
//! file; and fits of a constant of the scene to these rows, by least squares.

use std::cell::Cell;

use a3_core::accuracy::{Horizon, Reference, horizon};
use a3_core::integrators::METHODS;
use a3_core::{Control, Method, Scene, Simulation};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;

use super::constant::{Change, Mistake};
use super::grid::Pace;
use super::plain::{Forces, Plain};
use super::rows::{Rows, columns, distance};
use super::scheme::{PlainRun, Scheme};
use crate::chart::check_motion;

/// Largest time that is judged (s).
const MAX_TIME: f64 = 1000.0;
/// Largest distance of rows that agree, over the distance moved until then.
const AGREEMENT: f64 = 1e-9;
/// Largest distance of rows that agree, over the size of the scene: its rounding errors.
const ROUNDING: f64 = 1e-13;
/// Largest distance of rows that agree, over the error of a coordinate by its digits.
const DIGITS: f64 = 2.0;
/// Largest distance of rows that agree in single precision, over the distance by which that
/// precision changes a run.
const SINGLE: f64 = 10.0;
/// Largest such distance over that which the scene moves.
const MAX_NOISE: f64 = 1e-3;
/// Work of the beginning of a run by a solver, over an evaluation.
const BEGINNING: f64 = 20.0;
/// Largest work of a trial, in springs and particles that are visited.
const MAX_WORK: f64 = 5e8;
/// Work of a step of an implicit method, over an evaluation.
const IMPLICIT_WORK: f64 = 25.0;
/// Number of rows of the first fit. Each further one has several times as many, up to all.
const FIRST_ROWS: usize = 3;
const MORE_ROWS: usize = 4;
/// Largest number of iterations of each fit.
const MAX_ITERATIONS: usize = 8;
/// Change of the factor over which a rate of change is taken.
const DELTA: f64 = 1e-6;
/// Largest distance by which the last iteration moves the rows, over that which agrees.
const SETTLED: f64 = 1e-3;
/// Least effect of a constant, over the distance that agrees, that tells its value.
const MIN_EFFECT: f64 = 100.0;
/// Largest factor.
const MAX_FACTOR: f64 = 100.0;
/// Largest work of fits, in springs and particles that are visited.
const MAX_WORK_OF_FITS: f64 = 2e8;
/// Distance of rows from a fit to some of them, over that which agrees.
const SLACK: f64 = 3.0;

/// Way to compute a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Solver of a3.
    Method(&'static Method),
    /// Scheme on plain masses and springs.
    Scheme(&'static Scheme, Option<Mistake>),
}

impl Way {
    /// Returns the name of the method.
    pub fn title(self) -> &'static str {
        match self {
            // What its passes converge to is better known.
            Self::Method(method) if method.name == "vbd" => {
                "implicit Euler, solved fully, as by vertex block descent"
            }
            Self::Method(method) => method.title,
            Self::Scheme(scheme, _) => scheme.title,
        }
    }

    /// Returns the name of the solver of a3 with the same title, if there is one. Apart from a slip
    /// or a mistake, this way takes the steps of that solver.
    pub fn solver(self) -> Option<&'static str> {
        if let Self::Method(method) = self {
            return Some(method.name);
        }
        let is_it = |method: &&Method| method.title == self.title();
        METHODS.iter().find(is_it).map(|method| method.name)
    }

    /// Returns the mistake in the forces that it makes.
    pub fn mistake(self) -> Option<Mistake> {
        match self {
            Self::Scheme(_, mistake) => mistake,
            Self::Method(_) => None,
        }
    }

    /// Returns the slip or the mistake that it makes, in words that follow "with", and the question
    /// to the author of a program that computes steps so.
    pub fn slip(self) -> [Option<String>; 2] {
        match self {
            Self::Scheme(_, Some(mistake)) => mistake.words().map(Some),
            Self::Scheme(scheme, None) => {
                [scheme.slip, scheme.question].map(|it| it.map(Into::into))
            }
            Self::Method(_) => [None, None],
        }
    }
}

/// Where a trial begins, and which of its steps a row shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At the start of the scene.
    Scene,
    /// At a row of the file, counted from 0, with the velocities of the file.
    Row(usize),
    /// At the start of the scene; each row shows the state a step later.
    Ahead,
    /// At the start of the scene; each row shows the state a step earlier.
    Behind,
}

/// Trial of a method or a scheme. Its steps are equal, and a whole number of them lies between two
/// grid points at which a step ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    pub way: Way,
    /// Steps and grid points.
    pub pace: Pace,
    pub start: Start,
}

/// Result of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedRows {
    /// Number of rows up to the first that differs by more than its bound.
    pub rows: usize,
    /// Number of these rows that are at the end of a step.
    pub at_steps: usize,
    /// Largest distance of these rows (m).
    pub distance: f64,
    /// Largest distance moved until then (m).
    pub moved: f64,
    /// Largest distance of the velocities of these rows, and their largest size, root mean square
    /// over the particles (m/s), if the file has them.
    pub velocities: Option<[f64; 2]>,
}

/// Scene with all that judgements of its files share.
pub struct Course<'a> {
    /// Companion of the work, which may stop it.
    pub monitor: &'a dyn Monitor,
    pub scene: &'a Scene,
    /// The scene as masses and springs, if it is that.
    pub plain: Option<Plain>,
    /// How far errors mean something; states are judged up to its end.
    pub horizon: Horizon,
    /// Step of the programs (s), if it is known.
    pub step: Option<f64>,
    /// Work of the present search, in springs and particles that are visited.
    pub work: Cell<f64>,
    /// References that were computed, each with states at the times of some file.
    pub references: Vec<Reference>,
}

/// Scene and rows against which trials run.
#[derive(Clone)]
pub struct Judged<'a> {
    pub course: &'a Course<'a>,
    pub rows: &'a Rows<'a>,
    /// Largest distance that the scene moves until the last row (m).
    pub motion: f64,
    /// Number of particles and springs, which an evaluation visits.
    size: f64,
    /// Radius of the scene (m).
    radius: f64,
    /// Distance by which single precision changes a run until each row (m), if the program is
    /// taken to have it. Rows are compared as far as that tells anything.
    pub noise: Option<Vec<f64>>,
}

/// Differences of a run from rows (m), and the square of the largest distance that agrees in their
/// place, summed over them.
struct Residuals {
    all: Vec<f64>,
    bound: f64,
    /// Largest distance over that which agrees.
    worst: f64,
}

/// Largest distance of a row that agrees (m), by its number and the distance moved (m).
type Bound<'b> = &'b dyn Fn(usize, f64) -> f64;
/// Looks at the positions (m) and velocities (m/s) at a row, and returns whether the run goes on.
type Look<'l> = &'l mut dyn FnMut(usize, &[Vec<f64>; 2]) -> bool;

/// A run of a trial.
enum Run<'a> {
    Method(Box<Simulation>),
    Plain(Box<PlainRun<'a>>),
}

impl Run<'_> {
    /// Takes steps. Returns `false` if the run blew up.
    fn advance(&mut self, steps: u64) -> bool {
        match self {
            Self::Method(run) => run.take_steps(steps).is_ok(),
            Self::Plain(run) => {
                (0..steps).for_each(|_| run.step());
                run.x.as_flattened().iter().all(|x| x.is_finite())
            }
        }
    }

    /// Returns the positions (m) and velocities (m/s), column-major.
    fn motion(&self) -> [Vec<f64>; 2] {
        match self {
            Self::Method(run) => {
                let positions = run.state()[..3 * run.particles()].to_vec();
                [positions, run.velocities()]
            }
            Self::Plain(run) => [&run.x, &run.v].map(|vectors| columns(vectors)),
        }
    }
}

impl<'a> Course<'a> {
    /// Finds how long errors mean something on the scene, up to the last of all states (s) or to
    /// `until` (s).
    ///
    /// # Errors
    /// Nothing moves, a run fails, or the monitor stopped it.
    pub fn new(
        scene: &'a Scene,
        last: f64,
        until: Option<f64>,
        step: Option<f64>,
        monitor: &'a dyn Monitor,
    ) -> Result<Self, Failure> {
        let last = last.min(MAX_TIME).min(until.unwrap_or(f64::INFINITY));
        let found = horizon(scene, last, &|| monitor.go_on()).map_err(Failure::run)?;
        let mut horizon = found.ok_or_else(stopped)?;
        check_motion(scene, &horizon)?;
        if !horizon.lyapunov.is_finite() || until.is_some() {
            horizon.until = last;
        }
        Ok(Self {
            monitor,
            scene,
            plain: Plain::of(scene).ok(),
            horizon,
            step,
            work: Cell::default(),
            references: vec![],
        })
    }
}

/// Creates the failure of a command that was interrupted before all files were judged.
pub fn stopped() -> Failure {
    Failure::Interrupted("interrupted before all files were judged".into())
}

impl<'a> Judged<'a> {
    /// Creates the trials of rows on a scene that moves by `motion` (m).
    pub fn new(course: &'a Course<'a>, rows: &'a Rows<'a>, motion: f64) -> Self {
        let network = course.scene.model.network();
        let springs = network.map_or(0, |network| network.all_springs().count());
        Self {
            course,
            rows,
            motion,
            size: (course.scene.model.particles() + springs) as f64,
            radius: course.scene.extent().1,
            noise: None,
        }
    }

    /// Returns the scene.
    pub fn scene(&self) -> &'a Scene {
        self.course.scene
    }

    /// Returns the scene as masses and springs, if it is that.
    pub fn plain(&self) -> Option<&'a Plain> {
        self.course.plain.as_ref()
    }

    /// Returns the largest distance of row k (m) that agrees, after a distance moved (m).
    pub fn tolerance(&self, k: usize, moved: f64) -> f64 {
        let known = |noise: &Vec<f64>| noise.get(k).copied().unwrap_or(f64::INFINITY);
        let noise = self.noise.as_ref().map_or(0.0, known);
        AGREEMENT * moved + self.rounding(k) + SINGLE * noise
    }

    /// Returns the number of rows that are compared.
    pub fn last(&self) -> usize {
        self.noise.as_ref().map_or(self.rows.len(), Vec::len)
    }

    /// Returns the positions at which a trial begins (m), column-major.
    pub fn start(&self, trial: Trial) -> &[f64] {
        match trial.start {
            Start::Row(row) if row < self.rows.len() => self.rows.positions(row),
            _ => &self.scene().state[..3 * self.scene().model.particles()],
        }
    }

    /// Returns the distance by which single precision changes a run by a scheme until each row
    /// (m), as far as it is much smaller than the motion.
    pub fn noise(&self, trial: Trial) -> Option<Vec<f64>> {
        let mut double = vec![None; self.rows.len()];
        self.follow(trial, false, self.rows.len(), &mut |k, [x, _]| {
            double[k] = Some(x.clone());
            true
        })?;
        let (mut noise, mut most) = (vec![], 0.0);
        let passed = self.follow(trial, true, self.rows.len(), &mut |k, [x, _]| {
            let Some(other) = &double[k] else {
                return false;
            };
            noise.resize(k, most);
            most = f64::max(most, distance(x, other));
            noise.push(most);
            SINGLE * most < MAX_NOISE * self.motion
        })?;
        if passed == self.rows.len() {
            noise.resize(passed, most);
        }
        Some(noise)
    }

    /// Returns whether a trial agrees with a first row at time 0, which no way to compute steps
    /// changes.
    pub fn begins(&self, trial: Trial, bound: Bound) -> bool {
        let at_start = self.rows.times[0] == 0.0 && matches!(trial.start, Start::Scene);
        !at_start || distance(self.start(trial), self.rows.positions(0)) <= bound(0, 0.0)
    }

    /// Returns the distance of row k by rounding alone (m).
    pub fn rounding(&self, k: usize) -> f64 {
        ROUNDING * self.radius + DIGITS * self.rows.rounding(k)
    }

    /// Returns the work of a step of a way: springs and particles that are visited.
    fn price(&self, way: Way) -> f64 {
        let evaluations = match way {
            Way::Method(m) if m.is_implicit() || m.solves_linear_systems() => IMPLICIT_WORK,
            Way::Method(m) => f64::from(m.evaluations.max(m.damped_evaluations)),
            Way::Scheme(scheme, _) => scheme.evaluations(self.scene().model.particles()) as f64,
        };
        self.size * evaluations
    }

    /// Runs a trial, in single precision if so, and shows each row before `end` that is at the end
    /// of a step to `look`: its number, the positions (m) and the velocities (m/s). Ends where
    /// that returns `false`, or the run blows up. Returns the number of rows until then; `None` if
    /// the trial is not possible. The price is added to the work of the search.
    fn follow(&self, trial: Trial, is_single: bool, end: usize, look: Look) -> Option<usize> {
        let pay = |work: f64| self.course.work.set(self.course.work.get() + work);
        let steps = self.rows.until() / self.step_of(trial)?;
        if steps * self.price(trial.way) > MAX_WORK {
            return None;
        }
        let (mut run, first, mut taken) = self.begin(trial, is_single)?;
        if matches!(trial.way, Way::Method(_)) {
            pay(BEGINNING * self.size);
        }
        for k in first..end {
            let is_there = match (&self.rows.grid, &mut run) {
                (Some(grid), run) => {
                    let ahead = grid.numbers[k] * trial.pace.steps;
                    if !ahead.is_multiple_of(trial.pace.points) {
                        continue;
                    }
                    let steps = match (ahead / trial.pace.points, trial.start) {
                        (steps, Start::Ahead) => steps + 1,
                        (steps, Start::Behind) => steps.saturating_sub(1),
                        (steps, _) => steps,
                    };
                    let more = steps - taken;
                    taken = steps;
                    pay(self.price(trial.way) * more as f64);
                    run.advance(more)
                }
                (None, Run::Method(run)) => run.advance_to(self.rows.times[k]).is_ok(),
                (None, Run::Plain(_)) => return None,
            };
            if !is_there || !self.course.monitor.go_on() || !look(k, &run.motion()) {
                return Some(k);
            }
        }
        Some(end)
    }

    /// Compares a trial with the rows until a row differs by more than its bound. `None` if the
    /// trial is not possible.
    pub fn compare(&self, trial: Trial, bound: Bound) -> Option<ComparedRows> {
        let start = self.start(trial);
        let mut compared = ComparedRows {
            rows: 0,
            at_steps: 0,
            distance: 0.0,
            moved: 0.0,
            velocities: self.rows.velocities(0).map(|_| [0.0; 2]),
        };
        let rows = self.follow(trial, false, self.last(), &mut |k, [x, v]| {
            let apart = distance(x, self.rows.positions(k));
            let moved = compared.moved.max(distance(x, start));
            // A distance that is no number agrees with nothing.
            if apart.is_nan() || apart > bound(k, moved) {
                return false;
            }
            compared.at_steps += 1;
            compared.moved = moved;
            compared.distance = compared.distance.max(apart);
            let seen = compared.velocities.as_mut().zip(self.rows.velocities(k));
            if let Some(([apart, speed], own)) = seen {
                *apart = apart.max(distance(v, own));
                *speed = speed.max(distance(v, &vec![0.0; v.len()]));
            }
            true
        });
        compared.rows = rows?;
        Some(compared)
    }

    /// Returns the step of a trial (s): a part of that between grid points or, without a grid, the
    /// known one.
    pub fn step_of(&self, trial: Trial) -> Option<f64> {
        match &self.rows.grid {
            Some(grid) => Some(trial.pace.points as f64 * grid.step / trial.pace.steps as f64),
            None => self.course.step,
        }
    }

    /// Returns the run of a trial, the first row that it shows, and the number of steps from the
    /// start of the grid to its beginning.
    fn begin(&self, trial: Trial, is_single: bool) -> Option<(Run<'_>, usize, u64)> {
        let step = self.step_of(trial)?;
        let (row, taken, given) = match trial.start {
            Start::Row(row) => {
                // Only masses and springs alone do not depend on time, nor on more than positions
                // and velocities.
                self.plain()?;
                let grid = self.rows.grid.as_ref()?;
                if row >= self.rows.len() || trial.pace.points != 1 {
                    return None;
                }
                let given = [self.rows.positions(row), self.rows.velocities(row)?];
                (row, grid.numbers[row] * trial.pace.steps, Some(given))
            }
            _ => (0, 0, None),
        };
        let run = match trial.way {
            Way::Method(method) => {
                let mut scene = self.scene().clone();
                if let Some(given) = given {
                    scene.state = given.concat();
                }
                let run = Simulation::new(scene, method, Control::Step(step)).ok()?;
                Run::Method(Box::new(run))
            }
            Way::Scheme(scheme, mistake) => {
                let (plain, n) = (self.plain()?, self.scene().model.particles());
                let rows = |x: &[f64]| (0..n).map(|i| [x[i], x[n + i], x[2 * n + i]]).collect();
                let own = || [&plain.list.positions, &plain.list.velocities].map(Vec::clone);
                let start = given.map_or_else(own, |given| given.map(rows));
                let forces = Forces::new(plain, mistake, is_single);
                Run::Plain(Box::new(PlainRun::new(forces, scheme, step, start)))
            }
        };
        Some((run, row, taken))
    }

    /// Returns a trial whose constant is fitted to the rows, by the Gauss-Newton method: first to
    /// those at the start, on which it acts almost linearly. `None` if rows differ by more than
    /// their bound.
    pub fn fit(&self, trial: Trial, bound: Bound) -> Option<Trial> {
        let Way::Scheme(scheme, Some(Mistake::Constant(mut change))) = trial.way else {
            return Some(trial);
        };
        let with = |change: Change| Trial {
            way: Way::Scheme(scheme, Some(Mistake::Constant(change))),
            ..trial
        };
        let mut end = FIRST_ROWS;
        let mut is_fitted = false;
        loop {
            end = end.min(self.last());
            for _ in 0..MAX_ITERATIONS {
                if self.course.work.get() > MAX_WORK_OF_FITS {
                    return None;
                }
                let now = self.residuals(with(change), end, bound)?;
                let moved = self.residuals(with(change.plus(DELTA)), end, bound)?;
                let (mut slope, mut square) = (0.0, 0.0);
                for (now, moved) in now.all.iter().zip(&moved.all) {
                    let rate = (moved - now) / DELTA;
                    slope += rate * now;
                    square += rate * rate;
                }
                is_fitted = square > MIN_EFFECT.powi(2) * now.bound;
                if !is_fitted {
                    break;
                }
                let less = slope / square;
                change = change.plus(-less);
                if less.powi(2) * square <= SETTLED.powi(2) * now.bound {
                    break;
                }
            }
            if change.factor.abs() > MAX_FACTOR || !change.factor.is_finite() {
                change.factor = 1.0;
                is_fitted = false;
            }
            if is_fitted && self.residuals(with(change), end, bound)?.worst > SLACK {
                return None;
            }
            if end == self.last() {
                break;
            }
            end *= MORE_ROWS;
        }
        if !is_fitted {
            return None;
        }
        let typed = with(change.typed());
        let agrees = self.residuals(typed, end, bound)?.worst <= 1.0;
        Some(if agrees { typed } else { with(change) })
    }

    /// Returns the differences of a trial from the first rows. `None` if it blows up there.
    fn residuals(&self, trial: Trial, end: usize, bound: Bound) -> Option<Residuals> {
        let mut found = Residuals { all: vec![], bound: 0.0, worst: 0.0 };
        let (start, mut most) = (self.start(trial), 0.0);
        let passed = self.follow(trial, false, end, &mut |k, [x, _]| {
            let own = self.rows.positions(k);
            most = f64::max(most, distance(own, start));
            let bound = bound(k, most);
            found.bound += own.len() as f64 / 3.0 * bound.powi(2);
            found.worst = found.worst.max(distance(x, own) / bound.max(f64::MIN_POSITIVE));
            found.all.extend(x.iter().zip(own).map(|(x, own)| x - own));
            true
        })?;
        (passed == end).then_some(found)
    }
}
