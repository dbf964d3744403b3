//! The interface of systems for integrators, which know nothing else of them than flat arrays. A
//! system implements one small trait, and may offer views, each for some methods: [`Splitting`],
//! [`Linearized`] and [`Compliant`]. [`Rigid`] and [`Rows`] are views of the models of this crate.

use std::ops::Range;

use crate::coupling::Coupling;
use crate::error::Error;
use crate::held::HeldView;
use crate::measure::Measure;
use crate::path::Place;
use crate::products::{Products, SolverHints};
use crate::rows::Rows;
use crate::spring::SpringLaw;
use crate::threads::copy;
pub(crate) use crate::views::Rigid;
pub use crate::views::{RigidView, RowsView};

/// Cost of an evaluation of f, in multiplications within rows, which are computed in vectors: of a
/// call, and for each number of the state, with the sums that a method computes with the result.
/// Measured on systems of 2 to 300 numbers.
const COSTS: [f64; 2] = [150.0, 10.0];

/// Returns the cost of an evaluation of f of a system of that many numbers.
pub(crate) fn evaluation_cost(dim: usize) -> f64 {
    COSTS[0] + COSTS[1] * dim as f64
}

/// Returns the numbers of a system with a mass matrix that have no derivative in it: they follow
/// from others, with the rounding errors of these.
pub(crate) fn without_derivative(system: &dyn ParticleSystem) -> Vec<usize> {
    let mass = system.mass_matrix();
    if mass.is_empty() {
        return vec![];
    }
    let mut is_moved = vec![false; system.dim()];
    for (_, k, _) in mass {
        is_moved[*k as usize] = true;
    }
    let all = is_moved.into_iter().enumerate();
    all.filter_map(|(k, is_moved)| (!is_moved).then_some(k)).collect()
}

/// Returns the size of a number y of a system, to which the step of a difference quotient is in
/// proportion: at least the number's own [scale](ParticleSystem::scales), or 1 without scales.
pub(crate) fn size(system: &dyn ParticleSystem, number: usize, y: f64) -> f64 {
    let scale = system.scales().get(number).copied();
    y.abs().max(scale.unwrap_or(1.0))
}

