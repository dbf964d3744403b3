//! Own methods: from an integrator, or from a function that takes a step; and solvers of other
//! libraries, from a function that runs a whole span of time.

use super::derivative::Derivative;
use super::embedded::{EmbeddedPair, Tableau};
use super::integrator::{Integrator, check_dim};
use super::method::add_own;
use super::method::{Create, Method, View};
use super::own_tableau::tableau_of;
use super::table;
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Largest order of an own method, far above that of any known one.
const MAX_ORDER: u32 = 50;
/// Largest length of a name (bytes), for tables and legends.
const MAX_NAME: usize = 40;
/// Default step of an own method (s).
const DEFAULT_STEP: f64 = 1e-3;
/// Default tolerance of an own pair, and of another library's solver.
const DEFAULT_TOLERANCE: f64 = 1e-6;

/// Own methods.
impl Method {
    /// Creates an own method from its integrators: `create` makes one, with its scratch, for each
    /// system that is to be stepped. The global error falls as h to the power of `order`.
    ///
    /// Without further words it is called `name` everywhere, needs f(t, y) alone
    /// ([`View::Derivative`]), takes as many evaluations in a step as its order, and steps of 1 ms
    /// by default. What `create` holds lives as long as the program, as the rows of the table do.
    ///
    /// Symplectic Euler on the forces of a mechanical system:
    ///
    /// ```
    /// use a3_core::integrators::View;
    /// use a3_core::{Error, Integrator, Method, ParticleSystem, Work};
    ///
    /// struct Kick;
    ///
    /// impl Integrator for Kick {
    ///     fn step(
    ///         &mut self,
    ///         system: &dyn ParticleSystem,
    ///         t: f64,
    ///         h: f64,
    ///         y: &mut [f64],
    ///     ) -> Result<Work, Error> {
    ///         // `View::Kicks` grants the view of forces and masses.
    ///         let mechanics = system.mechanics().unwrap();
    ///         let (x, v) = y.split_at_mut(y.len() / 2);
    ///         let mut a = vec![0.0; v.len()];
    ///         mechanics.accelerations(t, x, v, &mut a);
    ///         for ((x, v), a) in x.iter_mut().zip(v).zip(a) {
    ///             *v += h * a;
    ///             *x += h * *v;
    ///         }
    ///         Ok(Work::of(1))
    ///     }
    /// }
    ///
    /// let method = Method::new("my-kick", 1, |_| Box::new(Kick))?
    ///     .with_title("my symplectic Euler")
    ///     .with_view(View::Kicks)
    ///     .register();
    /// assert!(a3_core::integrators::find("my-kick") == Some(method));
    /// # Ok::<(), a3_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// The name is empty, has blanks or more than 40 bytes, or is a name, an alias or a letter of
    /// the table; or the order is 0 or above 50.
    pub fn new(
        name: impl Into<String>,
        order: u32,
        create: impl Fn(&dyn ParticleSystem) -> Box<dyn Integrator> + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        Self::made(name.into(), order, Create::Own(Box::leak(Box::new(create))))
    }

    /// Creates the row of a method.
    fn made(name: String, order: u32, create: Create) -> Result<Self, Error> {
        check_name(&name, matches!(create, Create::Foreign(_)))?;
        if !(1..=MAX_ORDER).contains(&order) {
            return Err(Error::Invalid(format!(
                "the order of the method {name} must be from 1 to {MAX_ORDER}, not {order}"
            )));
        }
        let name: &str = name.leak();
        Ok(Self {
            name,
            letter: None,
            aliases: &[],
            title: name,
            order,
            default_control: Control::Step(DEFAULT_STEP),
            evaluations: order,
            damped_evaluations: order,
            view: View::Derivative,
            create,
        })
    }

    /// Creates an own method from a function that takes a step: from the [`Derivative`] f, t (s), y
    /// and h (s) it computes the state at t + h. Evaluations are counted as they are made.
    ///
    /// Heun's method:
    ///
    /// ```
    /// use a3_core::{Method, integrators};
    ///
    /// let heun = Method::from_step("my-heun", 2, |f, t, y, h| {
    ///     let a = f.at(t, y)?;
    ///     let ahead: Vec<f64> = y.iter().zip(&a).map(|(y, a)| y + h * a).collect();
    ///     let b = f.at(t + h, &ahead)?;
    ///     let slopes = a.iter().zip(&b).map(|(a, b)| 0.5 * (a + b));
    ///     Ok(y.iter().zip(slopes).map(|(y, slope)| y + h * slope).collect())
    /// })?;
    /// assert_eq!(heun.evaluations, 2);
    /// # Ok::<(), a3_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`new`](Self::new). A step fails with the error that `step` returns, which may be
    /// an [`Error::Callback`] with a text of its own, or if `step` returns a wrong number of
    /// numbers. Numbers that are not finite end a run as a blow-up.
    pub fn from_step(
        name: impl Into<String>,
        order: u32,
        step: impl Fn(&mut Derivative, f64, &[f64], f64) -> Result<Vec<f64>, Error>
        + Send
        + Sync
        + 'static,
    ) -> Result<Self, Error> {
        let name = name.into();
        let step: &'static StepFunction = Box::leak(Box::new(step));
        let named = name.clone();
        Self::new(name, order, move |system| {
            Box::new(Stepped { name: named.clone(), dim: system.dim(), step })
        })
    }

