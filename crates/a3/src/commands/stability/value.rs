//! The limits of methods on a scene as values.

use a3_core::stability::{Growth, Mode};
use a3_core::{Method, Scene};
use a3_plot::Figure;

use super::limits::Stability;
use super::measure::measure;
use super::{data, picture, table};
use crate::base::failure::Failure;
use crate::base::monitor::Monitor;
use crate::base::report::Report;
use crate::commands::chart::{Label, check_methods, check_scene};

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
        for mode in self.at_start.iter().filter(|mode| mode.returns()) {
            let mut growth = Growth::new(method, *mode).map_err(Failure::usage)?;
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
    pub(crate) fn reasons(&self) -> Report {
        table::reasons(self)
    }

    /// Returns the limits as a JSON array of objects, in seconds, as `a3 stability --data` writes
    /// them.
    ///
    /// # Errors
    /// Never for limits that were measured.
    pub fn json(&self) -> Result<String, Failure> {
        data::json(&self.limits)
    }

    /// Draws the stability regions on a sheet of this width and height (px, 96 to the inch), with
    /// the eigenvalues at the start times a step (s): by default the time in which the fastest
    /// motion turns by one radian.
    ///
    /// # Errors
    /// The picture does not fit on the sheet.
    pub fn figure(&self, step: Option<f64>, width: u32, height: u32) -> Result<Figure, Failure> {
        let fastest = self.fastest(&self.at_start);
        let fastest = fastest
            .or(self.at_start.first())
            .map_or(1.0, Mode::frequency);
        let h = step.unwrap_or_else(|| format!("{:.1e}", 1.0 / fastest).parse().unwrap_or(1.0));
        let title = format!("Where solvers fail: {}", self.title);
        let regions = picture::chart(title, &self.limits, &self.at_start, h);
        let figure = regions.draw(f64::from(width), f64::from(height));
        figure.map_err(Failure::usage)
    }
}
