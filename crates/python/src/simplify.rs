//! What a scene can do without.

use std::path::PathBuf;

use a3_files::failure::Failure;
use a3_files::quantity::Quantity;
use a3_lab::simplify::SimplifyOptions;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::errors::{of_failure, wrong};
use super::measures::{drawn, work};
use super::monitor::Monitor;
use super::scene::{Given, Opened};

/// What a scene can do without.
#[pyclass(frozen, module = "a3_simulator._a3")]
pub struct Simplified(a3_lab::simplify::Simplified);

#[pymethods]
impl Simplified {
    /// Returns whether the chart of models was measured.
    fn has_chart(&self) -> bool {
        self.0.has_chart()
    }

    /// Returns all of it in words.
    fn text(&self) -> String {
        self.0.text()
    }

    /// Returns all of it as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        self.0.json().map_err(|failure| of_failure(py, &failure))
    }

    /// Draws a picture of the chart of models, of a kind and a size (px).
    fn drawn<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        size: (u32, u32),
    ) -> PyResult<Bound<'py, PyBytes>> {
        drawn(py, kind, size, &|width, height| {
            self.0.figure(width, height)?.ok_or_else(|| {
                Failure::usage(
                    "there is no chart: it needs chart=True, and a scene with grids that differ by less than the motion",
                )
            })
        })
    }
}

/// Finds what a scene can do without for an error.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an option")]
pub fn simplify(
    py: Python<'_>,
    given: Given,
    monitor: &Monitor,
    error: f64,
    of: &str,
    until: Option<f64>,
    particle: Option<usize>,
    at_end: bool,
    data: Option<PathBuf>,
    chart: bool,
) -> PyResult<Simplified> {
    let opened = Opened::new(py, &given)?;
    if opened.calls {
        return Err(wrong(
            py,
            "what a scene can do without is found for scenes without functions of Python",
        ));
    }
    let quantities = [Quantity::Position, Quantity::Centre, Quantity::Energy];
    let quantity = quantities.into_iter().find(|it| it.name() == of);
    let quantity = quantity.ok_or_else(|| {
        let names = quantities.map(Quantity::name).join(", ");
        wrong(
            py,
            format!("there is no quantity `{of}`: the quantities are {names}"),
        )
    })?;
    let options = SimplifyOptions {
        of: quantity,
        until,
        particle,
        at_end,
        data,
        chart,
        ..SimplifyOptions::new(error)
    };
    let scene = &opened.scene;
    work(py, &[], || {
        a3_lab::simplify::simplify(&scene.described()?, &options, monitor)
    })
    .map(Simplified)
}
