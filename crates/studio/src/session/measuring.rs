//! Questions about the scene in the window: how fast and how accurate its solvers are, where they
//! fail, which serves best, and what the scene can do without. Measurements answer them, each on
//! its own thread.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use a3_core::{Control, Method};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::report::Report;
use a3_files::setup::Request;
use a3_plot::WorkPrecision;

/// An answer, or the reason why there is none.
pub struct Known {
    /// The scene and the state that were measured, in words.
    pub of: String,
    pub answer: Result<Answer, String>,
}

/// Progress of a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Name of the present stage.
    pub stage: String,
    /// Amounts of work that are done and expected, in a unit of their own.
    pub work: [f64; 2],
    /// Remarks and warnings so far.
    notes: Vec<String>,
}

impl Progress {
    /// Returns the share of the work that is done; 0 while it is not known.
    pub fn share(&self) -> f32 {
        let [done, expected] = self.work;
        if expected > 0.0 { (done / expected).clamp(0.0, 1.0) as f32 } else { 0.0 }
    }
}

/// Monitor of a measurement, which may be on another thread.
#[derive(Default)]
struct MeasuringMonitor {
    stopped: AtomicBool,
    progress: Mutex<Progress>,
}

impl MeasuringMonitor {
    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Monitor for MeasuringMonitor {
    fn go_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    fn stage(&self, what: &str) {
        what.clone_into(&mut self.progress().stage);
    }

    fn expect(&self, work: f64) {
        self.progress().work = [0.0, work];
    }

    fn advance(&self, work: f64) {
        self.progress().work[0] += work;
    }

    fn warn(&self, line: &str) {
        self.progress().notes.push(line.into());
    }

    fn note(&self, line: &str) -> Result<(), Failure> {
        self.warn(line);
        Ok(())
    }
}

/// A measurement on its own thread, which ends when this is dropped.
struct Job {
    question: Question,
    of: String,
    watch: Arc<MeasuringMonitor>,
    answer: Receiver<Result<Answer, Failure>>,
}

impl Drop for Job {
    fn drop(&mut self) {
        self.watch.stopped.store(true, Ordering::Relaxed);
    }
}

/// What is asked and answered about the scene.
pub struct Measuring {
    /// Function that answers; `None` where nothing can be measured.
    pub answerer: Option<Answerer>,
    /// The question that is shown.
    pub question: Question,
    /// Negative decimal logarithm of the error of a choice or of a simpler scene (m).
    pub digits: i32,
    /// Whether computing times are measured, instead of evaluations.
    pub timed: bool,
    /// Whether the scene is measured from its beginning, instead of its present state.
    pub from_start: bool,
    job: Option<Job>,
    known: [Option<Known>; Question::ALL.len()],
}

impl Default for Measuring {
    fn default() -> Self {
        Self {
            answerer: None,
            question: Question::default(),
            digits: 3,
            timed: false,
            from_start: false,
            job: None,
            known: Default::default(),
        }
    }
}

impl Measuring {
    /// Returns the error of a choice or of a simpler scene (m).
    pub fn error(&self) -> f64 {
        // A power of ten as it would be typed.
        format!("1e-{}", self.digits).parse().unwrap_or(1e-3)
    }

    /// Returns the answer to the question that is shown, if there is one.
    pub fn known(&self) -> Option<&Known> {
        self.known_of(self.question)
    }

    /// Returns the answer to a question, if there is one.
    pub fn known_of(&self, question: Question) -> Option<&Known> {
        self.known[question as usize].as_ref()
    }

    /// Returns the question that is being measured, and its progress; whether it was told to stop.
    pub fn progress(&self) -> Option<(Question, Progress, bool)> {
        let job = self.job.as_ref()?;
        let progress = job.watch.progress().clone();
        Some((job.question, progress, !job.watch.go_on()))
    }

