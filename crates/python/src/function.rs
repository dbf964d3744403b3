//! Functions of Python that a3 calls: their arguments, their results and their exceptions.

use std::cell::OnceCell;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use super::arrays;
use super::errors::wrong;

/// The first exception of functions that take part in a piece of work, and the threads that are in
/// these functions. The work ends with a text in place of the exception, and then that is raised.
#[derive(Clone, Default)]
pub struct Raised(Arc<Calls>);

#[derive(Default)]
struct Calls {
    error: Mutex<Option<PyErr>>,
    /// Numbers of the threads, as Python has them.
    threads: Mutex<Vec<u64>>,
}

thread_local! {
    /// Number of this thread.
    static THREAD: OnceCell<u64> = const { OnceCell::new() };
}

/// Returns the number of this thread, by which Python interrupts it.
fn thread(py: Python<'_>) -> u64 {
    let ask = || py.import("threading")?.call_method0("get_ident")?.extract();
    THREAD.with(|thread| *thread.get_or_init(|| ask().unwrap_or_default()))
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Raised {
    /// Keeps an exception, unless one is kept already. Returns its text.
    pub fn keep(&self, error: PyErr) -> String {
        let text = error.to_string();
        locked(&self.0.error).get_or_insert(error);
        text
    }

    /// Takes the exception.
    pub fn take(&self) -> Option<PyErr> {
        locked(&self.0.error).take()
    }

    /// Returns the threads that are in functions now.
    pub fn threads(&self) -> Vec<u64> {
        locked(&self.0.threads).clone()
    }
}

/// Shape of the array that a function returns.
#[derive(Clone, Copy)]
pub enum Shape {
    /// A flat array.
    Flat,
    /// This number of flat arrays, one after the other.
    Table(usize),
    /// A square matrix for a flat array.
    Square,
    /// A row of three numbers for each particle, of what a3 has column by column.
    Rows,
    /// A number.
    Number,
}

/// A function of Python.
pub struct Function {
    call: Py<PyAny>,
    /// Name, for errors.
    name: String,
    shape: Shape,
    raised: Raised,
}

impl Function {
    /// Takes a function whose exceptions are kept in `raised`.
    pub fn new(call: &Bound<PyAny>, shape: Shape, raised: &Raised) -> PyResult<Self> {
        if !call.is_callable() {
            let why = format!("a function is expected, not {}", kind(call));
            return Err(wrong(call.py(), why));
        }
        let name = call.getattr("__name__").and_then(|name| name.extract());
        let name = name.ok().filter(|name| name != "<lambda>");
        Ok(Self {
            call: call.clone().unbind(),
            name: name.unwrap_or_else(|| "the function".into()),
            shape,
            raised: raised.clone(),
        })
    }

    /// Writes the numbers that the function returns for a time (s) and a flat array to `out`.
    ///
    /// # Errors
    /// It raised an exception, which is kept, or returned something else than so many numbers.
    pub fn of_state(&self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), String> {
        Python::attach(|py| self.call(py, Ok((t, arrays::numbers(py, y))), out))
    }

    /// Writes the numbers that the function returns for a time (s) and two arrays of rows to `out`.
    ///
    /// # Errors
    /// As [`of_state`](Self::of_state).
    pub fn of_motion(&self, t: f64, x: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), String> {
        Python::attach(|py| {
            let arrays = arrays::rows(py, x).and_then(|x| Ok((t, x, arrays::rows(py, v)?)));
            self.call(py, arrays, out)
        })
    }

    /// Adds the rows, columns and values that the function returns for a time and a flat array, an
    /// array 3 x n, to `entries`.
    ///
    /// # Errors
    /// It raised an exception, which is kept, or returned something else.
    pub fn entries_of_state(
        &self,
        t: f64,
        y: &[f64],
        entries: &mut Vec<(u32, u32, f64)>,
    ) -> Result<(), String> {
        Python::attach(|py| {
            self.called(py, Ok((t, arrays::numbers(py, y))), |result| {
                let array = array(result).ok_or_else(|| wrong(py, kind(result)))?;
                let numbers = array.readonly();
                let numbers: Vec<f64> = numbers.as_array().iter().copied().collect();
                let (rows, others) = numbers.split_at(numbers.len() / 3);
                let (columns, values) = others.split_at(rows.len());
                let places = rows.iter().zip(columns).zip(values);
                entries.extend(places.map(|((i, j), value)| (*i as u32, *j as u32, *value)));
                Ok(())
            })
        })
    }

    /// Writes the numbers that the function returns for these arguments to `out`.
    ///
    /// # Errors
    /// As [`of_state`](Self::of_state).
    pub fn call<'py>(
        &self,
        py: Python<'py>,
        arguments: PyResult<impl PyCallArgs<'py>>,
        out: &mut [f64],
    ) -> Result<(), String> {
        let read = |result: &Bound<'py, PyAny>| read(result, &self.name, self.shape, out);
        self.called(py, arguments, read)
    }

    /// Calls the function with these arguments, and reads its result.
    fn called<'py>(
        &self,
        py: Python<'py>,
        arguments: PyResult<impl PyCallArgs<'py>>,
        read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<()>,
    ) -> Result<(), String> {
        let (calls, thread) = (&self.raised.0, thread(py));
        locked(&calls.threads).push(thread);
        let called = arguments.and_then(|arguments| self.call.bind(py).call1(arguments));
        let mut threads = locked(&calls.threads);
        if let Some(k) = threads.iter().rposition(|other| *other == thread) {
            threads.swap_remove(k);
        }
        drop(threads);
        let read = called.and_then(|result| read(&result));
        read.map_err(|error| self.raised.keep(error))
    }
}

