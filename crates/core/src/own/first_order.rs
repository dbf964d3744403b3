//! A system of first order from a function.

use std::sync::Arc;

use crate::error::{Error, positive};
use crate::failure::{Failure, Outcome};
use crate::scene::Model;
use crate::system::{ParticleSystem, evaluation_cost};

/// Function of t and y that writes numbers.
type RateFunction = dyn Fn(f64, &[f64], &mut [f64]) -> Result<(), String> + Send + Sync;
/// Function of t and y that adds the row, the column and the value of each entry of a matrix.
type Entries = dyn Fn(f64, &[f64], &mut Vec<(u32, u32, f64)>) -> Result<(), String> + Send + Sync;

/// The Jacobian as a function.
enum JacobianFunction {
    Unknown,
    Full(Box<RateFunction>),
    Sparse(Box<Entries>),
}

/// System of first order, y' = f(t, y) or M y' = f(t, y), whose f is a function. Its numbers have
/// no unit that is known, and errors are those of its state.
///
/// Van der Pol's oscillator, with its Jacobian:
///
/// ```
/// use a3_core::{Ode, ParticleSystem, integrators};
///
/// let mu = 5.0;
/// let oscillator = Ode::new(2, move |_t, y, dydt| {
///     dydt[0] = y[1];
///     dydt[1] = mu * (1.0 - y[0] * y[0]) * y[1] - y[0];
/// })?
/// .with_jacobian(move |_t, y, jacobian| {
///     jacobian[..2].copy_from_slice(&[0.0, 1.0]);
///     let slopes = [-2.0 * mu * y[0] * y[1] - 1.0, mu * (1.0 - y[0] * y[0])];
///     jacobian[2..].copy_from_slice(&slopes);
/// });
///
/// let mut method = integrators::find("implicit-midpoint").unwrap().integrator(&oscillator)?;
/// let mut y = [2.0, 0.0];
/// method.step(&oscillator, 0.0, 0.01, &mut y)?;
/// // Near 2, v' = -15 v - 2.
/// assert!((y[1] + 2.0 / 15.0 * (1.0 - (-0.15_f64).exp())).abs() < 1e-4);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct Ode {
    dim: usize,
    f: Box<RateFunction>,
    jacobian: JacobianFunction,
    /// Row and column of each entry of the Jacobian that may differ from 0, if they are known.
    sparsity: Vec<(u32, u32)>,
    /// Row, column and value of each entry of the mass matrix, column by column; empty if it is 1.
    mass: Vec<(u32, u32, f64)>,
    scales: Vec<f64>,
    quantities: Option<(usize, Box<RateFunction>)>,
    /// Times at which f jumps (s), in order.
    jumps: Vec<f64>,
    evaluation_cost: f64,
    failure: Failure,
}