    /// Creates an own method from a function that takes a step and estimates its error, so that
    /// steps are chosen to a tolerance: from the [`Derivative`] f, t (s), y and h (s) it computes
    /// the state at t + h and the estimate, which falls as h to the power of `order`, or faster.
    /// Between the ends of a step, states are on the cubic through both or, if further vectors
    /// `q_1`, `q_2`, ... follow, at y + theta `q_1` + theta^2 `q_2` + ... with theta from 0 to 1.
    /// Their sum is the change of y in the step.
    ///
    /// Heun's method with the difference from Euler's as the estimate:
    ///
    /// ```
    /// use a3_core::Method;
    ///
    /// let pair = Method::from_estimated_step("my-pair", 2, |f, t, y, h| {
    ///     let a = f.at(t, y)?;
    ///     let ahead: Vec<f64> = y.iter().zip(&a).map(|(y, a)| y + h * a).collect();
    ///     let b = f.at(t + h, &ahead)?;
    ///     let estimate: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 0.5 * h * (b - a)).collect();
    ///     Ok([ahead.iter().zip(&estimate).map(|(y, e)| y + e).collect(), estimate])
    /// })?;
    /// assert!(pair.is_adaptive());
    /// # Ok::<(), a3_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`from_step`](Self::from_step).
    pub fn from_estimated_step<R: Into<Vec<Vec<f64>>>>(
        name: impl Into<String>,
        order: u32,
        step: impl Fn(&mut Derivative, f64, &[f64], f64) -> Result<R, Error> + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        let step =
            move |f: &mut Derivative, t: f64, y: &[f64], h: f64| step(f, t, y, h).map(R::into);
        let create = Create::OwnTrial(Box::leak(Box::new(step)));
        let method = Self::made(name.into(), order, create)?;
        Ok(Self { default_control: Control::Tolerance(DEFAULT_TOLERANCE), ..method })
    }

    /// Creates an explicit Runge-Kutta method from its tableau: rows of the weights `a_ij` of each
    /// stage, the weights b of y1, and those of another result, if there are some (b-hat), whose
    /// difference from y1 estimates the error. Such a pair chooses its steps to a tolerance. There
    /// may be one weight more of f at the end of the step. The order follows from the tableau, and
    /// the times of the stages are the sums of their rows. Between the ends of a step, states are
    /// on the cubic through both or, if `within` has rows of weights `p_ij`, as many as `estimate`
    /// may have, at y + h sum `p_ij` theta^j `k_i`, with j from 1 on and theta from 0 to 1.
    ///
    /// The pair of Bogacki and Shampine, of order 3:
    ///
    /// ```
    /// use a3_core::Method;
    ///
    /// let a = [vec![], vec![0.5], vec![0.0, 0.75]];
    /// let b = [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0];
    /// let other = [7.0 / 24.0, 0.25, 1.0 / 3.0, 0.125];
    /// let pair = Method::from_tableau("bs23", &a, &b, Some(&other), &[])?;
    /// assert!(pair.order == 3 && pair.is_adaptive());
    /// # Ok::<(), a3_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`new`](Self::new); or the tableau has a wrong shape, is implicit, has numbers that
    /// are not finite, or weights that do not sum to 1, both results are the same, or the states
    /// within a step do not end at the result.
    pub fn from_tableau(
        name: impl Into<String>,
        a: &[Vec<f64>],
        b: &[f64],
        estimate: Option<&[f64]>,
        within: &[Vec<f64>],
    ) -> Result<Self, Error> {
        if estimate.is_none() && !within.is_empty() {
            let why = "a tableau without b_hat takes fixed steps, which have a polynomial already";
            return Err(Error::Invalid(why.into()));
        }
        let (tableau, order) = tableau_of(a, b, estimate, within)?;
        let tableau: &'static Tableau = Box::leak(Box::new(tableau));
        let method = match estimate {
            Some(_) => Self::made(name.into(), order, Create::OwnPair(tableau))?,
            None => Self::new(name, order, move |system| {
                Box::new(EmbeddedPair::new(tableau, system.dim()))
            })?,
        };
        let control = match estimate {
            Some(_) => Control::Tolerance(DEFAULT_TOLERANCE),
            None => Control::Step(DEFAULT_STEP),
        };
        Ok(Self { default_control: control, ..method.with_evaluations(b.len() as u32) })
    }

