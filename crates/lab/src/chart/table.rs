//! The chart as tables: the cost of each method for each error, and the cheapest method.

use std::fmt::Write;

use a3_core::accuracy::Metric;
use a3_core::{Control, Method};
use a3_files::bounds::{LARGEST_STEP, SMALLEST_STEP};
use a3_files::report::Report;

use super::asked::{lasting, unit};
use super::measure::{Chart, Study};
use super::record::Record;

/// Decimal digits of the errors in the table, which are 1e-2 to 1e-8.
const DIGITS: std::ops::RangeInclusive<i32> = 2..=8;

/// Uncertainty of a reference, over the motion, above which a shorter run is advised.
const MAX_UNCERTAINTY: f64 = 1e-5;

/// Shortest run that is advised, over the run that was made.
const MIN_DURATION_RATIO: f64 = 0.02;

/// Largest numerator of a step that is written as a fraction.
const MAX_NUMERATOR: f64 = 9.0;

/// Writes a cost to three digits.
pub fn short(cost: f64) -> String {
    if cost < 9.995 {
        format!("{cost:.2}")
    } else if cost < 99.95 {
        format!("{cost:.1}")
    } else {
        format!("{cost:.0}")
    }
}

/// Writes a step with its unit, or a tolerance.
pub fn words(control: Control) -> String {
    let step = match control {
        Control::Tolerance(tolerance) => return format!("tolerance {tolerance:.0e}"),
        Control::Step(step) => step,
    };
    let (unit, per_second) = if step < 1e-3 { ("µs", 1e6) } else { ("ms", 1e3) };
    let rounded = (1e3 * per_second * step).round() / 1e3;
    if !(SMALLEST_STEP..=LARGEST_STEP).contains(&step) {
        return format!("step {step:.3e} s");
    }
    match fraction(step, MAX_NUMERATOR) {
        Some(fraction) if (10.0 * rounded).fract() != 0.0 => format!("step {fraction} s"),
        _ => format!("step {rounded} {unit}"),
    }
}

/// Writes a step (s) as a fraction such as 1/97, with the smallest numerator up to `max_numerator`;
/// `None` if there is none.
pub fn fraction(step: f64, max_numerator: f64) -> Option<String> {
    let part = (1..=100).map(f64::from).find(|part| {
        let steps = part / step;
        *part <= max_numerator && (steps - steps.round()).abs() < 1e-9 * steps
    })?;
    Some(format!("{part}/{}", (part / step).round()))
}

/// Advises an earlier end if the reference of a study becomes much worse from some time on. `None`
/// if the reference is good enough, or was not computed.
pub fn advice(study: &Study) -> Option<String> {
    let reference = study.reference.as_ref()?;
    let whole = reference.floor.position;
    let (time, floor) = reference.clear_until()?;
    let until = (1e2 * time).floor() / 1e2;
    (whole > MAX_UNCERTAINTY * study.motion && until >= MIN_DURATION_RATIO * study.frames.until).then(|| {
        format!(
            "what happens after {time:.2} s, such as an impact, limits the reference: with --until {until} \
             it is exact enough for errors of positions above {:.0e} m\n",
            10.0 * floor
        )
    })
}

