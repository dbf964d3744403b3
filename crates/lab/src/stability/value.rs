//! The limits of methods on a scene as values, and the stability regions that explain them.

use a3_core::integrators::bdf_growth;
use a3_core::stability::{GROWTH, Growth, Mode, tenfold_time};
use a3_core::{Method, Scene};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::report::Report;
use a3_plot::{CurveStyle, Figure, Region, StabilityRegions};

use super::measure::{MethodLimits, Stability, measure};
use super::table;
use super::table::{INTERVAL, is_interval, observation, step};
use crate::chart::{Label, check_methods, check_scene, picture};

/// Measures the largest steps of these methods on a scene, as `a3 stability` does; of all methods
/// of the table that support the scene, if there are none. Methods are measured in parallel.
///
/// If the monitor stops the search, limits that were not found until then are `None`.
///
/// # Errors
/// A method does not support the scene, two have the same name, a callback fails, or the monitor
/// stopped before anything was found.
pub fn stability(
    scene: &Scene,
    methods: &[&'static Method],
    monitor: &dyn Monitor,
) -> Result<Stability, Failure> {
    check_scene(scene)?;
    if !scene.model.system().mass_matrix().is_empty() {
        return Err(Failure::usage(format!(
            "scene {}: with a mass matrix, methods run to tolerances alone, and no step has a limit",
            scene.name
        )));
    }
    let methods = check_methods(scene, methods)?;
    measure(scene, &Label::of(scene), &methods, monitor)
}

impl Stability {
    /// Returns the largest growth of the modes at the start in one step of h (s) of a method: at
    /// most 1 if the step is stable. Modes that grow by themselves are left out; 0 if none is left.
    ///
    /// # Errors
    /// The method does not support damped oscillations.
    pub fn growth(&self, method: &Method, h: f64) -> Result<f64, Failure> {
        let mut most = 0.0;
        for mode in self.at_start.iter().filter_map(Mode::judged) {
            let mut growth = Growth::new(method, mode).map_err(Failure::usage)?;
            most = f64::max(most, growth.of_step(h));
        }
        Ok(most)
    }

    /// Returns the table of all limits as text.
    #[must_use]
    pub fn table(&self) -> String {
        table::report(self).text()
    }

    /// Returns the largest stable step of each method with its reason.
    pub fn reasons(&self) -> Report {
        table::reasons(self)
    }

    /// Returns the limits as a JSON array of objects, in seconds, as `a3 stability --data` writes
    /// them.
    ///
    /// # Errors
    /// Never for limits that were measured.
    pub fn json(&self) -> Result<String, Failure> {
        table::json(&self.limits)
    }

    /// Draws the stability regions on a sheet of this width and height (px, 96 to the inch), with
    /// the eigenvalues at the start times a step (s): by default the time in which the fastest
    /// motion turns by one radian.
    ///
    /// # Errors
    /// The picture does not fit on the sheet.
    pub fn figure(&self, step: Option<f64>, width: u32, height: u32) -> Result<Figure, Failure> {
        let fastest = self.fastest(&self.at_start);
        let fastest = fastest.or(self.at_start.first());
        let fastest = fastest.map_or(1.0, Mode::frequency);
        let h = step.unwrap_or_else(|| format!("{:.1e}", 1.0 / fastest).parse().unwrap_or(1.0));
        let title = format!("Where solvers fail: {}", self.title);
        let regions = chart(title, &self.limits, &self.at_start, h);
        let figure = regions.draw(f64::from(width), f64::from(height));
        figure.map_err(Failure::usage)
    }
}

/// Creates the chart of stability regions, with the eigenvalues of the modes times the step h (s).
pub fn chart(title: String, rows: &[MethodLimits], modes: &[Mode], h: f64) -> StabilityRegions {
    let methods: Vec<_> = rows.iter().map(|row| row.method).collect();
    let styles = picture::each(&methods);
    let mut seen = rows.iter().filter_map(|row| row.bounded);
    let is_interval = seen.any(|seen| is_interval(&seen));
    let note = is_interval.then(|| format!("a\u{2013}b\u{a0}{INTERVAL}"));
    StabilityRegions {
        title,
        subtitle: format!(
            "Where the eigenvalues of the scene as it starts, times a step of {}\u{a0}ms, lie in each solver's stable region",
            step(h)
        ),
        note: note.unwrap_or_default(),
        regions: (rows.iter().zip(styles))
            .map(|(row, style)| region(row, style, modes, h))
            .collect(),
    }
}

/// Creates the stability region of a method.
fn region(row: &MethodLimits, style: CurveStyle, modes: &[Mode], h: f64) -> Region {
    let method = row.method;
    let is_bdf = method.name == "bdf";
    let of = ["", "region of all orders; fixed steps: "][usize::from(is_bdf)];
    let accurate = row.accurate.map_or("-".into(), step);
    let bounded = observation(row.bounded);
    let subtitle = format!("{of}bounded {bounded}\u{a0}ms, accurate {accurate}\u{a0}ms");
    // The growth of a Runge-Kutta step depends on the eigenvalues only. That of a splitting method
    // also depends on how the damping is divided between drag and springs, which is taken from the
    // fastest mode.
    let share = modes.first().map_or(0.0, |m| m.damping / (m.drag + m.damping).max(1e-300));
    let reads_velocity = modes.first().is_some_and(|m| m.reads_velocity);
    let radius = move |re: f64, im: f64| {
        // The fixed steps of BDF are those of TR-BDF2, but the chart shows its adaptive formulas.
        if is_bdf {
            return bdf_growth(re, im);
        }
        let mode = Mode::of_eigenvalue(re, im);
        let mode = Mode {
            drag: (1.0 - share) * mode.drag,
            damping: share * mode.drag,
            reads_velocity,
            ..mode
        };
        Growth::new(method, mode).map_or(f64::INFINITY, |mut growth| growth.of_step(1.0))
    };
    let judged = modes.iter().filter_map(Mode::judged);
    let eigenvalues = judged.flat_map(|mode| mode.eigenvalues());
    let eigenvalues = eigenvalues.map(|[re, im]| [h * re, h * im]);
    Region {
        style,
        title: method.title.to_owned(),
        subtitle,
        radius: Box::new(radius),
        slow: GROWTH.powf(h / tenfold_time(h)),
        eigenvalues: eigenvalues.collect(),
    }
}