    /// Starts to answer a question about a scene, which `of` describes. A measurement that is going
    /// on is dropped.
    ///
    /// # Errors
    /// There are no threads.
    pub fn begin(&mut self, task: Task, of: String) -> Result<(), String> {
        let Some(answerer) = self.answerer else {
            return Err("Only the program measures: key y copies the command line for it.".into());
        };
        let (watch, (sender, answer)) = (Arc::new(MeasuringMonitor::default()), channel());
        let question = task.question;
        self.job = Some(Job { question, of, watch: watch.clone(), answer });
        let work = move || {
            let answer = in_own_pool(|| answerer(&task, &*watch));
            let notes = std::mem::take(&mut watch.progress().notes);
            let answer = answer.map(|answer| Answer { notes, ..answer });
            // If nobody waits any longer, the answer is dropped.
            let _ = sender.send(answer);
        };
        if thread::Builder::new().spawn(work).is_err() {
            self.job = None;
            return Err("There are no threads here to measure on.".into());
        }
        self.known[question as usize] = None;
        Ok(())
    }

    /// Tells the measurement to stop. Its answer is what was measured until then.
    pub fn stop(&self) {
        if let Some(job) = &self.job {
            job.watch.stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Collects the answer, if it has come.
    pub fn update(&mut self) {
        let Some(job) = &self.job else {
            return;
        };
        let answer = match job.answer.try_recv() {
            Ok(Err(Failure::Interrupted(_))) => None,
            Ok(answer) => Some(answer.map_err(|failure| failure.to_string())),
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => Some(Err("the measurement failed".into())),
        };
        let known = answer.map(|answer| Known { of: job.of.clone(), answer });
        self.known[job.question as usize] = known;
        self.job = None;
    }

    /// Forgets all answers, and ends the measurement.
    pub fn forget(&mut self) {
        (self.job, self.known) = (None, Default::default());
    }
}

/// Calls a function in its own pool of threads, which leaves a processor to the window: the window
/// does not wait for it.
fn in_own_pool(work: impl FnOnce() -> Result<Answer, Failure> + Send) -> Result<Answer, Failure> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads((processors - 1).max(1)).build();
    pool.map_err(Failure::run)?.install(work)
}

/// A question about a scene, which a command answers too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Question {
    /// How fast and how accurate is each solver?
    #[default]
    Chart,
    /// What is the largest stable step of each solver?
    Stability,
    /// Which solver is the cheapest for an error?
    Choose,
    /// What can be left out for an error?
    Simplify,
}

impl Question {
    /// All questions, in the order of their buttons.
    pub const ALL: [Self; 4] = [Self::Chart, Self::Stability, Self::Choose, Self::Simplify];

    /// Returns the question in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Chart => "Chart this scene",
            Self::Stability => "Where does it fail?",
            Self::Choose => "Which solver?",
            Self::Simplify => "What can be left out?",
        }
    }

    /// Returns the question `by` places after this one, or before it if `by` is negative.
    pub fn neighbour(self, by: isize) -> Self {
        let count = Self::ALL.len() as isize;
        Self::ALL[(self as isize + by).rem_euclid(count) as usize]
    }

    /// Says what the answer tells.
    pub fn about(self) -> &'static str {
        match self {
            Self::Chart => {
                "Runs every solver with longer and shorter steps, and measures the true error and the cost of each run. \
                 Click on a point of the chart to run that solver and step beside the present one."
            }
            Self::Stability => {
                "Finds the largest step with which each solver stays stable, at rest and in motion, and says what \
                 would grow beyond it."
            }
            Self::Choose => {
                "Finds the solver and the step that keep the error within a limit at the least cost."
            }
            Self::Simplify => {
                "Leaves out each part of the scene and changes its grid, and tells what can go for an error, and what \
                 that saves."
            }
        }
    }
}

/// A question with all that its answer depends on.
pub struct Task {
    pub question: Question,
    /// The scene.
    pub request: Request,
    /// Largest error of a choice or of a simpler scene (m).
    pub error: f64,
    /// Whether computing times are measured, instead of evaluations.
    pub timed: bool,
}

