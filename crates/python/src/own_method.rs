//! Own methods: functions step(f, t, y, h) of Python that return the state at t + h; and solvers of
//! other libraries, functions that return the states at given times.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use a3_core::integrators::Derivative as CoreDerivative;
use a3_core::{Error, Method};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use scoped_tls_hkt::scoped_thread_local;

use super::arrays::numbers;
use super::errors::wrong;
use super::function::{Function, Raised, Shape, array};

/// f(t, y) of the system that is being stepped.
trait Evaluate {
    fn evaluate(&mut self, t: f64, y: &[f64]) -> Result<Vec<f64>, Error>;
}

impl Evaluate for CoreDerivative<'_> {
    fn evaluate(&mut self, t: f64, y: &[f64]) -> Result<Vec<f64>, Error> {
        self.at(t, y)
    }
}

scoped_thread_local!(static mut STEPPED: for<'a> &'a mut (dyn Evaluate + 'a));

/// The function f that a step gets: f(t, y) is the derivative of the state y at time t (s).
#[pyclass(frozen, name = "Derivative", module = "a3_simulator._a3")]
pub struct Derivative;

#[pymethods]
impl Derivative {
    /// Returns f(t, y), an array of the length of y.
    #[expect(clippy::unused_self, reason = "the system is that of the thread")]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        t: f64,
        y: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        if !STEPPED.is_set() {
            return Err(wrong(
                py,
                "f can be called only while its step is being taken, in the same thread",
            ));
        }
        let array =
            array(y).ok_or_else(|| wrong(py, "f(t, y) takes a time and an array of numbers"))?;
        // A column of a matrix is not contiguous.
        let y: Vec<f64> = array.readonly().as_array().iter().copied().collect();
        let evaluated = py.detach(|| STEPPED.with(|f| f.evaluate(t, &y)));
        let dydt =
            evaluated.map_err(|error| super::errors::of_error(py, &error, error.to_string()))?;
        Ok(numbers(py, &dydt))
    }
}

/// Registers a method. `step` is called with f, t (s), the state y and h (s), and returns the state
/// at t + h.
#[pyfunction]
pub fn add_method(
    py: Python<'_>,
    name: &str,
    step: &Bound<PyAny>,
    order: u32,
    evaluations: u32,
    default_step: f64,
) -> PyResult<()> {
    let raised = Raised::default();
    let function = Function::new(step, Shape::Flat, &raised)?;
    let method = Method::from_step(name, order, move |f, t, y, h| {
        let mut next = vec![0.0; y.len()];
        with(f, |py| {
            let arguments = (Derivative, t, numbers(py, y), h);
            function.call(py, Ok(arguments), &mut next)
        })?;
        Ok(next)
    });
    let method = method.map_err(|error| wrong(py, error.to_string()))?;
    let method = method
        .with_evaluations(evaluations)
        .with_default_step(default_step);
    register(method, raised);
    Ok(())
}

/// Registers an explicit Runge-Kutta method by its tableau. Returns its order.
#[pyfunction]
pub fn add_tableau(
    py: Python<'_>,
    name: &str,
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
    b_hat: Option<Vec<f64>>,
) -> PyResult<u32> {
    let method = Method::from_tableau(name, &a, &b, b_hat.as_deref());
    let method = method.map_err(|error| wrong(py, error.to_string()))?;
    Ok(method.register().order)
}

/// Registers a solver of another library. `solve` is called with f, the times (s), the state at
/// time 0 and a relative tolerance, and returns the states at these times, one after another.
#[pyfunction]
pub fn add_foreign(py: Python<'_>, name: &str, solve: &Bound<PyAny>) -> PyResult<()> {
    let raised = Raised::default();
    let function = Function::new(solve, Shape::Flat, &raised)?;
    let method = Method::foreign(name, move |f, times, y, tolerance| {
        let mut states = vec![0.0; times.len() * y.len()];
        with(f, |py| {
            let arguments = (Derivative, numbers(py, times), numbers(py, y), tolerance);
            function.call(py, Ok(arguments), &mut states)
        })?;
        Ok(states)
    });
    register(
        method.map_err(|error| wrong(py, error.to_string()))?,
        raised,
    );
    Ok(())
}

/// Makes a call of a function of Python that may evaluate f.
fn with(
    f: &mut CoreDerivative,
    call: impl FnOnce(Python<'_>) -> Result<(), String>,
) -> Result<(), Error> {
    STEPPED
        .set(f, || Python::attach(call))
        .map_err(Error::Callback)
}

/// Registers a method, with the place of its exceptions.
fn register(method: Method, raised: Raised) {
    let name = method.register().name;
    let mut all = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
    all.insert(name.into(), raised);
}

/// Exceptions of own methods, by their names.
static RAISED: Mutex<BTreeMap<String, Raised>> = Mutex::new(BTreeMap::new());

/// Returns where the exceptions of an own method are kept.
pub fn raised_by(method: &Method) -> Option<Raised> {
    let all = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
    all.get(method.name).cloned()
}