/// A first-order system y' = f(t, y), or M y' = f(t, y) with a constant [mass
/// matrix](ParticleSystem::mass_matrix) M.
///
/// Logistic growth y' = y (1 - y), whose solution from 1/2 is 1 / (1 + exp(-t)):
///
/// ```
/// use a3_core::{ParticleSystem, integrators};
///
/// struct Logistic;
///
/// impl ParticleSystem for Logistic {
///     fn dim(&self) -> usize { 1 }
///
///     fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
///         dydt[0] = y[0] * (1.0 - y[0]);
///     }
/// }
///
/// let mut rk4 = integrators::find("rk4").unwrap().integrator(&Logistic)?;
/// let mut y = [0.5];
/// for k in 0..10 {
///     rk4.step(&Logistic, 0.1 * f64::from(k), 0.1, &mut y)?;
/// }
/// assert!((y[0] - 1.0 / (1.0 + f64::exp(-1.0))).abs() < 1e-7);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub trait ParticleSystem {
    /// Returns the length of the state y.
    fn dim(&self) -> usize;

    /// Writes f(t, y) to `dydt`. The result depends on the arguments alone.
    ///
    /// Both slices have length [`dim`](Self::dim).
    #[doc(alias = "evalF")]
    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]);

    /// Writes the Jacobian df/dy to `jacobian`, row by row, and returns true; returns false if the
    /// system does not know it: implicit methods and stability then take differences of f.
    fn jacobian(&self, _t: f64, _y: &[f64], _jacobian: &mut [f64]) -> bool {
        false
    }

    /// Adds the row, the column and the value of each entry of the Jacobian df/dy that is not 0 to
    /// `entries`, and returns true; returns false if the system does not know it as a sparse one.
    fn jacobian_entries(&self, _t: f64, _y: &[f64], _entries: &mut Vec<(u32, u32, f64)>) -> bool {
        false
    }

    /// Returns the row and the column of each entry of the Jacobian that may differ from 0; empty
    /// if that is not known beforehand: methods then search them.
    fn sparsity(&self) -> &[(u32, u32)] {
        &[]
    }

    /// Returns the row, the column and the value of each entry of M that is not 0, column by
    /// column, if the system is M y' = f(t, y) with a constant matrix M; empty if M is 1.
    ///
    /// M may be singular: then some equations have no derivative, and have to determine the numbers
    /// that the others leave open (index 1). Only Radau IIA and BDF solve such systems.
    fn mass_matrix(&self) -> &[(u32, u32, f64)] {
        &[]
    }

    /// Returns the reason why an evaluation has failed since the last call, and forgets it.
    ///
    /// An evaluation that fails writes NaN and keeps its error, an [`Error::Callback`], for this
    /// function. A run then ends with that error instead of a blow-up.
    fn take_failure(&self) -> Option<Error> {
        None
    }

    /// Returns the view of a system whose particles stand in rows and act on near rows alone, if it
    /// is such a one.
    #[doc(hidden)]
    fn rows(&self) -> Option<RowsView<'_>> {
        None
    }

    /// Returns the second-order structure, if the system has one.
    fn mechanics(&self) -> Option<&dyn Mechanics> {
        None
    }

    /// Returns the view of a system with rigid bodies, which have more in their state than
    /// positions and velocities.
    #[doc(hidden)]
    fn rigid(&self) -> Option<RigidView<'_>> {
        None
    }

    /// Writes the prescribed positions and velocities of kinematic particles at time t (s) into y.
    fn hold(&self, _t: f64, _y: &mut [f64]) {}

    /// Visits the numbers of the state with their quantities, except those of the points of rigid
    /// bodies.
    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        visit(0..self.dim(), Measure::Plain);
    }

    /// Returns the least size of each [plain](Measure::Plain) number to which errors are relative;
    /// empty if a tolerance is to derive them.
    fn scales(&self) -> &[f64] {
        &[]
    }

    /// Returns the first time after t (s) at which f, or one of its derivatives, jumps, if that is
    /// known beforehand: a step ends there. Infinite if there is none.
    fn next_jump(&self, _t: f64) -> f64 {
        f64::INFINITY
    }

    /// Returns the number of quantities by which states are compared; 0 if they are compared by
    /// their own numbers.
    fn quantities(&self) -> usize {
        0
    }

    /// Writes these quantities of the state y at time t (s).
    fn write_quantities(&self, _t: f64, _y: &[f64], _out: &mut [f64]) {}

    /// Returns the cost of an evaluation of f, in multiplications of two numbers within long rows.
    /// The linear algebra of implicit methods is counted as [work](crate::Work::algebra) by it.
    fn evaluation_cost(&self) -> f64 {
        evaluation_cost(self.dim())
    }
}

