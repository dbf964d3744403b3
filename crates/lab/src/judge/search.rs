//! The search for the method that a file agrees with, for the usual mistakes, and for the nearest
//! method.

use a3_core::integrators::METHODS;

use super::constant::MISTAKES;
use super::grid::{MIN_AT_STEPS, Pace, paces};
use super::scheme::{SCHEMES, Scheme};
use super::trial::{ComparedRows, Judged, Start, Trial, Way};

/// Least ratio of the distance moved to that at which rows agree in single precision.
const MIN_CLEAR: f64 = 100.0;
/// Largest distance of rows, over the motion, for which single precision is tried.
const NEAR_SINGLE: f64 = 1e-3;
/// Ratio of the distances of two methods from the rows, from which on the nearer one stands out.
const CLEARLY: f64 = 10.0;
/// Largest work of all trials of a kind, in springs and particles that are visited.
const MAX_WORK: f64 = 5e7;
/// Least number of rows that agree before others differ, and least ratio of the distance moved
/// until then to that at which rows agree.
const MIN_PART: (usize, f64) = (10, 1e5);
/// Largest number of particles of networks that are swept particle by particle.
const MAX_SWEPT: usize = 500;
/// Least difference of velocities, over the speed, of a file whose positions alone agree.
pub const MIN_APART: f64 = 1e-3;
/// Ratio of the distance of a way with a mistake to that of the nearest method, below which it is
/// named.
const MUCH_NEARER: f64 = 0.1;
/// Ratio of the distance of a way to that of the motion, below which it is near.
const NEAR: f64 = 0.1;

/// Agreement of a file with a way to compute its steps.
#[derive(Clone, Copy, Debug)]
pub struct Agreement {
    pub trial: Trial,
    /// Step (s).
    pub step: f64,
    pub compared: ComparedRows,
    /// Last time (s) at which it agrees, if it does not until the end.
    pub until: Option<f64>,
    /// Whether it agrees with the program in single precision.
    pub is_single: bool,
}

/// Result of the search.
#[derive(Clone, Debug, Default)]
pub struct Match {
    /// The way that the file agrees with.
    pub found: Option<Agreement>,
    /// Others that it agrees with as well.
    pub also: Vec<Agreement>,
    /// Nearest correct method, if it agrees with none.
    pub nearest: Option<Agreement>,
    /// A way with a mistake that is much nearer than that.
    pub suspect: Option<Agreement>,
    /// Longest and shortest step that were tried (s).
    pub steps: [f64; 2],
}

/// Search in progress.
struct Search<'a> {
    judged: &'a Judged<'a>,
    /// Longest agreement up to some row.
    part: Option<Agreement>,
    /// Agreements of positions alone, in a file whose velocities are others.
    positions: Vec<Agreement>,
    /// Whether the program is taken to compute in single precision.
    is_single: bool,
    /// What was found so far, with the longest and the shortest step.
    result: Match,
}

/// Part of a search: ways, starts and paces, and whether rows are compared in single precision.
type Plan<'a> = (&'a [Way], &'a [Start], &'a [Pace], bool);

/// Finds the method that the rows agree with. `None` if the monitor stopped it. `at_start`
/// tells whether the first row is the start of the scene.
pub fn search(judged: &Judged, at_start: bool) -> Option<Match> {
    let Some([whole, between]) = paces(judged.rows.grid.as_ref(), judged.course.step) else {
        return Some(Match::default());
    };
    let mut search = Search {
        judged,
        part: None,
        positions: vec![],
        is_single: false,
        result: Match { steps: [0.0, f64::INFINITY], ..Match::default() },
    };
    let (correct, slips) = (search.correct(), search.slips());
    let is_scheme = |way: &Way| matches!(way, Way::Scheme(..));
    let schemes: Vec<_> = correct.iter().copied().filter(is_scheme).collect();
    let scene = &[Start::Scene][..];
    let row = Start::Row(usize::from(at_start));
    let starts = [Start::Ahead, Start::Behind, row];
    let all = [&whole[..], &between].concat();
    let plans: [Plan; 6] = [
        (&correct, scene, &whole, false),
        (&correct, scene, &between, false),
        (&schemes, scene, &all, true),
        (&slips, scene, &whole, false),
        (&correct, &starts, &whole, false),
        (&slips, scene, &between, false),
    ];
    let mut found = vec![];
    for (k, plan) in plans.into_iter().enumerate() {
        if plan.3 && !judged.rows.are_single() {
            continue;
        }
        found = search.agreements(plan, found)?;
        // Correct methods at other steps may be much nearer than one that only is accurate.
        if let Some((first, others)) = found.split_first()
            && (k > 0 || search.bound(&found) <= 0.0)
        {
            (search.result.found, search.result.also) = (Some(*first), others.to_vec());
            return Some(search.result);
        }
        // So many rows do not agree by chance: the rest differs by rounding errors that grow.
        if found.is_empty() && search.part.is_some() {
            break;
        }
    }
    search.result.found = search.positions.first().copied().or(search.part);
    if search.result.found.is_some() {
        return Some(search.result);
    }
    let is_few = |pace: &Pace| whole.len() == 1 || pace.is_one_of_few();
    let few: Vec<_> = whole.iter().copied().filter(is_few).collect();
    let nearest = search.nearest(&correct, &few, f64::INFINITY)?;
    let far = NEAR * judged.motion;
    let bound = nearest.map_or(far, |nearest| MUCH_NEARER * nearest.compared.distance);
    // A step that was guessed may be of a wrong neighbour.
    let is_sure = |pace: Pace| whole.len() == 1 || (pace.steps, pace.points) == (1, 1);
    let is_near = |it: &Agreement| it.compared.distance < far && is_sure(it.trial.pace);
    search.result.nearest = nearest.filter(is_near);
    search.result.suspect = search.nearest(&slips, &few[..1.min(few.len())], bound.min(far))?;
    Some(search.result)
}

