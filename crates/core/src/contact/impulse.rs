//! The laws of an impact, for all that touches or tightens: restitution, Coulomb friction, and the
//! separation that bodies get back; and the impulses of a step.

use nalgebra::Vector3;

use super::skin::Law;

/// Fraction of the missing separation of bodies that is restored in a step.
const RESTORED_SHARE: f64 = 0.1;

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
    if length > most {
        slip * (most / length)
    } else {
        slip
    }
}

/// Returns the shortest time (s) in which a rebound comes back under an acceleration `press` (m/s2)
/// towards the surface: `time`, or that from a height (m), below which rebounds are left out.
pub(crate) fn shortest_rebound(press: f64, [height, time]: [f64; 2]) -> f64 {
    if press > 0.0 {
        (8.0 * height / press).sqrt().max(time)
    } else {
        time
    }
}

/// Returns the speed (m/s) away from a surface after an impact at the speed `approach` (m/s).
///
/// Under an acceleration `press` (m/s2) towards the surface, a particle that rebounds at the speed
/// u comes back after 2 u / press. If that is sooner than `shortest` (s), the impact is inelastic:
/// so a sequence of ever shorter rebounds ends, and a particle at rest is not thrown up.
pub(crate) fn rebound_speed(restitution: f64, approach: f64, press: f64, shortest: f64) -> f64 {
    let speed = restitution * approach.max(0.0);
    if 2.0 * speed > press * shortest {
        speed
    } else {
        0.0
    }
}