/// A second-order system M x'' = F(t, x, v). With the state y = [x | v], it is a
/// [`ParticleSystem`].
///
/// Each of x, v and F holds n x 3 numbers in column-major order: all x, then all y, then all z.
/// Units are m, kg, s.
///
/// A ball that falls under its weight. Every method of order 2 is exact on its parabola:
///
/// ```
/// use a3_core::{Mechanics, integrators};
///
/// struct Ball;
///
/// impl Mechanics for Ball {
///     fn inverse_masses(&self) -> &[f64] { &[2.0] }
///
///     fn forces(&self, _t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]) {
///         f.copy_from_slice(&[0.0, -9.81 * 0.5, 0.0]);
///     }
/// }
///
/// let mut verlet = integrators::find("verlet").unwrap().integrator(&Ball)?;
/// let mut y = [0.0, 0.0, 0.0, 3.0, 4.0, 0.0];
/// verlet.step(&Ball, 0.0, 2.0, &mut y)?;
/// assert_eq!(y[..2], [6.0, -11.62]);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub trait Mechanics {
    /// Returns the inverse mass of each particle (1/kg); 0 pins a particle.
    fn inverse_masses(&self) -> &[f64];

    /// Writes F(t, x, v) (N) to `f`, on pinned particles too.
    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]);

    /// Writes F(t, x, v) / m (m/s2) to `a`: 0 for pinned particles.
    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.forces(t, x, v, a);
        divide_by_masses(self.inverse_masses(), a);
    }

    /// Returns the total energy (J) in the state y at time t (s) of a system of one's own, if it is
    /// known.
    fn energy(&self, _t: f64, _y: &[f64]) -> Option<f64> {
        None
    }

    /// Returns the coefficient c (kg/s) of viscous drag: the forces contain -c v on each particle.
    /// 0 by default.
    fn drag_coefficient(&self) -> f64 {
        0.0
    }

    /// Visits each pinned particle with its place at time t (s). By default there are none.
    fn pins(&self, _t: f64, _visit: &mut dyn FnMut(usize, Place)) {}

    /// Returns whether forces depend on positions and time alone, except viscous drag. By default
    /// this is known of systems that offer both other views, and whose kicks do not read v.
    fn is_positional(&self) -> bool {
        let splitting = self.splitting();
        let reads_velocity = splitting.is_none_or(Splitting::kick_reads_velocity);
        !reads_velocity && self.linearized().is_some()
    }

    /// Returns whether friction, which depends on the direction of a velocity, acts on particles.
    /// Methods with a tolerance whose stages have no velocities refuse it: it acts after their
    /// steps, where no estimate of errors sees it. By default there is none.
    fn is_rough(&self) -> bool {
        false
    }

    /// Does what [`ParticleSystem::jacobian`] does, for systems without the view of [`Linearized`].
    fn jacobian(&self, _t: f64, _y: &[f64], _jacobian: &mut [f64]) -> bool {
        false
    }

    /// Does what [`ParticleSystem::take_failure`] does.
    fn take_failure(&self) -> Option<Error> {
        None
    }

    /// Returns the view for methods that step row by row. Without it, they step by whole arrays.
    #[doc(hidden)]
    fn rows(&self) -> Option<RowsView<'_>> {
        None
    }

    /// Returns the view of rigid bodies, if there are any: the state is then longer than [x | v],
    /// and methods do not treat the system as M x'' = F.
    #[doc(hidden)]
    fn rigid(&self) -> Option<RigidView<'_>> {
        None
    }

    /// Returns the view for methods that kick and drift. Without it, they kick with all forces, as
    /// if these read v, and drift freely.
    fn splitting(&self) -> Option<&dyn Splitting> {
        None
    }

    /// Returns the view for implicit methods and for stability. Without it, they take differences
    /// of F.
    fn linearized(&self) -> Option<&dyn Linearized> {
        None
    }

    /// Returns the view for methods that solve spring by spring. Without it, they refuse the
    /// system.
    fn compliant(&self) -> Option<&dyn Compliant> {
        None
    }
}

/// The forces of a system in two parts: those that a drift solves exactly, and those of a kick.
pub trait Splitting {
    /// Writes the forces (N) that [`drift`](Self::drift) leaves out to `f`.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]);

    /// Returns whether [`kick_forces`](Self::kick_forces) depend on v. A step of velocity Verlet
    /// takes one evaluation if not, and three otherwise.
    fn kick_reads_velocity(&self) -> bool {
        true
    }

    /// Moves x and v from t to t + h by the exact flow of x' = v, v' = (F - kick forces) / m.
    /// Pinned particles are put in their places at t + h.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]);
}

/// The forces of a system to first order, for methods that solve with them.
pub trait Linearized: Mechanics {
    /// Writes dF = dF/dx dx + dF/dv dv to `df`, without forming a matrix.
    fn force_differential(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    );

    /// Visits the pairs of particles that act on each other, always in the same order: dF/dx and
    /// dF/dv by their symmetric parts, without [drag](Mechanics::drag_coefficient). With `clamped`,
    /// every stiffness is positive semi-definite: the matrix of an implicit step is then positive
    /// definite.
    fn couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling));

    /// Returns whether [`couplings`](Self::couplings) are all couplings. If not, implicit methods
    /// refuse the system.
    fn lists_all_couplings(&self) -> bool {
        true
    }

    /// Returns the natural frequency w (1/s) of Baumgarte stabilisation, C'' = -w2 C - 2 w C', if
    /// the forces hold constraints C = 0. The differential and the couplings leave these forces
    /// out.
    fn baumgarte_frequency(&self) -> Option<f64> {
        None
    }

    /// Returns the view of the constraints, with which implicit methods step. Without it, they
    /// refuse a system that has constraints.
    #[doc(hidden)]
    fn held(&self) -> Option<HeldView<'_>> {
        None
    }

    /// Returns the view of a system that multiplies by its couplings faster than one by one.
    /// Without it, methods do so one by one.
    fn products(&self) -> Option<&dyn Products> {
        None
    }

    /// Returns the numbers by which methods choose how to solve.
    fn hints(&self) -> SolverHints {
        SolverHints::default()
    }
}

