//! A system of first order from a function.

use std::sync::Arc;

use crate::error::{Error, positive};
use crate::failure::{Failure, Outcome};
use crate::scene::Model;
use crate::system::{ParticleSystem, evaluation_cost};

/// Function of t and y that writes numbers.
type Function = dyn Fn(f64, &[f64], &mut [f64]) -> Result<(), String> + Send + Sync;

/// System of first order, y' = f(t, y), whose f is a function. Its numbers have no unit that is
/// known, and errors are those of its state.
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
    f: Box<Function>,
    jacobian: Option<Box<Function>>,
    scales: Vec<f64>,
    quantities: Option<(usize, Box<Function>)>,
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
            jacobian: None,
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
            jacobian: Some(Box::new(move |t, y, out| jacobian(t, y, out).outcome())),
            ..self
        }
    }

    /// Sets the cost of an evaluation of f, in multiplications of two numbers within long rows:
    /// 150, and 10 for each number, by default. The linear algebra of implicit methods is counted
    /// as work by it.
    ///
    /// # Errors
    /// The cost is not a finite number above 0.
    pub fn with_evaluation_cost(self, evaluation_cost: f64) -> Result<Self, Error> {
        positive("the cost of an evaluation", evaluation_cost)?;
        Ok(Self {
            evaluation_cost,
            ..self
        })
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
        Ok(Self {
            jumps: times,
            ..self
        })
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
        Ok(Self {
            quantities: Some((count, Box::new(write))),
            ..self
        })
    }

    /// Returns whether f(t, y) is finite.
    fn is_defined(&self, t: f64, y: &[f64]) -> bool {
        let mut dydt = vec![0.0; self.dim];
        (self.f)(t, y, &mut dydt).is_ok() && dydt.iter().all(|f| f.is_finite())
    }
}

impl ParticleSystem for Ode {
    fn dim(&self) -> usize {
        self.dim
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.failure.guard(dydt, |dydt| (self.f)(t, y, dydt));
    }

    fn jacobian(&self, t: f64, y: &[f64], out: &mut [f64]) -> bool {
        let Some(jacobian) = &self.jacobian else {
            return false;
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