impl Chart {
    /// Finds the cheapest run of a study whose error is at most `error`.
    fn cheapest<'a>(
        &self,
        records: impl Iterator<Item = &'a Record>,
        error: f64,
    ) -> Option<&'a Record> {
        let serves = |r: &&Record| r.lost_at.is_none() && r.error(self.metric) <= error;
        let runs = records.filter(|r| serves(r) && self.cost(r).is_finite());
        runs.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)))
    }

    /// Returns the cost of a run: its computing time (ms) if times count, or else its work in
    /// evaluations.
    fn cost(&self, record: &Record) -> f64 {
        match record.seconds {
            _ if !self.timed => record.work,
            Some(seconds) => 1e3 * seconds,
            None => f64::INFINITY,
        }
    }

    /// Returns the table of each study, with its cheapest methods below it.
    pub(super) fn reports(&self) -> Vec<Report> {
        // Plain numbers have no unit that is known.
        let unit = match self.metric {
            Metric::State => String::new(),
            metric => format!(" {}", unit(metric)),
        };
        // Longer ones would make the table too wide.
        let (of_errors, of_column) = match unit.len() {
            0..=2 => (String::new(), &*unit),
            _ => (format!(" ({})", unit.trim()), ""),
        };
        let what = if self.timed {
            "computing time (ms)"
        } else {
            "work (evaluations of the forces, linear algebra included)"
        };
        let reports = self.studies.iter().map(|study| {
            let of = if self.studies.len() == 1 && study.stiffness() == 1.0 {
                String::new()
            } else {
                format!(", stiffness x {}", study.stiffness())
            };
            let lasting = lasting(&study.scene.model, study.frames.until);
            let name = &study.scene.name;
            Report {
                head: format!(
                    "\n{what} for {lasting} of {name}{of}, to keep the error{of_errors} within\n"
                ),
                rows: self.rows(study, of_column),
                foot: self.words_of_winners(study, &unit),
            }
        });
        reports.collect()
    }

    /// Returns the rows of a study's table: a heading, and the cost of each method for each error.
    fn rows(&self, study: &Study, unit: &str) -> Vec<Vec<String>> {
        let row = |name: &str, cells: &mut dyn Iterator<Item = String>| {
            [name.to_owned()].into_iter().chain(cells).collect()
        };
        let heading = |digits: i32| format!(" 1e-{digits}{unit}");
        let mut rows = vec![row("solver", &mut DIGITS.map(heading))];
        let [resolved, _] = self.known(study);
        for method in &self.methods {
            let of = |r: &&Record| r.solver == method.name;
            let cell = |digits: i32| {
                let error = 10f64.powi(-digits);
                let own = self.cheapest(study.records(&self.data).filter(of), error);
                let all = self.cheapest(study.records(&self.data), error);
                own.map_or("-".to_owned(), |own| {
                    let is_best = all.is_some_and(|all| std::ptr::eq(all, own));
                    let is_marked = is_best && error >= resolved;
                    let mark = if is_marked { "*" } else { "" };
                    format!("{mark}{}", short(self.cost(own)))
                })
            };
            rows.push(row(method.name, &mut DIGITS.map(cell)));
        }
        rows
    }

    /// Returns the smallest error that the reference of a study can tell from 0, and the largest
    /// one that says anything: that of a run in which nothing moves.
    fn known(&self, study: &Study) -> [f64; 2] {
        let records = || study.records(&self.data);
        let resolved = records().map(|r| r.resolved(self.metric));
        let still = records().map(|r| r.still(self.metric));
        [resolved.fold(0.0, f64::max), still.fold(f64::INFINITY, f64::min)]
    }

    /// Returns each error of the tables that says something, and the cheapest run that keeps it: by
    /// computing time if that was asked for, or else by work.
    pub fn winners(&self) -> impl Iterator<Item = (f64, &Record)> {
        self.studies.iter().flat_map(move |study| {
            let [resolved, still] = self.known(study);
            let errors = DIGITS.map(|digits| 10f64.powi(-digits));
            let errors = errors.filter(move |error| (resolved..=still).contains(error));
            errors.filter_map(move |error| {
                let run = self.cheapest(study.records(&self.data), error);
                run.map(|run| (error, run))
            })
        })
    }

    /// Writes a line for each error with the cheapest method, below a note on the collision
    /// safeguard if it acted.
    fn words_of_winners(&self, study: &Study, unit: &str) -> String {
        let records = || study.records(&self.data);
        let [resolved, still] = self.known(study);
        let held = records().filter(|r| r.is_held()).count();
        let mut text = String::new();
        if held > 0 {
            let all = records().count();
            let _ = writeln!(
                text,
                "the collision safeguard acted in {held} of {all} runs, whose order is 1 there (half-filled \
                 markers)"
            );
        }
        if !study.too_costly.is_empty() {
            let names: Vec<_> = study.too_costly.iter().map(|method| method.name).collect();
            let _ = writeln!(
                text,
                "given up at smaller steps or tolerances, where runs take too many evaluations: {}",
                names.join(", ")
            );
        }
        text.push_str("* cheapest:\n");
        let line = |digits: i32| {
            let error = 10f64.powi(-digits);
            if error < resolved {
                return format!(
                    "the reference is exact enough for errors above {resolved:.0e}{unit} only"
                );
            }
            if error > still {
                return format!(
                    "nothing moves further than {still:.0e}{unit}: such an error says nothing"
                );
            }
            let Some(run) = self.cheapest(records(), error) else {
                return "no run was that accurate".to_owned();
            };
            let method = self.methods.iter().find(|m| m.name == run.solver);
            let named = |m: &&Method| format!("{}, {}", m.title, words(m.control(run.setting)));
            method.map_or(String::new(), named)
        };
        let lines: Vec<_> = DIGITS.map(|digits| (digits, line(digits))).collect();
        for same in lines.chunk_by(|a, b| a.1 == b.1) {
            let (first, last) = (same[0].0, same[same.len() - 1].0);
            let to = (first != last).then(|| format!(" to 1e-{last}"));
            let to = to.unwrap_or_default();
            let _ = writeln!(text, "  1e-{first}{to}{unit}  {}", same[0].1);
        }
        text
    }
}