/// The springs of a system one by one, each a compliant distance constraint: its compliance (m/N)
/// is one over its stiffness. The forces of the system are those of the springs, drag, and the
/// other forces.
pub trait Compliant: Mechanics {
    /// Visits the two ends and the law of each spring, always in the same order. A spring whose
    /// ends are at the same place has no direction, and no force.
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw));

    /// Writes all forces (N) except those of springs and drag to `f`.
    fn other_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]);
}

/// Returns the view of rigid bodies, if the system has some.
pub(crate) fn rigid_of(system: &dyn ParticleSystem) -> Option<&dyn Rigid> {
    system.rigid().map(|RigidView(rigid)| rigid)
}

/// Returns the view of rows, if the particles of the system stand in rows.
pub(crate) fn rows_of(system: &dyn ParticleSystem) -> Option<&dyn Rows> {
    system.rows().map(|RowsView(rows)| rows)
}

/// Returns whether kicks depend on v, or the system has no view that says so.
pub(crate) fn kick_reads_velocity<M: Mechanics + ?Sized>(system: &M) -> bool {
    let splitting = system.splitting();
    splitting.is_none_or(Splitting::kick_reads_velocity)
}

/// Returns whether kicks depend on v; true if unknown.
pub(crate) fn reads_velocity(system: &dyn ParticleSystem) -> bool {
    if let Some(rigid) = rigid_of(system) {
        return rigid.kick_reads_velocity();
    }
    system.mechanics().is_none_or(kick_reads_velocity)
}

/// Converts forces (N) to accelerations (m/s2).
pub(crate) fn divide_by_masses(inverse_masses: &[f64], f: &mut [f64]) {
    for column in f.chunks_exact_mut(inverse_masses.len()) {
        for (f, w) in column.iter_mut().zip(inverse_masses) {
            *f *= w;
        }
    }
}

/// Writes the place of every pin at time t (s) to x and v.
pub(crate) fn place_pins<M: Mechanics + ?Sized>(system: &M, t: f64, x: &mut [f64], v: &mut [f64]) {
    let n = x.len() / 3;
    system.pins(t, &mut |i, place| {
        for axis in 0..3 {
            x[axis * n + i] = place.position[axis];
            v[axis * n + i] = place.velocity[axis];
        }
    });
}

/// A mechanical system as a first-order one: x' = v, v' = F/m; a pin follows its path.
impl<M: Mechanics> ParticleSystem for M {
    fn dim(&self) -> usize {
        Mechanics::rigid(self).map_or(6 * self.inverse_masses().len(), |view| view.0.length())
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        if let Some(RigidView(rigid)) = Mechanics::rigid(self) {
            return rigid.rates(t, y, dydt);
        }
        let n = self.inverse_masses().len();
        let (x, v) = y.split_at(3 * n);
        let (dx, dv) = dydt.split_at_mut(3 * n);
        self.accelerations(t, x, v, dv);
        copy(v, dx);
        self.pins(t, &mut |i, place| {
            for axis in 0..3 {
                dx[axis * n + i] = place.velocity[axis];
                dv[axis * n + i] = place.acceleration[axis];
            }
        });
    }

    fn jacobian(&self, t: f64, y: &[f64], jacobian: &mut [f64]) -> bool {
        Mechanics::jacobian(self, t, y, jacobian)
    }

    fn take_failure(&self) -> Option<Error> {
        Mechanics::take_failure(self)
    }

    fn rows(&self) -> Option<RowsView<'_>> {
        Mechanics::rows(self)
    }

    fn mechanics(&self) -> Option<&dyn Mechanics> {
        Mechanics::rigid(self).is_none().then_some(self as &dyn Mechanics)
    }

    fn rigid(&self) -> Option<RigidView<'_>> {
        Mechanics::rigid(self)
    }

    fn hold(&self, t: f64, y: &mut [f64]) {
        if let Some(RigidView(rigid)) = Mechanics::rigid(self) {
            return rigid.place(t, y);
        }
        let (x, v) = y.split_at_mut(y.len() / 2);
        place_pins(self, t, x, v);
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        if let Some(RigidView(rigid)) = Mechanics::rigid(self) {
            return rigid.measures(visit);
        }
        let n = 3 * self.inverse_masses().len();
        visit(0..n, Measure::Position);
        visit(n..2 * n, Measure::Velocity);
    }
}
