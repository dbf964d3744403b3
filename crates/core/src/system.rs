//! What an integrator sees: flat arrays of which only the length changes.

use crate::path::Place;
use crate::rows::Rows;

/// A first-order system y' = f(t, y).
pub trait ParticleSystem {
    /// Length of the state y.
    fn dim(&self) -> usize;

    /// Writes f(t, y) to `dydt`. Pure: reads the state it is given, not one of its own.
    ///
    /// Both slices have length [`dim`](Self::dim).
    #[doc(alias = "evalF")]
    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]);

    /// Its rows, if its particles stand in rows that only hold on to those next to them.
    fn rows(&self) -> Option<&dyn Rows> {
        None
    }

    /// The second-order structure, if the system has one.
    fn mechanics(&self) -> Option<&dyn Mechanics> {
        None
    }
}

/// How two particles hold one another, to first order. With d = xi - xj and u = d/|d|,
/// dFi = -(along u uT + across (1 - u uT)) dd - damping u uT dd', and dFj is its opposite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// One end.
    pub i: usize,
    /// The other end.
    pub j: usize,
    /// u
    pub direction: [f64; 3],
    /// Stiffness along u (N/m).
    pub along: f64,
    /// Stiffness across it (N/m): negative where it pushes.
    pub across: f64,
    /// Along u (N s/m).
    pub damping: f64,
}

/// A = M + a (C + D) + a2 K at x, as the [couplings](Mechanics::couplings) make it.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<'a> {
    /// Where it is (m).
    pub x: &'a [f64],
    /// In s.
    pub a: f64,
    /// Whether stiffness across compressed springs counts as none.
    pub clamped: bool,
    /// The diagonal: masses, and a times the drag (kg).
    pub masses: &'a [f64],
    /// 1, or 0 where a particle is pinned: nothing is wanted there.
    pub free: &'a [f64],
}

/// M x'' = F(t, x, v). Its state is y = [x | v], and it is a [`ParticleSystem`] through that.
///
/// Each of x, v and F holds n x 3 numbers in column-major order: all x, then all y, then all z.
/// Units are m, kg, s.
pub trait Mechanics {
    /// One over the mass of each particle (1/kg); 0 pins a particle.
    fn inverse_masses(&self) -> &[f64];

    /// Writes F(t, x, v) (N) to `f`, on pinned particles too.
    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]);

    /// Writes F(t, x, v) / m (m/s2) to `a`: nothing for pinned particles.
    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.forces(t, x, v, a);
        self.divide_by_masses(a);
    }

    /// Makes accelerations of forces.
    fn divide_by_masses(&self, f: &mut [f64]) {
        let inverse_masses = self.inverse_masses();
        for column in f.chunks_exact_mut(inverse_masses.len()) {
            for (f, w) in column.iter_mut().zip(inverse_masses) {
                *f *= w;
            }
        }
    }

    /// As [`ParticleSystem::rows`].
    fn rows(&self) -> Option<&dyn Rows> {
        None
    }

    /// The natural frequency (1/s) with which errors of constraints are taken back, if the forces hold any. What they do for
    /// that, [`force_differential`](Self::force_differential) and [`couplings`](Self::couplings) leave out: methods
    /// that solve with these do not serve then.
    fn feedback(&self) -> Option<f64> {
        None
    }

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

    /// Visits the pairs of particles that hold one another, always in the same order: dF/dx and dF/dv by their
    /// symmetric parts, for methods that solve with them. Without any, nothing.
    fn couplings(&self, _x: &[f64], _visit: &mut dyn FnMut(Coupling)) {}

    /// Writes A p to `out`, if that is faster than coupling by coupling; if not, does nothing and says so.
    fn multiply(&self, _matrix: &Matrix, _p: &[f64], _out: &mut [f64]) -> bool {
        false
    }

    /// How many times as fast the forces are as they would be coupling by coupling: what linear algebra is priced by.
    fn speed(&self) -> f64 {
        1.0
    }

    /// -dF/dv of each particle by itself: viscous drag (kg/s).
    fn drag_coefficient(&self) -> f64 {
        0.0
    }

    /// Visits each pinned particle with the place it has at time t. Without any, nothing.
    fn pins(&self, _t: f64, _visit: &mut dyn FnMut(usize, Place)) {}

    /// The forces less the part that [`drift`](Self::drift) carries: what a splitting method kicks with.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.forces(t, x, v, f);
    }

    /// Whether [`kick_forces`](Self::kick_forces) depend on v. If not, a kick costs one evaluation instead of two.
    fn kick_reads_velocity(&self) -> bool {
        true
    }

    /// Moves x and v from t to t + h by the exact flow of x' = v, v' = the part that
    /// [`kick_forces`](Self::kick_forces) left out. Pinned particles arrive at their place of t + h.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        for (x, v) in x.iter_mut().zip(&*v) {
            *x += h * v;
        }
        place_pins(self, t + h, x, v);
    }
}

/// Writes the place of every pin at time t into x and v.
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
        6 * self.inverse_masses().len()
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        let n = self.inverse_masses().len();
        let (x, v) = y.split_at(3 * n);
        let (dx, dv) = dydt.split_at_mut(3 * n);
        self.accelerations(t, x, v, dv);
        dx.copy_from_slice(v);
        self.pins(t, &mut |i, place| {
            for axis in 0..3 {
                dx[axis * n + i] = place.velocity[axis];
                dv[axis * n + i] = place.acceleration[axis];
            }
        });
    }

    fn rows(&self) -> Option<&dyn Rows> {
        Mechanics::rows(self)
    }

    fn mechanics(&self) -> Option<&dyn Mechanics> {
        Some(self)
    }
}