impl Search<'_> {
    /// Returns all solvers of a3 that support the scene, and schemes of textbooks.
    fn correct(&self) -> Vec<Way> {
        let system = self.judged.scene().model.system();
        let methods = METHODS.iter().filter(|m| m.check(system).is_ok());
        let methods = methods.filter(|m| !m.repeats_another(system));
        let schemes = self.schemes(false).map(|scheme| Way::Scheme(scheme, None));
        methods.map(Way::Method).chain(schemes).collect()
    }

    /// Returns the schemes that are slips, and those of textbooks with each mistake.
    fn slips(&self) -> Vec<Way> {
        let Some(plain) = self.judged.plain() else {
            return vec![];
        };
        let mistakes = MISTAKES.iter().map(|row| row.0);
        let mistakes = mistakes.filter(|mistake| plain.can_have(*mistake));
        let mistakes: Vec<_> = mistakes.chain(plain.changes()).collect();
        let with = self.schemes(false).flat_map(|scheme| {
            let each = mistakes.iter();
            each.map(move |mistake| Way::Scheme(scheme, Some(*mistake)))
        });
        let wrong = self.schemes(true).map(|scheme| Way::Scheme(scheme, None));
        wrong.chain(with).collect()
    }

    /// Returns the schemes that serve the scene: those with a question, or those without.
    fn schemes(&self, asked: bool) -> impl Iterator<Item = &'static Scheme> {
        let (plain, n) = (self.judged.plain(), self.judged.scene().model.particles());
        SCHEMES.iter().filter(move |scheme| {
            let is_cheap = scheme.evaluations(n) < n || n <= MAX_SWEPT;
            let serves = plain.is_some_and(|plain| scheme.serves(plain));
            scheme.question.is_some() == asked && is_cheap && serves
        })
    }

    /// Returns the ways that agree with all rows, and much better than `best`: at the largest step
    /// at which one does, or at a smaller one at which it agrees much better still. Without any,
    /// returns `best`. `None` if the monitor stopped it.
    fn agreements(
        &mut self,
        (ways, starts, paces, is_single): Plan,
        mut best: Vec<Agreement>,
    ) -> Option<Vec<Agreement>> {
        self.is_single = is_single;
        let work = &self.judged.course.work;
        work.set(0.0);
        for &pace in paces {
            let (bound, mut found) = (self.bound(&best), vec![]);
            if bound <= 0.0 {
                break;
            }
            for &start in starts {
                for &way in ways {
                    if !self.judged.course.monitor.go_on() {
                        return None;
                    }
                    if work.get() <= MAX_WORK || pace.is_one_of_few() {
                        found.extend(self.agreement(Trial { way, pace, start }, bound));
                    }
                }
            }
            if !found.is_empty() {
                best = found;
            }
        }
        let near = CLEARLY * least(&best) + self.judged.rounding(0);
        let is_near = |agreement: &Agreement| agreement.compared.distance <= near;
        if let Some(first) = best.iter().position(is_near) {
            best[..=first].rotate_right(1);
        }
        best.retain(is_near);
        Some(best)
    }

    /// Returns the distance (m) of a way that agrees much better than several others: not above 0
    /// if these differ from the rows by rounding alone.
    fn bound(&self, others: &[Agreement]) -> f64 {
        (least(others) - self.judged.rounding(0)) / CLEARLY
    }

    /// Returns the agreement of a trial with all rows to a distance (m), in the precision of the
    /// search.
    fn agreement(&mut self, trial: Trial, within: f64) -> Option<Agreement> {
        if !self.is_single {
            return self.agreement_by(self.judged, trial, within);
        }
        // A method that is far away is so in single precision, too.
        let near = |_: usize, _: f64| NEAR_SINGLE * self.judged.motion;
        let compared = self.judged.compare(trial, &near)?;
        if compared.at_steps < MIN_AT_STEPS {
            return None;
        }
        let mut single = self.judged.clone();
        single.noise = Some(self.judged.noise(trial)?);
        self.agreement_by(&single, trial, within)
    }

    /// Returns the agreement of a trial with all rows that are compared, to a distance (m). One
    /// with many of them is remembered.
    fn agreement_by(&mut self, judged: &Judged, trial: Trial, within: f64) -> Option<Agreement> {
        let bound = |k: usize, moved: f64| judged.tolerance(k, moved).min(within);
        let step = judged.step_of(trial)?;
        let [longest, shortest] = self.result.steps;
        self.result.steps = [longest.max(step), shortest.min(step)];
        if !judged.begins(trial, &bound) {
            return None;
        }
        let trial = judged.fit(trial, &bound)?;
        let compared = judged.compare(trial, &bound)?;
        let (rows, last) = (judged.rows, judged.last());
        let ends = (compared.rows < rows.len()).then(|| rows.times[compared.rows.max(1) - 1]);
        let agreement = Agreement { trial, step, compared, until: ends, is_single: self.is_single };
        let moved = compared.moved.max(judged.motion);
        let clear = moved / judged.tolerance(compared.rows.saturating_sub(1), compared.moved);
        let since = match trial.start {
            Start::Row(row) => row + 1,
            _ => 0,
        };
        let needs_more = self.is_single || trial.pace.points > 1;
        if needs_more && compared.at_steps < MIN_AT_STEPS || self.is_single && clear < MIN_CLEAR {
            return None;
        }
        if compared.rows == last {
            // A single step from a row of the file tells nothing, nor does a file of few digits in
            // which nothing moves.
            if clear <= 1.0 || matches!(trial.start, Start::Row(row) if compared.rows <= row + 2) {
                return None;
            }
            let are_others = |[apart, speed]: [f64; 2]| apart > MIN_APART * speed;
            if compared.velocities.is_some_and(are_others) {
                self.positions.push(agreement);
                return None;
            }
            return Some(agreement);
        }
        let longest = self.part.map_or(0, |part| part.compared.rows);
        if compared.rows > longest.max(since + MIN_PART.0) && clear > MIN_PART.1 {
            self.part = Some(agreement);
        }
        None
    }

    /// Returns the way whose largest distance from the rows is the least, if it is below `bound`
    /// (m). `None` if the monitor stopped it.
    #[expect(clippy::option_option, reason = "stopped, or none below the bound")]
    fn nearest(&self, ways: &[Way], paces: &[Pace], bound: f64) -> Option<Option<Agreement>> {
        let (mut nearest, mut least) = (None, bound);
        let work = &self.judged.course.work;
        work.set(0.0);
        for &pace in paces {
            if work.get() > MAX_WORK {
                break;
            }
            for &way in ways {
                if !self.judged.course.monitor.go_on() {
                    return None;
                }
                let start = Start::Scene;
                let trial = Trial { way, pace, start };
                let Some(trial) = self.judged.fit(trial, &|_, _| least) else {
                    continue;
                };
                let compared = self.judged.compare(trial, &|_, _| least);
                let is_better =
                    |it: &ComparedRows| it.rows == self.judged.rows.len() && it.distance < least;
                if let Some(compared) = compared.filter(is_better) {
                    least = compared.distance;
                    nearest = Some(Agreement {
                        trial,
                        step: self.judged.step_of(trial)?,
                        compared,
                        until: None,
                        is_single: false,
                    });
                }
            }
        }
        Some(nearest)
    }
}

/// Returns the least distance of several agreements (m); infinite without any.
fn least(agreements: &[Agreement]) -> f64 {
    let distances = agreements.iter().map(|it| it.compared.distance);
    distances.fold(f64::INFINITY, f64::min)
}