    /// Creates a method from a solver of another library, so that a chart measures it beside
    /// others. From the [`Derivative`] f, times (s), the state at time 0 and a relative tolerance,
    /// `solve` computes the state at each of these times, one after another. f counts its
    /// evaluations; further work of the solver, such as linear algebra, is in its computing time
    /// alone.
    ///
    /// It takes no steps, so that it makes no [`Simulation`](crate::Simulation), and serves neither
    /// networks nor rigid bodies, whose steps do more than f says.
    ///
    /// # Errors
    /// The name is empty, has signs that are not printed or more than 40 bytes, or is a name, an
    /// alias or a letter of the table.
    pub fn foreign(
        name: impl Into<String>,
        solve: impl Fn(&mut Derivative, &[f64], &[f64], f64) -> Result<Vec<f64>, Error>
        + Send
        + Sync
        + 'static,
    ) -> Result<Self, Error> {
        let create = Create::Foreign(Box::leak(Box::new(solve)));
        let method = Self::made(name.into(), 1, create)?;
        Ok(Self { default_control: Control::Tolerance(DEFAULT_TOLERANCE), ..method })
    }

    /// Replaces the full title, for legends and errors.
    #[must_use]
    pub fn with_title(self, title: impl Into<String>) -> Self {
        let title = title.into().leak();
        Self { title, ..self }
    }

    /// Replaces the number of evaluations in a step, by which runs are planned: charts begin and
    /// searches end by it. What a run has cost is counted.
    #[must_use]
    pub fn with_evaluations(self, evaluations: u32) -> Self {
        Self { evaluations: evaluations.max(1), damped_evaluations: evaluations.max(1), ..self }
    }

    /// Replaces the view of a system that the method steps with. Systems that lack it are refused.
    #[must_use]
    pub fn with_view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// Replaces the default step (s).
    #[must_use]
    pub fn with_default_step(self, step: f64) -> Self {
        Self { default_control: Control::Step(step), ..self }
    }

    /// Makes the method one that lives as long as the program, as the rows of the table do, and
    /// that [`find`](super::find) finds. If an own method of its name was registered before, this
    /// one takes its place there, and runs by the other one go on.
    #[must_use]
    pub fn register(self) -> &'static Self {
        let method = Box::leak(Box::new(self));
        add_own(method);
        method
    }
}

/// Checks that a name can be that of an own method, or of another library's solver, which may have
/// several words.
fn check_name(name: &str, has_words: bool) -> Result<(), Error> {
    let is_wrong = |c: char| c.is_control() || c.is_whitespace() && !(has_words && c == ' ');
    if name.trim().is_empty() || name.contains(is_wrong) || name.len() > MAX_NAME {
        let (kind, example) =
            if has_words { ("a text", "SciPy RK45") } else { ("a word", "my-heun") };
        return Err(Error::Invalid(format!(
            "a method's name is {kind} of at most {MAX_NAME} bytes, such as {example}, not `{}`",
            name.escape_debug()
        )));
    }
    match table::METHODS.iter().find(|m| m.is_called(name)) {
        None => Ok(()),
        Some(taken) => Err(Error::Invalid(format!(
            "the name {name} stands for {}: give the method another name, such as my-{name}",
            taken.title
        ))),
    }
}

/// Function that takes a step.
type StepFunction =
    dyn Fn(&mut Derivative, f64, &[f64], f64) -> Result<Vec<f64>, Error> + Send + Sync;

/// Integrator of a method that is a function.
struct Stepped {
    name: String,
    dim: usize,
    step: &'static StepFunction,
}

impl Integrator for Stepped {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim, y)?;
        let mut f = Derivative::new(system);
        let next = (self.step)(&mut f, t, y, h)?;
        if next.len() != self.dim {
            return Err(Error::Callback(format!(
                "the method {} returned {} numbers, but the state has {}",
                self.name,
                next.len(),
                self.dim
            )));
        }
        y.copy_from_slice(&next);
        Ok(f.work())
    }
}
