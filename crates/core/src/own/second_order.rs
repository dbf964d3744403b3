//! A system of second order from a function.

use std::sync::Arc;

use crate::error::{Error, positive};
use crate::failure::{Failure, Outcome};
use crate::scene::Model;
use crate::system::{Mechanics, Splitting};

/// Function of t, x and v that writes forces.
type ForceFunction = dyn Fn(f64, &[f64], &[f64], &mut [f64]) -> Result<(), String> + Send + Sync;
/// Function of t, x and v that writes dF/dx and dF/dv.
type Tangents =
    dyn Fn(f64, &[f64], &[f64], &mut [f64], &mut [f64]) -> Result<(), String> + Send + Sync;

/// System of second order, M x'' = F(t, x, v), whose F is a function: of n particles in space, or
/// of any number of coordinates.
///
/// The state is y = [x | v], as [`state`](Self::state) makes it. Particles have 3 n coordinates:
/// all x, then all y, then all z. A system of d coordinates has d particles, each of which moves
/// along the x axis: its state has 6 d numbers, of which those of the other axes stay 0. So methods
/// that kick and drift, stability and pictures treat both alike, and errors are those of the
/// positions.
///
/// A pendulum of 1 m, by its angle:
///
/// ```
/// use a3_core::{SecondOrder, integrators};
///
/// let pull = |_t: f64, x: &[f64], _v: &[f64], f: &mut [f64]| f[0] = -9.81 * x[0].sin();
/// let pendulum = SecondOrder::of_coordinates(&[1.0], pull)?.positional();
/// let mut y = pendulum.state(&[0.1], &[0.0])?;
/// let mut verlet = integrators::find("verlet").unwrap().integrator(&pendulum)?;
/// for k in 0..1004 {
///     verlet.step(&pendulum, 1e-3 * f64::from(k), 1e-3, &mut y)?;
/// }
/// // After half a period, of pi / sqrt(9.81) s if the swing is small, it is on the other side.
/// assert!((y[0] + 0.1).abs() < 1e-5);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct SecondOrder {
    inverse_masses: Vec<f64>,
    /// Number of coordinates that the functions see: one or three of each particle.
    seen: usize,
    forces: Box<ForceFunction>,
    tangents: Option<Box<Tangents>>,
    /// Writes a single number.
    energy: Option<Box<ForceFunction>>,
    reads_velocity: bool,
    failure: Failure,
}

