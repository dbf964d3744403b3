//! The laws of an impact, for all that touches or tightens: restitution, Coulomb friction, and the
//! separation that bodies get back; and the impulses of a step.

use nalgebra::{Matrix3, Vector3};

use super::skin::Law;

/// Fraction of the missing separation of bodies that is restored in a step.
const RESTORED_SHARE: f64 = 0.1;

/// Largest number of steps of Newton's method for the friction of a contact that slips on.
const MAX_NEWTON_STEPS: usize = 30;

/// Share of the mobility of a contact that is a rounding error.
const ROUNDING: f64 = 1e-14;

/// Impulses (N s) on particles during a step, in the order in which they were given.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses(Vec<(u32, Vector3<f64>)>);

impl Impulses {
    /// Creates an empty list with room for one impulse on each of n particles.
    pub fn with_room_for(particles: usize) -> Self {
        Self(Vec::with_capacity(particles))
    }

    /// Removes the impulses of the previous step.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds an impulse on vertex i.
    pub fn add(&mut self, i: usize, impulse: Vector3<f64>) {
        self.0.push((i as u32, impulse));
    }

    /// Adds an impulse between two primitives, distributed to their points by the weights.
    pub fn share(&mut self, points: [u32; 4], weights: [f64; 4], impulse: Vector3<f64>) {
        for (i, weight) in points.into_iter().zip(weights) {
            if weight != 0.0 {
                self.0.push((i, impulse * weight));
            }
        }
    }

    /// Adds the impulses, divided by a time of h (s), to forces (N), n x 3; those on obstacles do
    /// not count.
    pub fn add_forces(&self, h: f64, f: &mut [f64]) {
        let n = f.len() / 3;
        for (i, impulse) in &self.0 {
            let i = *i as usize;
            for axis in (0..3).filter(|_| i < n) {
                f[axis * n + i] += impulse[axis] / h;
            }
        }
    }
}

/// Returns the part (m) of the separation that bodies at a distance (m) lack that they get back in
/// a step. Nothing else would restore what they lose in each step under pressure.
pub(super) fn restored(law: &Law, distance: f64) -> f64 {
    RESTORED_SHARE * (law.max_kept() - distance).max(0.0)
}

/// Returns the change of a relative velocity (m/s) by an impact after which it has this speed (m/s)
/// along the normal. Coulomb friction stops the slip, as far as the change along the normal allows.
pub(super) fn change_in_impact(
    relative: Vector3<f64>,
    normal: Vector3<f64>,
    speed: f64,
    friction: f64,
) -> Vector3<f64> {
    let along = speed - relative.dot(&normal);
    normal * along - limited_to(across(relative, normal), friction * along)
}

/// Returns the component of a vector perpendicular to a unit normal.
pub(super) fn across(a: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    a - normal * a.dot(&normal)
}

/// Limits a slip to the length `most`.
pub(super) fn limited_to(slip: Vector3<f64>, most: f64) -> Vector3<f64> {
    let length = slip.norm();
    if length > most { slip * (most / length) } else { slip }
}

/// Returns the impulse of Coulomb friction (N s) across a unit normal, of at most `most`, where a
/// contact would slip at `free` (m/s) without it, and an impulse changes its velocity by this
/// matrix (1/kg): the one that stops the slip or, if none does, has that size and is opposite to
/// the slip that is left.
pub(super) fn friction(
    mobility: &Matrix3<f64>,
    normal: Vector3<f64>,
    free: Vector3<f64>,
    most: f64,
) -> Vector3<f64> {
    let smallest = normal.abs().imin();
    let first = Vector3::ith(smallest, 1.0).cross(&normal).normalize();
    let axes = [first, normal.cross(&first)];
    let [[a, c], [_, b]] = axes.map(|p| axes.map(|q| p.dot(&(mobility * q))));
    // The principal axes of the mobility across the normal, and the mobilities along them.
    let (mean, half) = (0.5 * (a + b), 0.5 * (a - b));
    let root = (half * half + c * c).sqrt();
    let turned = if half >= 0.0 {
        axes[0] * (root + half) + axes[1] * c
    } else {
        axes[0] * c + axes[1] * (root - half)
    };
    let first = turned.try_normalize(0.0).unwrap_or(axes[0]);
    let principal = [first, normal.cross(&first)];
    let mobilities = [mean + root, mean - root];
    let slips = principal.map(|axis| axis.dot(&free));
    // Impulse at which the velocity that remains, after friction, is minus the impulse times the
    // resistance (1/kg).
    let with = |resistance: f64| {
        let along = |k: usize| {
            let all = mobilities[k] + resistance;
            // Constraints may leave it no way to move there.
            if all > ROUNDING * mobilities[0] { -slips[k] / all } else { 0.0 }
        };
        [along(0), along(1)]
    };
    let size = |[x, y]: [f64; 2]| (x * x + y * y).sqrt();
    let mut found = with(0.0);
    if size(found) > most {
        if most <= 0.0 {
            return Vector3::zeros();
        }
        // Newton's method on the inverse of the size, which is concave.
        let mut resistance = (size(slips) / most - mobilities[0]).max(0.0);
        for _ in 0..MAX_NEWTON_STEPS {
            found = with(resistance);
            let length = size(found);
            let slope = (0..2).map(|k| found[k] * found[k] / (mobilities[k] + resistance));
            let step = length * length * (length / most - 1.0) / slope.sum::<f64>();
            if step.is_nan() || step <= ROUNDING * (resistance + mobilities[0]) {
                break;
            }
            resistance += step;
        }
    }
    limited_to(principal[0] * found[0] + principal[1] * found[1], most)
}

/// Returns the shortest time (s) in which a rebound comes back under an acceleration `press` (m/s2)
/// towards the surface: `time`, or that from a height (m), below which rebounds are left out.
pub(crate) fn shortest_rebound(press: f64, [height, time]: [f64; 2]) -> f64 {
    if press > 0.0 { (8.0 * height / press).sqrt().max(time) } else { time }
}

/// Returns the speed (m/s) away from a surface after an impact at the speed `approach` (m/s).
///
/// Under an acceleration `press` (m/s2) towards the surface, a particle that rebounds at the speed
/// u comes back after 2 u / press. If that is sooner than `shortest` (s), the impact is inelastic:
/// so a sequence of ever shorter rebounds ends, and a particle at rest is not thrown up.
pub(crate) fn rebound_speed(restitution: f64, approach: f64, press: f64, shortest: f64) -> f64 {
    let speed = restitution * approach.max(0.0);
    if 2.0 * speed > press * shortest { speed } else { 0.0 }
}
