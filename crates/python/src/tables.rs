//! The tables of scenes and methods, and the keys of a scene.

use a3_core::{Control, Method, integrators};
use a3_files::failure::Failure;
use a3_scenes::{SCENES, Setup};
use pyo3::prelude::*;

use super::errors::{told, wrong};
use super::scene::source;

/// Returns the names of the built-in scenes.
#[pyfunction]
pub fn scenes() -> Vec<&'static str> {
    SCENES.iter().map(|scene| scene.name).collect()
}

/// Name, letter, title and order of a method, whether it is adaptive, and its default step (s) or
/// tolerance.
type Row = (&'static str, Option<char>, &'static str, u32, bool, f64);

/// Returns the rows of the table of methods.
#[pyfunction]
pub fn methods() -> Vec<Row> {
    let row = |method: &Method| {
        (
            method.name,
            method.letter,
            method.title,
            method.order,
            method.is_adaptive(),
            method.default_control.value(),
        )
    };
    integrators::METHODS.iter().map(row).collect()
}

/// Returns the table of the keys of a scene, as JSON. `kind` is one of "named", "toml" and "table".
#[pyfunction]
pub fn table(py: Python<'_>, kind: &str, text: &str) -> PyResult<String> {
    let table = source(kind, text).and_then(|source| source.table().map_err(Failure::Input));
    told(py, table)
}

/// Finds a method by its name or its letter.
pub fn method(py: Python<'_>, name: &str) -> PyResult<&'static Method> {
    integrators::find(name).ok_or_else(|| {
        let names = || integrators::METHODS.iter().map(|method| method.name);
        let all = names().collect::<Vec<_>>().join(", ");
        let why = match a3_scenes::nearest(name, names()) {
            Some(near) => {
                format!("there is no solver `{name}`; did you mean {near}? The solvers are {all}")
            }
            None => format!("there is no solver `{name}`; the solvers are {all}"),
        };
        wrong(py, why)
    })
}

/// Finds methods by their names or letters.
pub fn methods_named(py: Python<'_>, names: &[String]) -> PyResult<Vec<&'static Method>> {
    names.iter().map(|name| method(py, name)).collect()
}

/// Returns the step or tolerance of this value or, without one, that of the scene or the method.
pub fn control(setup: &Setup, method: &Method, value: Option<f64>) -> Control {
    let own = || setup.defaults.control_of(method);
    value.map_or_else(own, |value| method.control(value))
}
