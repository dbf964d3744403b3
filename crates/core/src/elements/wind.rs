//! A gentle wind in gusts: a steady breeze and a few plane waves whose directions, lengths and periods come from
//! a seed. A pure function of seed, time and position, so that every stage of a step feels the same wind and a run
//! can be repeated. It pushes each particle alike, or it is the velocity of air that streams past triangles.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Air;
use crate::random::SplitMix;

const WAVES: usize = 4;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Wave {
    /// In N, or m/s.
    #[serde(with = "crate::serial")]
    amplitude: Vector3<f64>,
    /// In rad/m.
    #[serde(with = "crate::serial")]
    number: Vector3<f64>,
    /// In rad/s.
    rate: f64,
    /// In rad.
    phase: f64,
}

impl Wave {
    fn argument(&self, t: f64, x: [f64; 3]) -> f64 {
        let q = self.number;
        q.x * x[0] + q.y * x[1] + q.z * x[2] - self.rate * t + self.phase
    }
}

/// A breeze and four waves: forces on particles, or the velocity of the air.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wind {
    #[serde(with = "crate::serial")]
    breeze: Vector3<f64>,
    waves: [Wave; WAVES],
    /// What blows on triangles.
    air: Option<Air>,
}

impl Wind {
    /// A wind that pushes each particle by `force` (N) on the average, and never by more than 2.2 times that.
    #[must_use]
    pub fn new(seed: u64, force: Vector3<f64>) -> Self {
        let mut random = SplitMix(seed);
        let strength = force.norm();
        let waves = std::array::from_fn(|_| {
            let direction = Vector3::from_fn(|_, _| random.between(-1.0, 1.0));
            Wave {
                amplitude: 0.2 * force + 0.1 * strength * direction / direction.norm().max(1.0),
                number: Vector3::from_fn(|_, _| random.between(-1.5, 1.5)),
                rate: random.between(0.8, 3.5),
                phase: random.between(0.0, std::f64::consts::TAU),
            }
        });
        Self {
            breeze: force,
            waves,
            air: None,
        }
    }

    /// A wind that pushes at the [triangles](crate::Network::set_triangles) of a network, with air that moves at
    /// `velocity` (m/s) on the average, and never faster than 2.2 times that.
    #[must_use]
    pub fn on_triangles(seed: u64, velocity: Vector3<f64>, air: Air) -> Self {
        Self {
            air: Some(air),
            ..Self::new(seed, velocity)
        }
    }

    /// The same gusts, so many times as strong.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            breeze: self.breeze * factor,
            waves: self.waves.map(|wave| Wave {
                amplitude: wave.amplitude * factor,
                ..wave
            }),
            ..*self
        }
    }

    /// The wind whose time 0 is this one's time t (s).
    #[must_use]
    pub fn ahead(&self, t: f64) -> Self {
        Self {
            waves: self.waves.map(|wave| Wave {
                phase: wave.phase - wave.rate * t,
                ..wave
            }),
            ..*self
        }
    }

    /// What blows on triangles, if it does.
    #[must_use]
    pub fn air(&self) -> Option<Air> {
        self.air
    }

    /// The force (N) on a particle at x (m) at time t (s), or the velocity (m/s) of the air there.
    #[must_use]
    pub fn at(&self, t: f64, x: [f64; 3]) -> Vector3<f64> {
        self.waves.iter().fold(self.breeze, |f, wave| {
            f + wave.amplitude * libm::sin(wave.argument(t, x))
        })
    }

    /// How that changes with x, as x moves by `towards`.
    pub(crate) fn differential(&self, t: f64, x: [f64; 3], towards: Vector3<f64>) -> Vector3<f64> {
        self.waves.iter().fold(Vector3::zeros(), |df, wave| {
            df + wave.amplitude * (libm::cos(wave.argument(t, x)) * wave.number.dot(&towards))
        })
    }

    /// Sets f to the forces on particles at x.
    pub(crate) fn blow(&self, t: f64, x: [&[f64]; 3], f: &mut [&mut [f64]; 3]) {
        for f in &mut *f {
            f.fill(0.0);
        }
        self.add(t, x, f);
    }

    pub(crate) fn add(&self, t: f64, x: [&[f64]; 3], f: &mut [&mut [f64]; 3]) {
        for i in 0..x[0].len() {
            let force = self.at(t, x.map(|x| x[i]));
            for axis in 0..3 {
                f[axis][i] += force[axis];
            }
        }
    }

    pub(crate) fn add_differential(&self, t: f64, x: &[f64], dx: &[f64], df: &mut [f64]) {
        let n = x.len() / 3;
        for i in 0..n {
            let at = [x[i], x[n + i], x[2 * n + i]];
            let towards = Vector3::new(dx[i], dx[n + i], dx[2 * n + i]);
            let change = self.differential(t, at, towards);
            for axis in 0..3 {
                df[axis * n + i] += change[axis];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wind_is_its_seed() {
        let (a, b) = (Wind::new(7, Vector3::z()), Wind::new(7, Vector3::z()));
        assert_eq!(a.at(1.5, [0.1, 0.2, 0.3]), b.at(1.5, [0.1, 0.2, 0.3]));
        assert_ne!(a, Wind::new(8, Vector3::z()));
    }

    #[test]
    fn gusts_stay_within_their_bound_and_average_to_the_breeze() {
        let mean = Vector3::new(0.0, 0.0, 2.0);
        let wind = Wind::new(1, mean);
        let mut sum = Vector3::zeros();
        for k in 0..100_000 {
            let force = wind.at(f64::from(k) * 0.01, [0.3, -0.2, 0.1]);
            assert!(force.norm() <= 2.2 * mean.norm());
            sum += force;
        }
        assert!((sum / 100_000.0 - mean).norm() < 0.05 * mean.norm());
    }
}
