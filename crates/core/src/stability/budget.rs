//! Work that the runs of a search may do.

use std::cell::{Cell, RefCell};

use crate::elements::Sheet;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::Method;
use crate::network::Element;
use crate::scene::Model;
use crate::simulation::Simulation;

/// Largest work of a run, as a share of the search's budget.
const MAX_RUN_SHARE: f64 = 0.25;
/// Work between two checks of the budget, as a share of it.
const CHECK_SHARE: f64 = 0.01;
/// Least number of particles that count as work: a small system costs more than its particles.
const MIN_PARTICLES: usize = 20;
/// Least number of steps to which a run is shortened.
const MIN_STEPS: f64 = 100.0;

/// Cost of an evaluation per particle, relative to a sheet of springs: with other forces.
const OTHER_PRICE: f64 = 3.5;
/// The same in a fluid.
const FLUID_PRICE: f64 = 10.0;
/// The same where surfaces touch, whose pairs are listed again where they move fast.
const CONTACT_PRICE: f64 = 50.0;
/// Cost of an impulse of the collision safeguard, with the search for the next one.
const IMPULSE_PRICE: f64 = 50.0;

/// Work that a search may do, in evaluations of one particle on a sheet of springs, which take 20
/// to 40 ns. It is counted, not timed, so that a search ends at the same run on every machine.
#[derive(Debug)]
pub struct Budget {
    most: f64,
    /// Work that may be done now.
    allowed: Cell<f64>,
    spent: Cell<f64>,
    limits: Cell<bool>,
    /// Failure of a callback in a run, if there was one.
    failure: RefCell<Option<Error>>,
}

impl Budget {
    /// Creates a budget of that amount of work.
    #[must_use]
    pub fn new(most: f64) -> Self {
        Self {
            most,
            allowed: Cell::new(most),
            spent: Cell::new(0.0),
            limits: Cell::new(false),
            failure: RefCell::new(None),
        }
    }

    /// Creates an unlimited budget.
    #[must_use]
    pub fn unlimited() -> Self {
        Self::new(f64::INFINITY)
    }

    /// Allows the next search a share of the remaining work.
    pub fn allow(&self, share: f64) {
        let spent = self.spent.get();
        self.allowed.set(spent + share * (self.most - spent));
    }

    /// Returns the work done so far.
    #[must_use]
    pub fn spent(&self) -> f64 {
        self.spent.get()
    }

    /// Returns whether the budget ended a search, or shortened its runs.
    #[must_use]
    pub fn limits(&self) -> bool {
        self.limits.get()
    }

    /// Returns the number of steps of a run, at most `wanted`, that the budget allows.
    pub(super) fn room(&self, method: &Method, model: &Model, wanted: u64) -> u64 {
        let each = f64::from(method.evaluations) * price(model);
        let room = (MAX_RUN_SHARE * self.most / each).max(MIN_STEPS);
        if room < wanted as f64 {
            self.limits.set(true);
            return room as u64;
        }
        wanted
    }

    /// Checks that no callback has failed in a run.
    ///
    /// # Errors
    /// That failure.
    pub(super) fn check(&self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Takes steps of a run. Returns whether the run holds; `None` once the budget is spent, and if
    /// a callback fails, see [`check`](Self::check).
    pub(super) fn take(&self, run: &mut Simulation, steps: u64) -> Option<bool> {
        let (mut left, mut portion) = (steps, 1);
        while left > 0 {
            let before = cost(run);
            let taken = run.take_steps(portion);
            let Ok(holds) = succeeded(taken).map_err(|failure| self.failure.replace(Some(failure)))
            else {
                return None;
            };
            let work = cost(run) - before;
            self.spent.set(self.spent.get() + work);
            if !holds {
                return Some(false);
            }
            if self.spent.get() > self.allowed.get() {
                self.limits.set(true);
                return None;
            }
            left -= portion;
            let room = CHECK_SHARE * self.most * portion as f64 / work;
            portion = (room as u64).clamp(1, left.max(1));
        }
        Some(true)
    }
}

/// Returns the cost of an evaluation of a model.
fn price(model: &Model) -> f64 {
    let each = model.network().map_or(1.0, |network| {
        let is_light = |element: &Element| {
            element.get::<Sheet>().is_some() || element.force().drift_forces().is_some()
        };
        if network.contact_layer().is_some() {
            CONTACT_PRICE
        } else if network.fluid().is_some() {
            FLUID_PRICE
        } else if !network.elements().iter().all(is_light) {
            OTHER_PRICE
        } else {
            1.0
        }
    });
    each * model.particles().max(MIN_PARTICLES) as f64
}

/// Returns the work of a run so far.
pub(super) fn cost(run: &Simulation) -> f64 {
    run.work().total() * price(run.model()) + IMPULSE_PRICE * run.guarded().impulses as f64
}