/// Function that answers a question, as a command does.
pub type Answerer = fn(&Task, &dyn Monitor) -> Result<Answer, Failure>;

/// A method with its step or tolerance.
pub type MethodSetting = (&'static Method, Control);

/// Answer to a question.
#[derive(Default)]
pub struct Answer {
    /// The answer as a table.
    pub report: Report,
    /// Method and setting of each row of the table after its heading, if the rows are a choice.
    pub offers: Vec<MethodSetting>,
    /// Speed against accuracy, if that was asked.
    pub diagram: Option<Diagram>,
    /// Scene file of the leanest scene, if it differs from the scene.
    pub lean: Option<String>,
    /// Remarks and warnings of the measurement.
    pub notes: Vec<String>,
    /// Whether all was measured; false if the measurement was stopped.
    pub complete: bool,
}

/// A work-precision diagram with a single panel.
pub struct Diagram {
    pub chart: WorkPrecision,
    /// Method and setting of each run, by curve.
    pub runs: Vec<Vec<MethodSetting>>,
}

#[cfg(test)]
mod tests {
    use a3_files::report::Report;
    use a3_files::setup::{Request, SceneOptions};
    use web_time::{Duration, Instant};

    use super::*;

    fn task() -> Task {
        Task {
            question: Question::Choose,
            request: Request::read("pendulum", SceneOptions::default()).unwrap(),
            error: 1e-3,
            timed: false,
        }
    }

    fn answer(measuring: &mut Measuring) {
        let begun = Instant::now();
        while measuring.progress().is_some() {
            assert!(begun.elapsed() < Duration::from_secs(20));
            thread::sleep(Duration::from_millis(2));
            measuring.update();
        }
    }

    /// Works until it is stopped, and answers with what it was asked.
    fn endless(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
        monitor.expect(4.0);
        monitor.advance(1.0);
        monitor.stage("waiting");
        monitor.note("a remark")?;
        while monitor.go_on() {
            thread::sleep(Duration::from_millis(1));
        }
        let head = format!("{:?} {}", task.question, task.error);
        Ok(Answer { report: Report { head, ..Report::default() }, ..Answer::default() })
    }

    #[test]
    fn a_measurement_shows_its_progress_and_can_be_stopped() {
        let mut measuring = Measuring {
            answerer: Some(endless),
            question: Question::Choose,
            ..Measuring::default()
        };
        measuring.begin(task(), "a pendulum".into()).unwrap();
        let begun = Instant::now();
        while measuring.progress().unwrap().1.stage != "waiting" {
            assert!(begun.elapsed() < Duration::from_secs(20));
        }
        let (question, progress, stopping) = measuring.progress().unwrap();
        assert_eq!((question, progress.share(), stopping), (Question::Choose, 0.25, false));
        measuring.update();
        assert!(measuring.progress().is_some() && measuring.known().is_none());
        measuring.stop();
        answer(&mut measuring);
        let known = measuring.known().unwrap();
        let found = known.answer.as_ref().unwrap();
        assert_eq!((&*known.of, &*found.report.head), ("a pendulum", "Choose 0.001"));
        assert!(found.notes == ["a remark"] && !found.complete);
        measuring.forget();
        assert!(measuring.known().is_none());
    }

    #[test]
    fn a_failure_is_the_answer_unless_it_was_stopped() {
        let mut measuring = Measuring {
            answerer: Some(|_, _| Err(Failure::run("nothing moves"))),
            question: Question::Choose,
            ..Measuring::default()
        };
        measuring.begin(task(), String::new()).unwrap();
        answer(&mut measuring);
        let known = measuring.known().unwrap();
        assert_eq!(known.answer.as_ref().err().unwrap(), "nothing moves");
        measuring.answerer = Some(|_, _| Err(Failure::Interrupted("stopped".into())));
        measuring.begin(task(), String::new()).unwrap();
        answer(&mut measuring);
        assert!(measuring.known().is_none());
        measuring.answerer = None;
        assert!(measuring.begin(task(), String::new()).is_err());
    }
}
