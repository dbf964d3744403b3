//! The compiled part of the Python module `a3_simulator`. The rest of it, in
//! `python/a3_simulator`, gives these functions their final form; `_a3.pyi` describes them.

// A pyfunction owns the arguments that it converts.
#![allow(clippy::needless_pass_by_value)]

mod arrays;
mod driving;
mod errors;
mod function;
mod measures;
mod monitor;
mod own_method;
mod own_system;
#[cfg(feature = "program")]
mod program;
mod run;
mod scene;
mod tables;
mod turns;

/// The compiled part of `a3_simulator`.
#[pyo3::pymodule]
mod _a3 {
    #[pymodule_export]
    use super::measures::{Chart, Stability, chart, choose, compare, judge, stability};
    #[pymodule_export]
    use super::measures::{Simplified, simplify};
    #[pymodule_export]
    use super::monitor::Monitor;
    #[pymodule_export]
    use super::own_method::{Derivative, add_adaptive, add_foreign, add_method, add_tableau};
    #[cfg(feature = "program")]
    #[pymodule_export]
    use super::program::main;
    #[pymodule_export]
    use super::run::Run;
    #[pymodule_export]
    use super::tables::{methods, scenes, table};
}
