//! Optional views, implemented by a system outside the core: a line of particles that implements
//! kicks and drifts, and its forces to first order.

use crate::common::{distance, integrate, method, size};
use a3_core::{
    BlockCoupling, Coupling, Error, Linearized, Mechanics, Place, Refusal, Splitting, Vector3,
    integrators,
};

/// Stiffness between neighbours (N/m): xx, yy, zz, xy, xz, yz.
const K: [f64; 6] = [40.0, 30.0, 50.0, 5.0, -3.0, 8.0];
/// Gravity (m/s2).
const G: [f64; 3] = [0.5, -9.81, 0.0];

/// Particles in a line, the first one pinned, each held to the next by an anisotropic linear
/// spring.
struct Line {
    inverse_masses: Vec<f64>,
    has_views: bool,
}

impl Line {
    fn new(particles: usize, has_views: bool) -> Self {
        let mut inverse_masses = vec![20.0; particles];
        inverse_masses[0] = 0.0;
        Self { inverse_masses, has_views }
    }

    fn particles(&self) -> usize {
        self.inverse_masses.len()
    }

    fn state(&self) -> Vec<f64> {
        let n = self.particles();
        let mut y: Vec<f64> = (0..6 * n).map(|k| 0.1 * (k as f64).sin()).collect();
        (0..6).for_each(|axis| y[axis * n] = 0.0);
        y
    }
}

fn product(d: [f64; 3]) -> [f64; 3] {
    let [xx, yy, zz, xy, xz, yz] = K;
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        .map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
}

fn row(a: &[f64], i: usize) -> [f64; 3] {
    let n = a.len() / 3;
    [0, n, 2 * n].map(|column| a[column + i])
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

/// Force (N) on a particle between the pulls of its neighbours, with gravity if `g` is set.
fn force(above: [f64; 3], below: [f64; 3], g: bool) -> [f64; 3] {
    [0, 1, 2].map(|axis| above[axis] - below[axis] + if g { 0.05 * G[axis] } else { 0.0 })
}

impl Line {
    fn add_up(&self, x: &[f64], g: bool, f: &mut [f64]) {
        let n = self.particles();
        let at = |i| row(x, i);
        let mut above = [0.0; 3];
        for i in 0..n {
            let below = if i + 1 < n { product(difference(at(i), at(i + 1))) } else { [0.0; 3] };
            let sum = force(above, below, g);
            (0..3).for_each(|axis| f[axis * n + i] = sum[axis]);
            above = below;
        }
    }
}

impl Mechanics for Line {
    fn inverse_masses(&self) -> &[f64] {
        &self.inverse_masses
    }

    fn forces(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) {
        self.add_up(x, true, f);
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        visit(0, Place::still(Vector3::zeros()));
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        self.has_views.then_some(self as &dyn Splitting)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        self.has_views.then_some(self as &dyn Linearized)
    }
}

/// Drift with gravity: x += h v + h^2/2 g, v += h g.
fn fall(h: f64, x: &mut [f64], v: &mut [f64], g: f64) {
    for (x, v) in x.iter_mut().zip(v) {
        *x += h * *v + 0.5 * h * h * g;
        *v += h * g;
    }
}

impl Splitting for Line {
    fn kick_forces(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) {
        self.add_up(x, false, f);
    }

    fn kick_reads_velocity(&self) -> bool {
        false
    }

    fn drift(&self, _t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let n = self.particles();
        for axis in 0..3 {
            let column = axis * n..(axis + 1) * n;
            fall(h, &mut x[column.clone()], &mut v[column], G[axis]);
            (x[axis * n], v[axis * n]) = (0.0, 0.0);
        }
    }
}

impl Linearized for Line {
    fn force_differential(
        &self,
        _t: f64,
        _x: &[f64],
        _v: &[f64],
        dx: &[f64],
        _dv: &[f64],
        df: &mut [f64],
    ) {
        self.add_up(dx, false, df);
    }

    fn couplings(&self, _t: f64, _x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for i in 1..self.particles() {
            visit(Coupling::Block(BlockCoupling {
                i: i - 1,
                j: i,
                stiffness: K,
                damping: [0.0; 6],
            }));
        }
    }
}

/// Every method converges to the same motion with views and without.
#[test]
fn a_system_without_views_is_served_too() {
    let line = Line::new(7, true);
    let y = line.state();
    let expected = integrate(&line, method("dop853"), &y, 1e-3, 200);
    for m in integrators::METHODS.iter().filter(|m| !m.needs_springs()) {
        let error = |line: &Line, steps: u64| {
            let found = integrate(line, m, &y, 0.2 / steps as f64, steps);
            distance(&found, &expected) / size(&expected)
        };
        for has_views in [true, false] {
            let line = Line::new(7, has_views);
            // A system without views may depend on the velocity.
            let serves = if has_views { !m.plain_only() } else { !m.positions_only() };
            assert_eq!(m.check(&line).is_ok(), serves);
            if m.check(&line).is_err() {
                continue;
            }
            let (coarse, fine) = (error(&line, 200), error(&line, 400));
            let falls = coarse / fine;
            let order = 0.7 * 2f64.powi(m.order as i32);
            println!("{} {has_views}: {coarse:.1e} {fine:.1e}", m.name);
            assert!(fine < 1e-9 || falls > order, "{}: {falls}", m.name);
        }
    }
}

/// The implicit midpoint rule solves its equation with the blocks of the tangent.
#[test]
fn implicit_methods_solve_with_blocks() {
    for particles in [7, 300] {
        let line = Line::new(particles, true);
        let n = particles;
        let y = line.state();
        let h = 0.1;
        let after = integrate(&line, method("implicit-midpoint"), &y, h, 1);
        let middle: Vec<f64> = y.iter().zip(&after).map(|(a, b)| 0.5 * (a + b)).collect();
        let mut f = vec![0.0; 3 * n];
        line.forces(0.0, &middle[..3 * n], &middle[3 * n..], &mut f);
        for k in 0..3 * n {
            let x = after[k] - y[k] - h * middle[3 * n + k];
            let v = after[3 * n + k] - y[3 * n + k] - h * f[k] * line.inverse_masses[k % n];
            assert!(x.abs() < 1e-9 && v.abs() < 1e-9, "{k}: {x:e} {v:e}");
        }
    }
}

/// Implicit methods refuse a system with a constraint before a run begins.
#[test]
fn constraints_in_the_forces_are_refused_by_implicit_methods() {
    struct Constrained(Line);
    impl Mechanics for Constrained {
        fn inverse_masses(&self) -> &[f64] {
            self.0.inverse_masses()
        }
        fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
            self.0.forces(t, x, v, f);
        }
        fn linearized(&self) -> Option<&dyn Linearized> {
            Some(self)
        }
    }
    impl Linearized for Constrained {
        fn force_differential(
            &self,
            t: f64,
            x: &[f64],
            v: &[f64],
            dx: &[f64],
            dv: &[f64],
            df: &mut [f64],
        ) {
            self.0.force_differential(t, x, v, dx, dv, df);
        }
        fn couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
            self.0.couplings(t, x, clamped, visit);
        }
        fn baumgarte_frequency(&self) -> Option<f64> {
            Some(10.0)
        }
    }
    let system = Constrained(Line::new(3, true));
    for m in integrators::METHODS {
        let refused = Error::Unsupported { method: m.title, why: Refusal::HoldsConstraints };
        let is_refused = m.check(&system) == Err(refused);
        assert_eq!(is_refused, m.is_implicit() && !m.plain_only(), "{}", m.name);
    }
}