impl Ode {
    /// Creates a system of `dim` numbers from a function that writes f(t, y) to its last argument,
    /// and may fail. What it writes must depend on t and y alone.
    ///
    /// # Errors
    /// `dim` is 0.
    pub fn new<R: Outcome>(
        dim: usize,
        f: impl Fn(f64, &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        if dim == 0 {
            return Err(Error::Invalid("a system needs at least one number".into()));
        }
        Ok(Self {
            dim,
            f: Box::new(move |t, y, dydt| f(t, y, dydt).outcome()),
            jacobian: JacobianFunction::Unknown,
            sparsity: vec![],
            mass: vec![],
            scales: vec![],
            quantities: None,
            jumps: vec![],
            evaluation_cost: evaluation_cost(dim),
            failure: Failure::default(),
        })
    }

    /// Adds the Jacobian: a function that writes df/dy, row by row, to its last argument. Without
    /// it, implicit methods and stability take differences of f; of a system of more than 1024
    /// numbers they always do.
    #[must_use]
    pub fn with_jacobian<R: Outcome>(
        self,
        jacobian: impl Fn(f64, &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Self {
        Self {
            jacobian: JacobianFunction::Full(Box::new(move |t, y, out| {
                jacobian(t, y, out).outcome()
            })),
            ..self
        }
    }

    /// Adds the Jacobian of a system of any number of numbers: a function that adds the row, the
    /// column and the value of each entry of df/dy that is not 0 to its last argument, and may
    /// fail. Values of the same place are added up.
    #[must_use]
    pub fn with_jacobian_entries<R: Outcome>(
        self,
        entries: impl Fn(f64, &[f64], &mut Vec<(u32, u32, f64)>) -> R + Send + Sync + 'static,
    ) -> Self {
        Self {
            jacobian: JacobianFunction::Sparse(Box::new(move |t, y, out| {
                entries(t, y, out).outcome()
            })),
            ..self
        }
    }

    /// Sets the row and the column of each entry of the Jacobian that may differ from 0: implicit
    /// methods then take few differences of f, and need not search which. Entries that are missing
    /// are found where a change of all numbers shows it.
    ///
    /// # Errors
    /// A row or a column is not one of the system.
    pub fn with_sparsity(self, mut entries: Vec<(u32, u32)>) -> Result<Self, Error> {
        let dim = self.dim;
        if let Some(wrong) = entries.iter().find(|entry| is_outside(dim, **entry)) {
            return Err(Error::Invalid(outside("the Jacobian", dim, *wrong)));
        }
        entries.sort_unstable_by_key(|(row, column)| (*column, *row));
        entries.dedup();
        Ok(Self { sparsity: entries, ..self })
    }

    /// Makes the system M y' = f(t, y), with a constant matrix M: the row, the column and the value
    /// of each entry that is not 0. Values of the same place are added up. Radau IIA and BDF solve
    /// such systems, also where M is singular and the equations without a derivative determine the
    /// numbers that the others leave open (index 1); see
    /// [`mass_matrix`](ParticleSystem::mass_matrix).
    ///
    /// A reaction whose last equation keeps the sum of all substances:
    ///
    /// ```
    /// use a3_core::integrators::{self, Tolerance};
    /// use a3_core::Ode;
    ///
    /// let reaction = Ode::new(2, |_t, y, f| {
    ///     f[0] = -y[0];
    ///     f[1] = y[0] + y[1] - 1.0;
    /// })?
    /// .with_mass_matrix(vec![(0, 0, 1.0)])?;
    /// let radau = integrators::find("radau").unwrap();
    /// let mut radau = radau.adaptive(&reaction, Tolerance::new(1e-8)?).unwrap();
    /// let (mut t, mut y) = (0.0, [1.0, 0.0]);
    /// while t < 1.0 {
    ///     t += radau.advance(&reaction, t, 1.0 - t, &mut y)?.h;
    /// }
    /// assert!((y[1] - (1.0 - f64::exp(-1.0))).abs() < 1e-8);
    /// # Ok::<(), a3_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// A row or a column is not one of the system, a value is not finite, or all are 0.
    pub fn with_mass_matrix(self, mut entries: Vec<(u32, u32, f64)>) -> Result<Self, Error> {
        let place = |(i, j, _): &(u32, u32, f64)| (*j, *i);
        for (i, j, value) in &entries {
            if is_outside(self.dim, (*i, *j)) {
                let why = outside("the mass matrix", self.dim, (*i, *j));
                return Err(Error::Invalid(why));
            }
            if !value.is_finite() {
                let why = format!("the mass matrix is {value} in row {i} and column {j}");
                return Err(Error::Invalid(why));
            }
        }
        entries.sort_by_key(place);
        entries.dedup_by(|next, first| {
            let is_same = place(next) == place(first);
            first.2 += if is_same { next.2 } else { 0.0 };
            is_same
        });
        entries.retain(|(.., value)| *value != 0.0);
        if entries.is_empty() {
            let why = "the mass matrix is 0: then f(t, y) = 0 has no time in which to step";
            return Err(Error::Invalid(why.into()));
        }
        let is_one = |(k, entry): (u32, &(u32, u32, f64))| *entry == (k, k, 1.0);
        if entries.len() == self.dim && (0..).zip(&entries).all(is_one) {
            entries.clear();
        }
        Ok(Self { mass: entries, ..self })
    }

    /// Sets the cost of an evaluation of f, in multiplications of two numbers within long rows:
    /// 150, and 10 for each number, by default. The linear algebra of implicit methods is counted
    /// as work by it.
    ///
    /// # Errors
    /// The cost is not a finite number above 0.
    pub fn with_evaluation_cost(self, evaluation_cost: f64) -> Result<Self, Error> {
        positive("the cost of an evaluation", evaluation_cost)?;
        Ok(Self { evaluation_cost, ..self })
    }

    /// Sets the least size of each number to which errors are relative. By default, adaptive
    /// methods allow a number an error relative to the largest size that it has had, and a tiny
    /// absolute one besides.
    ///
    /// # Errors
    /// There are not as many sizes as numbers, or one is not a finite number above 0.
    pub fn with_scales(self, scales: Vec<f64>) -> Result<Self, Error> {
        if scales.len() != self.dim {
            return Err(Error::Invalid(format!(
                "there are {} scales for {} numbers: give one for each",
                scales.len(),
                self.dim
            )));
        }
        for scale in &scales {
            positive("a scale", *scale)?;
        }
        Ok(Self { scales, ..self })
    }

    /// Sets the times (s) at which f or one of its derivatives jumps: a step ends at each of them,
    /// and no evaluation of it is at or after that time. So a short pulse is not missed, and each
    /// method keeps its order.
    ///
    /// # Errors
    /// A time is not finite.
    pub fn with_jumps(self, mut times: Vec<f64>) -> Result<Self, Error> {
        if let Some(time) = times.iter().find(|time| !time.is_finite()) {
            let why = format!("f jumps at finite times (s), not at {time}");
            return Err(Error::Invalid(why));
        }
        times.sort_unstable_by(f64::total_cmp);
        Ok(Self { jumps: times, ..self })
    }

    /// Sets `count` quantities by which states are compared in charts and choices, in place of
    /// their own numbers: a function of t and y that writes them to its last argument, and may
    /// fail. The error of each is relative to the largest size that it has had.
    ///
    /// # Errors
    /// There are none.
    pub fn with_quantities<R: Outcome>(
        self,
        count: usize,
        quantities: impl Fn(f64, &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        if count == 0 {
            let why = "states need at least one quantity to be compared by";
            return Err(Error::Invalid(why.into()));
        }
        let write = move |t: f64, y: &[f64], out: &mut [f64]| quantities(t, y, out).outcome();
        Ok(Self { quantities: Some((count, Box::new(write))), ..self })
    }

    /// Returns the system with the time reversed: its state at t is that of this one at -t. A
    /// solution to a time before the start is one of it.
    #[must_use]
    pub fn reversed(self) -> Self {
        let jumps: Vec<f64> = self.jumps.iter().rev().map(|t| -t).collect();
        let own = self.jumps;
        // At a jump, f is that after it: a step that comes from there needs the one before.
        let back = Arc::new(move |t: f64| if own.contains(&-t) { (-t).next_down() } else { -t });
        let reversed = |function: Box<RateFunction>, sign: f64| -> Box<RateFunction> {
            let back = back.clone();
            Box::new(move |t, y, out| {
                function(back(t), y, out)?;
                for out in out {
                    *out *= sign;
                }
                Ok(())
            })
        };
        let jacobian = match self.jacobian {
            JacobianFunction::Unknown => JacobianFunction::Unknown,
            JacobianFunction::Full(jacobian) => JacobianFunction::Full(reversed(jacobian, -1.0)),
            JacobianFunction::Sparse(write) => {
                let back = back.clone();
                JacobianFunction::Sparse(Box::new(move |t, y, entries| {
                    write(back(t), y, entries)?;
                    for entry in entries {
                        entry.2 = -entry.2;
                    }
                    Ok(())
                }))
            }
        };
        Self {
            f: reversed(self.f, -1.0),
            jacobian,
            quantities: self.quantities.map(|(count, write)| (count, reversed(write, 1.0))),
            jumps,
            ..self
        }
    }

    /// Returns whether f(t, y) is finite.
    fn is_defined(&self, t: f64, y: &[f64]) -> bool {
        let mut dydt = vec![0.0; self.dim];
        (self.f)(t, y, &mut dydt).is_ok() && dydt.iter().all(|f| f.is_finite())
    }
}

/// Returns whether a place, row and column, is outside the Jacobian of a system of `dim` numbers.
fn is_outside(dim: usize, (row, column): (u32, u32)) -> bool {
    row.max(column) as usize >= dim
}

/// Says that a place is outside a matrix of such a system.
fn outside(what: &str, dim: usize, (row, column): (u32, u32)) -> String {
    format!("{what} of {dim} numbers has no row {row} and column {column}: they begin at 0")
}

impl ParticleSystem for Ode {
    fn dim(&self) -> usize {
        self.dim
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.failure.guard(dydt, |dydt| (self.f)(t, y, dydt));
    }

    fn jacobian(&self, t: f64, y: &[f64], out: &mut [f64]) -> bool {
        let jacobian = match &self.jacobian {
            JacobianFunction::Unknown => return false,
            JacobianFunction::Sparse(_) => {
                let mut entries = vec![];
                self.jacobian_entries(t, y, &mut entries);
                out.fill(0.0);
                for (row, column, value) in entries {
                    out[row as usize * self.dim + column as usize] += value;
                }
                return true;
            }
            JacobianFunction::Full(jacobian) => jacobian,
        };
        self.failure.guard(out, |out| {
            jacobian(t, y, out)?;
            let wrong = out.iter().position(|number| !number.is_finite());
            match wrong.filter(|_| self.is_defined(t, y)) {
                Some(k) => Err(format!(
                    "the Jacobian is {} in row {} and column {} at t = {t} s, where f is finite",
                    out[k],
                    k / self.dim,
                    k % self.dim
                )),
                None => Ok(()),
            }
        });
        true
    }

    fn jacobian_entries(&self, t: f64, y: &[f64], entries: &mut Vec<(u32, u32, f64)>) -> bool {
        let JacobianFunction::Sparse(write) = &self.jacobian else {
            return false;
        };
        let mut failed = [0.0];
        self.failure.guard(&mut failed, |_| {
            write(t, y, entries)?;
            let mut places = entries.iter().map(|(i, j, _)| (*i, *j));
            if let Some(wrong) = places.find(|place| is_outside(self.dim, *place)) {
                return Err(outside("the Jacobian", self.dim, wrong));
            }
            let wrong = entries.iter().find(|(.., value)| !value.is_finite());
            match wrong.filter(|_| self.is_defined(t, y)) {
                Some((i, j, value)) => Err(format!(
                    "the Jacobian is {value} in row {i} and column {j} at t = {t} s, where f is finite"
                )),
                None => Ok(()),
            }
        });
        if failed[0].is_nan() {
            // A matrix that no method can use.
            *entries = vec![(0, 0, f64::NAN)];
        }
        true
    }

    fn sparsity(&self) -> &[(u32, u32)] {
        &self.sparsity
    }

    fn mass_matrix(&self) -> &[(u32, u32, f64)] {
        &self.mass
    }

    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn next_jump(&self, t: f64) -> f64 {
        let next = self.jumps.partition_point(|time| *time <= t);
        self.jumps.get(next).copied().unwrap_or(f64::INFINITY)
    }

    fn quantities(&self) -> usize {
        self.quantities.as_ref().map_or(0, |(count, _)| *count)
    }

    fn write_quantities(&self, t: f64, y: &[f64], out: &mut [f64]) {
        if let Some((_, write)) = &self.quantities {
            self.failure.guard(out, |out| write(t, y, out));
        }
    }

    fn evaluation_cost(&self) -> f64 {
        self.evaluation_cost
    }

    fn take_failure(&self) -> Option<Error> {
        self.failure.take()
    }
}

impl From<Ode> for Model {
    fn from(ode: Ode) -> Self {
        Self::FirstOrder(Arc::new(ode))
    }
}
