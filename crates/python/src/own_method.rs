//! Own methods: functions step(f, t, y, h) of Python that return the state at t + h; and solvers of
//! other libraries, functions that return the states at given times.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use a3_core::integrators::Derivative as CoreDerivative;
use a3_core::{Error, Integrator, Method, ParticleSystem, Work};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;
use scoped_tls_hkt::scoped_thread_local;

use super::arrays::numbers;
use super::errors::{of_error, wrong};
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
            let why = "f can be called only while its step is being taken, in the same thread";
            return Err(wrong(py, why));
        }
        let array =
            array(y).ok_or_else(|| wrong(py, "f(t, y) takes a time and an array of numbers"))?;
        // A column of a matrix is not contiguous.
        let y: Vec<f64> = array.readonly().as_array().iter().copied().collect();
        let evaluated = py.detach(|| STEPPED.with(|f| f.evaluate(t, &y)));
        let dydt = evaluated.map_err(|error| of_error(py, &error, error.to_string()))?;
        Ok(numbers(py, &dydt))
    }
}

/// Registers a method. `step` is called with f, t (s), the state y and h (s), and returns the state
/// at t + h. A class is called once for each run, and its instance is the step of that run.
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
    let method = if step.is_instance_of::<PyType>() {
        let (class, raised) = (step.clone().unbind(), raised.clone());
        Method::new(name, order, move |_| Box::new(Begun::new(&class, &raised)))
    } else {
        let function = Function::new(step, Shape::Flat, &raised)?;
        Method::from_step(name, order, move |f, t, y, h| stepped(&function, f, (t, h), y, y.len()))
    };
    let with = |method: Method| method.with_evaluations(evaluations);
    let method = method.map(|method| with(method).with_default_step(default_step));
    register(py, method, raised).map(drop)
}

/// Registers a method that estimates its errors: `step` returns the state at t + h, the estimate,
/// and the coefficients of a polynomial of this degree within the step; of degree 0, there are
/// none.
#[pyfunction]
pub fn add_adaptive(
    py: Python<'_>,
    name: &str,
    step: &Bound<PyAny>,
    order: u32,
    evaluations: u32,
    degree: usize,
) -> PyResult<()> {
    let (raised, rows) = (Raised::default(), 2 + degree);
    let function = Function::new(step, Shape::Table(rows), &raised)?;
    let method = Method::from_estimated_step(name, order, move |f, t, y, h| {
        let found = stepped(&function, f, (t, h), y, rows * y.len())?;
        Ok(found.chunks_exact(y.len()).map(<[f64]>::to_vec).collect::<Vec<_>>())
    });
    let method = method.map(|method| method.with_evaluations(evaluations));
    register(py, method, raised).map(drop)
}

/// Returns the `count` numbers that a function returns for f, t and h (s), and the state y.
fn stepped(
    function: &Function,
    f: &mut CoreDerivative,
    (t, h): (f64, f64),
    y: &[f64],
    count: usize,
) -> Result<Vec<f64>, Error> {
    let mut next = vec![0.0; count];
    with(f, |py| {
        let arguments = (Derivative, t, numbers(py, y), h);
        function.call(py, Ok(arguments), &mut next)
    })?;
    Ok(next)
}

/// Steps of one run by an instance of a class, or the reason why there is none.
struct Begun {
    step: PyResult<Function>,
    raised: Raised,
}

impl Begun {
    fn new(class: &Py<PyAny>, raised: &Raised) -> Self {
        let begin = |py: Python| Function::new(&class.bind(py).call0()?, Shape::Flat, raised);
        Self { step: Python::attach(begin), raised: raised.clone() }
    }
}

impl Integrator for Begun {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        let function = self.step.as_ref().map_err(|why| {
            let why = Python::attach(|py| why.clone_ref(py));
            Error::Callback(self.raised.keep(why))
        })?;
        let mut f = CoreDerivative::new(system);
        let next = stepped(function, &mut f, (t, h), y, y.len())?;
        y.copy_from_slice(&next);
        Ok(f.work())
    }
}

/// Registers an explicit Runge-Kutta method by its tableau. Returns its order.
#[pyfunction]
pub fn add_tableau(
    py: Python<'_>,
    name: &str,
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
    b_hat: Option<Vec<f64>>,
    within: Vec<Vec<f64>>,
) -> PyResult<u32> {
    let method = Method::from_tableau(name, &a, &b, b_hat.as_deref(), &within);
    Ok(register(py, method, Raised::default())?.order)
}

/// Registers a solver of another library. `solve` is called with f, the times (s), the state at
/// time 0 and a relative tolerance, and returns the states at these times, one after another.
#[pyfunction]
pub fn add_foreign(py: Python<'_>, name: &str, solve: &Bound<PyAny>) -> PyResult<()> {
    let raised = Raised::default();
    let function = Function::new(solve, Shape::Flat, &raised)?;
    let of_function = raised.clone();
    let method = Method::foreign(name, move |f, times, y, tolerance| {
        let mut states = vec![0.0; times.len() * y.len()];
        let solved = with(f, |py| {
            let arguments = (Derivative, numbers(py, times), numbers(py, y), tolerance);
            function.call(py, Ok(arguments), &mut states)
        });
        if f.is_spent() {
            // That exception is a3's own.
            of_function.take();
        }
        solved.map(|()| states)
    });
    register(py, method, raised).map(drop)
}

/// Makes a call of a function of Python that may evaluate f.
fn with(
    f: &mut CoreDerivative,
    call: impl FnOnce(Python<'_>) -> Result<(), String>,
) -> Result<(), Error> {
    let called = STEPPED.set(f, || Python::attach(call));
    called.map_err(Error::Callback)
}

/// Registers a method that could be made, with the place of its exceptions.
fn register(
    py: Python<'_>,
    method: Result<Method, Error>,
    raised: Raised,
) -> PyResult<&'static Method> {
    let method = method.map_err(|error| wrong(py, error.to_string()))?.register();
    let mut all = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
    all.insert(method.name.into(), raised);
    Ok(method)
}

/// Exceptions of own methods, by their names.
static RAISED: Mutex<BTreeMap<String, Raised>> = Mutex::new(BTreeMap::new());

/// Returns where the exceptions of an own method are kept.
pub fn raised_by(method: &Method) -> Option<Raised> {
    let all = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
    all.get(method.name).cloned()
}