impl SecondOrder {
    /// Creates a system of particles of these masses (kg) from a function that writes the forces
    /// F(t, x, v) (N) to its last argument, and may fail. What it writes must depend on t, x and v
    /// alone.
    ///
    /// # Errors
    /// There is no mass, or one is not a finite number above 0.
    pub fn of_particles<R: Outcome>(
        masses: &[f64],
        forces: impl Fn(f64, &[f64], &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        Self::new(masses, 3 * masses.len(), forces)
    }

    /// Creates a system of coordinates, each with a mass, from a function that writes the forces
    /// F(t, x, v) to its last argument, and may fail; x, v and F have a number for each mass.
    ///
    /// # Errors
    /// There is no mass, or one is not a finite number above 0.
    pub fn of_coordinates<R: Outcome>(
        masses: &[f64],
        forces: impl Fn(f64, &[f64], &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        Self::new(masses, masses.len(), forces)
    }

    fn new<R: Outcome>(
        masses: &[f64],
        seen: usize,
        forces: impl Fn(f64, &[f64], &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        if masses.is_empty() {
            return Err(Error::Invalid("a system needs at least one mass".into()));
        }
        for (k, mass) in masses.iter().enumerate() {
            positive(&format!("mass {k}"), *mass)?;
        }
        Ok(Self {
            inverse_masses: masses.iter().map(|mass| 1.0 / mass).collect(),
            seen,
            forces: Box::new(move |t, x, v, f| forces(t, x, v, f).outcome()),
            tangents: None,
            energy: None,
            reads_velocity: true,
            failure: Failure::default(),
        })
    }

    /// Declares that forces do not depend on velocities. Methods that kick and drift then take
    /// fewer evaluations, and Nyström methods support the system.
    #[must_use]
    pub fn positional(self) -> Self {
        Self { reads_velocity: false, ..self }
    }

    /// Adds the Jacobian: a function of t, x and v that writes dF/dx and dF/dv, each row by row, to
    /// its last two arguments, and may fail. Both are 0 before. Without it, implicit methods and
    /// stability take differences of F.
    #[must_use]
    pub fn with_jacobian<R: Outcome>(
        self,
        jacobian: impl Fn(f64, &[f64], &[f64], &mut [f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Self {
        Self {
            tangents: Some(Box::new(move |t, x, v, of_x, of_v| {
                jacobian(t, x, v, of_x, of_v).outcome()
            })),
            ..self
        }
    }

    /// Adds the total energy E(t, x, v) (J), whose errors charts and choices can then measure: a
    /// function that writes it to its last argument, and may fail.
    #[must_use]
    pub fn with_energy<R: Outcome>(
        self,
        energy: impl Fn(f64, &[f64], &[f64], &mut f64) -> R + Send + Sync + 'static,
    ) -> Self {
        let write = move |t: f64, x: &[f64], v: &[f64], out: &mut [f64]| {
            energy(t, x, v, &mut out[0]).outcome()
        };
        Self { energy: Some(Box::new(write)), ..self }
    }

    /// Returns the state y = [x | v] of positions (m) and velocities (m/s), as the functions see
    /// them.
    ///
    /// # Errors
    /// One of them has a wrong length.
    pub fn state(&self, x: &[f64], v: &[f64]) -> Result<Vec<f64>, Error> {
        let half = 3 * self.inverse_masses.len();
        let mut y = vec![0.0; 2 * half];
        for (what, from, to) in [("positions", x, 0), ("velocities", v, half)] {
            if from.len() != self.seen {
                return Err(Error::Invalid(format!(
                    "the system has {} coordinates, but there are {} {what}",
                    self.seen,
                    from.len()
                )));
            }
            y[to..to + self.seen].copy_from_slice(from);
        }
        Ok(y)
    }
}

impl Mechanics for SecondOrder {
    fn inverse_masses(&self) -> &[f64] {
        &self.inverse_masses
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let (f, others) = f.split_at_mut(self.seen);
        others.fill(0.0);
        let (x, v) = (&x[..self.seen], &v[..self.seen]);
        self.failure.guard(f, |f| (self.forces)(t, x, v, f));
    }

    fn energy(&self, t: f64, y: &[f64]) -> Option<f64> {
        let (x, v) = y.split_at(y.len() / 2);
        let (x, v) = (&x[..self.seen], &v[..self.seen]);
        let energy = self.energy.as_ref()?;
        let mut found = [0.0];
        self.failure.guard(&mut found, |found| energy(t, x, v, found));
        Some(found[0])
    }

    fn is_positional(&self) -> bool {
        !self.reads_velocity
    }

    fn jacobian(&self, t: f64, y: &[f64], jacobian: &mut [f64]) -> bool {
        let Some(tangents) = &self.tangents else {
            return false;
        };
        let (n, m, half) = (self.inverse_masses.len(), self.seen, y.len() / 2);
        let (x, v) = (&y[..m], &y[half..half + m]);
        let mut slopes = vec![0.0; 2 * m * m];
        self.failure.guard(&mut slopes, |slopes| {
            let (of_x, of_v) = slopes.split_at_mut(m * m);
            tangents(t, x, v, of_x, of_v)
        });
        jacobian.fill(0.0);
        for k in 0..half {
            jacobian[k * y.len() + half + k] = 1.0;
        }
        for (k, slope) in slopes.into_iter().enumerate() {
            let (part, i, j) = (k / (m * m), k / m % m, k % m);
            jacobian[(half + i) * y.len() + part * half + j] = slope * self.inverse_masses[i % n];
        }
        true
    }

    fn take_failure(&self) -> Option<Error> {
        self.failure.take()
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }
}

impl Splitting for SecondOrder {
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.forces(t, x, v, f);
    }

    fn kick_reads_velocity(&self) -> bool {
        self.reads_velocity
    }

    fn drift(&self, _t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        for (x, v) in x.iter_mut().zip(v) {
            *x += h * *v;
        }
    }
}

impl From<SecondOrder> for Model {
    fn from(system: SecondOrder) -> Self {
        Self::FirstOrder(Arc::new(system))
    }
}