/// Writes the numbers of an array, or of what can be made one, to `out`. `name` is that of the
/// function that returned it.
fn read(result: &Bound<PyAny>, name: &str, shape: Shape, out: &mut [f64]) -> PyResult<()> {
    let expected: &[usize] = match shape {
        Shape::Flat => &[out.len()],
        Shape::Table(rows) => &[rows, out.len() / rows],
        Shape::Square => &[out.len().isqrt(); 2],
        Shape::Rows => &[out.len() / 3, 3],
        Shape::Number => &[],
    };
    let refuse = |found: &str| {
        let wanted = match expected {
            [] => "a number".into(),
            shape => format!("an array of shape {}", tuple(shape)),
        };
        let why = format!("{name} returned {found}, where {wanted} is expected");
        wrong(result.py(), why)
    };
    let array = array(result).ok_or_else(|| refuse(&kind(result)))?;
    if array.shape() != expected {
        let found = tuple(array.shape());
        return Err(refuse(&format!("an array of shape {found}")));
    }
    let readable = array.readonly();
    // A slice of an array in Fortran's order has its numbers in another order.
    let numbers = readable.as_slice().ok().filter(|_| array.is_c_contiguous());
    match (shape, numbers) {
        (Shape::Rows, _) => {
            let n = expected[0];
            for (k, number) in readable.as_array().iter().enumerate() {
                out[k % 3 * n + k / 3] = *number;
            }
        }
        (_, Some(numbers)) => out.copy_from_slice(numbers),
        (_, None) => {
            for (out, number) in out.iter_mut().zip(readable.as_array()) {
                *out = *number;
            }
        }
    }
    Ok(())
}

/// Returns an object as an array of 64-bit numbers, if it can be made one.
pub fn array<'py>(object: &Bound<'py, PyAny>) -> Option<Bound<'py, PyArrayDyn<f64>>> {
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    if let Ok(array) = object.cast::<PyArrayDyn<f64>>() {
        return Some(array.clone());
    }
    let as_array = AS_ARRAY.import(object.py(), "numpy", "asarray").ok()?;
    let array = as_array.call1((object,)).ok()?;
    // Of complex numbers, half would be lost.
    let array = array.call_method1("astype", ("float64", "C", "same_kind"));
    array.ok()?.cast_into().ok()
}

/// Returns the name of an object's type, for errors.
fn kind(object: &Bound<PyAny>) -> String {
    let name = object.get_type().name();
    name.map_or_else(|_| "something else".into(), |name| name.to_string())
}

/// Returns a shape as Python writes it.
fn tuple(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        shape => {
            let numbers: Vec<_> = shape.iter().map(ToString::to_string).collect();
            format!("({})", numbers.join(", "))
        }
    }
}
