//! The program, as the script that `pip` puts on the path runs it.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command of a command line, and returns the exit code of the program.
#[pyfunction]
pub fn main(py: Python<'_>, args: Vec<OsString>) -> u8 {
    py.detach(|| a3::run(&args))
}
