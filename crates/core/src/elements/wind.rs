//! A gentle wind in gusts: a steady breeze and a few plane waves whose directions, lengths and
//! periods come from a seed. It depends on seed, time and position alone, so that a run can be
//! repeated. Its value is a force on each particle, or the velocity of air past triangles.
//!
//! Region in which a wind blows: an ellipsoid, still or moving, as a fan's.
//!
//! Plane waves: gusts of wind are sums of them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use serde::{Deserialize, Serialize};

use super::air::Air;
use super::force::{At, ByParticle, Force};
use crate::columns::{columns, columns_mut, row};
use crate::error::{Error, positive};
use crate::fused::mul_add;
use crate::path::{Path, Pose, Turn};
use crate::random::SplitMix;
use crate::sine::{sine, sines};
use crate::threads::{fork, threads};
use crate::vectors::Arch;

const WAVES: usize = 4;

/// Number of positions at which the wind is computed at a time.
pub(super) const BLOCK: usize = 32;

/// A number for each position of a block.
pub(super) type Each = [f64; BLOCK];

/// A breeze and four waves: forces on particles, or the velocity of the air.
///
/// ```
/// use a3_core::{Vector3, elements::Wind};
///
/// let gusty = Wind::new(7, Vector3::new(0.2, 0.0, 0.0));
/// assert!(gusty.at(0.0, [0.0; 3]) != gusty.at(1.0, [0.0; 3]));
/// assert_eq!(gusty.steady().at(1.0, [0.0; 3]), Vector3::new(0.2, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wind {
    #[serde(with = "crate::serial")]
    breeze: Vector3<f64>,
    waves: [Wave; WAVES],
    /// Air, if the wind blows on triangles.
    air: Option<Air>,
    /// Region outside of which it is calm, if it has one, and the time by which that is ahead (s).
    region: Option<(Region, f64)>,
}

impl Wind {
    /// Creates a wind that exerts `force` (N) on each particle on average, and at most 2.2 times as
    /// much.
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
        Self { breeze: force, waves, air: None, region: None }
    }

    /// Creates a wind that blows on the [triangles](crate::Network::set_triangles) of a network and
    /// on the faces of its rigid bodies, with air that moves at `velocity` (m/s) on average, and at
    /// most 2.2 times as fast.
    #[must_use]
    pub fn on_triangles(seed: u64, velocity: Vector3<f64>, air: Air) -> Self {
        Self { air: Some(air), ..Self::new(seed, velocity) }
    }

    /// Returns the same wind in a region alone.
    ///
    /// # Errors
    /// A radius of the region is not above 0.
    pub fn within(&self, region: Region) -> Result<Self, Error> {
        region.check()?;
        Ok(Self { region: Some((region, 0.0)), ..*self })
    }

    /// Returns the same gusts, `factor` times as strong.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            breeze: self.breeze * factor,
            waves: self.waves.map(|wave| Wave { amplitude: wave.amplitude * factor, ..wave }),
            ..*self
        }
    }

    /// Returns this wind without gusts.
    #[must_use]
    pub fn steady(&self) -> Self {
        let still =
            Wave { amplitude: Vector3::zeros(), number: Vector3::zeros(), rate: 0.0, phase: 0.0 };
        Self { waves: [still; WAVES], ..*self }
    }

    /// Returns this wind, shifted so that its time t (s) becomes 0.
    #[must_use]
    pub fn ahead(&self, t: f64) -> Self {
        Self {
            waves: self.waves.map(|wave| Wave { phase: wave.phase - wave.rate * t, ..wave }),
            region: self.region.map(|(region, ahead)| (region, ahead + t)),
            ..*self
        }
    }

    /// Returns a quarter of the shortest period of the gusts at a fixed position, and of the motion
    /// of the region in an interval (s).
    pub(crate) fn quarter_period(&self, times: [f64; 2]) -> f64 {
        let rates = self.waves.iter().map(|wave| wave.rate.abs());
        let of_gusts = 0.5 * std::f64::consts::PI / rates.fold(0.0, f64::max);
        self.region.map_or(of_gusts, |(region, ahead)| {
            of_gusts.min(region.quarter_period(times.map(|t| t + ahead)))
        })
    }

    /// Returns the times at which a motion of the region begins or ends (s).
    pub(crate) fn known_times(&self) -> impl Iterator<Item = f64> {
        let region = self.region.into_iter();
        region.flat_map(|(region, ahead)| region.known_times().map(move |t| t - ahead))
    }

    /// Returns the region at time t (s), if there is one.
    pub(crate) fn stream(&self, t: f64) -> Option<Stream> {
        self.region.map(|(region, ahead)| region.at(t + ahead, self.breeze))
    }

    /// Returns the air, if the wind blows on triangles.
    #[must_use]
    pub fn air(&self) -> Option<Air> {
        self.air
    }

    /// Returns the force (N) on a particle at x (m) at time t (s), or the velocity (m/s) of the air
    /// there.
    #[must_use]
    pub fn at(&self, t: f64, x: [f64; 3]) -> Vector3<f64> {
        self.in_stream(self.stream(t).as_ref(), t, x)
    }

    /// Returns the same, with the region at that time.
    pub(crate) fn in_stream(&self, stream: Option<&Stream>, t: f64, x: [f64; 3]) -> Vector3<f64> {
        let whole = self.everywhere(t, x);
        stream.map_or(whole, |stream| stream.wind(x, whole))
    }

    /// Returns the same, if there were no region.
    fn everywhere(&self, t: f64, x: [f64; 3]) -> Vector3<f64> {
        self.waves.iter().fold(self.breeze, |f, wave| {
            let sine = sine(wave.argument(t, x));
            f.zip_map(&wave.amplitude, |f, most| mul_add(most, sine, f))
        })
    }

    /// Returns the same for the positions of a block, with the same bits.
    #[inline(always)]
    pub(super) fn over(&self, t: f64, [x, y, z]: &[Each; 3]) -> [Each; 3] {
        let mut f = [self.breeze.x, self.breeze.y, self.breeze.z].map(|f| [f; BLOCK]);
        for wave in &self.waves {
            let mut gust = [0.0; BLOCK];
            for m in 0..BLOCK {
                gust[m] = wave.argument(t, [x[m], y[m], z[m]]);
            }
            sines(&mut gust);
            for (f, most) in f.iter_mut().zip(wave.amplitude.iter()) {
                for m in 0..BLOCK {
                    f[m] = mul_add(*most, gust[m], f[m]);
                }
            }
        }
        if let Some(stream) = self.stream(t) {
            for m in 0..BLOCK {
                let whole = Vector3::new(f[0][m], f[1][m], f[2][m]);
                let wind = stream.wind([x[m], y[m], z[m]], whole);
                for axis in 0..3 {
                    f[axis][m] = wind[axis];
                }
            }
        }
        f
    }

    /// Returns the differential of [`at`](Self::at) for a change `towards` of x.
    pub(super) fn differential(&self, t: f64, x: [f64; 3], towards: Vector3<f64>) -> Vector3<f64> {
        let change = self.waves.iter().fold(Vector3::zeros(), |df, wave| {
            df + wave.amplitude * (libm::cos(wave.argument(t, x)) * wave.number.dot(&towards))
        });
        self.stream(t).map_or(change, |stream| {
            let whole = self.everywhere(t, x);
            stream.differential((x, towards), [whole, change])
        })
    }
}

impl ByParticle for Wind {
    fn add(&self, t: f64, x: [&[f64]; 3], f: &mut [&mut [f64]; 3]) {
        Arch::new().dispatch(WindTask { wind: self, t, x, f });
    }
}

/// Task that adds the forces on particles at x to f.
struct WindTask<'a, 'b> {
    wind: &'a Wind,
    t: f64,
    x: [&'a [f64]; 3],
    f: &'a mut [&'b mut [f64]; 3],
}

impl WithSimd for WindTask<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.x[0].len();
        let mut x = [[0.0; BLOCK]; 3];
        for start in (0..n).step_by(BLOCK) {
            let block = start..n.min(start + BLOCK);
            for (x, from) in x.iter_mut().zip(self.x) {
                x[..block.len()].copy_from_slice(&from[block.clone()]);
            }
            let forces = self.wind.over(self.t, &x);
            for (f, forces) in self.f.iter_mut().zip(&forces) {
                for (f, force) in f[block.clone()].iter_mut().zip(forces) {
                    *f += force;
                }
            }
        }
    }
}

/// Lists the particles on which a wind exerts a force: of rigid bodies, the centres alone, because
/// the points that they carry have no mass.
fn blown(masses: &[f64]) -> impl Iterator<Item = usize> {
    let particles = masses.iter().enumerate();
    particles.filter(|(_, m)| **m > 0.0).map(|(i, _)| i)
}

impl Force for Wind {
    fn name(&self) -> &'static str {
        "wind"
    }

    fn is_driven(&self) -> bool {
        true
    }

    fn is_wind(&self) -> bool {
        true
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        let n = at.masses.len();
        if at.masses.contains(&0.0) {
            for i in blown(at.masses) {
                let force = self.at(at.t, row(at.x, n, i).into());
                for axis in 0..3 {
                    f[axis * n + i] += force[axis];
                }
            }
            return;
        }
        fork(threads(n), 0..n, 1, columns_mut(f), &|particles, mut f| {
            self.add(at.t, columns(at.x, &particles), &mut f);
        });
    }

    fn add_differential(&self, at: &At, [dx, _]: [&[f64]; 2], df: &mut [f64]) {
        let n = at.masses.len();
        for i in blown(at.masses) {
            let change = self.differential(at.t, row(at.x, n, i).into(), row(dx, n, i));
            for axis in 0..3 {
                df[axis * n + i] += change[axis];
            }
        }
    }

    fn by_particle(&self) -> Option<&dyn ByParticle> {
        Some(self)
    }
}

/// Ellipsoid about the direction of a wind. The wind is as strong as without a region at its
/// centre, and fades as (1 - q)3 towards its surface, where q, the squared distance from the centre
/// over that of the surface, is 1: force, first and second derivative vanish there, so that methods
/// of order four keep their order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// Position of its centre over time (m).
    pub path: Path,
    /// Rotation about its centre, if it has one, with which the wind turns.
    pub turn: Option<Turn>,
    /// Radius across the wind (m).
    pub radius: f64,
    /// Radius along the mean wind (m).
    pub length: f64,
}

impl Region {
    /// Checks the numbers of the region.
    ///
    /// # Errors
    /// A radius is not above 0.
    pub fn check(&self) -> Result<(), Error> {
        positive("the radius of a region", self.radius)?;
        positive("the length of a region", self.length)
    }

    /// Lists the times at which a motion of the region begins or ends (s).
    pub(super) fn known_times(self) -> impl Iterator<Item = f64> {
        let of_turn = self.turn.into_iter().flat_map(|turn| turn.known_times());
        self.path.known_times().into_iter().chain(of_turn)
    }

    /// Returns a quarter of the shortest period of the region's motion in an interval (s).
    pub(super) fn quarter_period(&self, times: [f64; 2]) -> f64 {
        let turn = self.turn.filter(|turn| turn.is_on(times));
        let of_turn =
            turn.map_or(f64::INFINITY, |turn| 0.5 * std::f64::consts::PI / turn.rate.abs());
        self.path.quarter_period(times).min(of_turn)
    }

    /// Returns the region at time t (s), for a wind along a direction before any turn.
    pub(super) fn at(&self, t: f64, direction: Vector3<f64>) -> Stream {
        let pose =
            Pose { place: self.path.at(t), orientation: self.turn.map(|turn| turn.orientation(t)) };
        let direction = direction.try_normalize(0.0).unwrap_or_else(Vector3::x);
        let across = (self.radius * self.radius).recip();
        Stream {
            axis: pose.outwards(direction),
            pose,
            across,
            along: (self.length * self.length).recip() - across,
        }
    }
}

/// Region at one time.
pub(crate) struct Stream {
    pose: Pose,
    /// Direction of the mean wind: a unit vector.
    axis: Vector3<f64>,
    /// Factors (1/m2) of the squared distance from the centre, and of that along the axis, in q.
    across: f64,
    along: f64,
}

impl Stream {
    /// Returns the smaller one of the radii across and along the wind (m).
    pub fn width(&self) -> f64 {
        self.across.max(self.across + self.along).sqrt().recip()
    }

    /// Returns the area (m2) of the largest section.
    pub fn section(&self) -> f64 {
        let length = self.across.min(self.across + self.along).sqrt().recip();
        std::f64::consts::PI * length / self.across.sqrt()
    }

    /// Returns whether a ball with that middle and radius (m) may reach into the region.
    pub fn reaches(&self, middle: Vector3<f64>, radius: f64) -> bool {
        self.squared(middle).0.sqrt() <= 1.0 + radius / self.width()
    }

    /// Returns the wind at x (m), if it blew with `whole` everywhere.
    pub fn wind(&self, x: [f64; 3], whole: Vector3<f64>) -> Vector3<f64> {
        let (left, _) = self.left(x);
        self.pose.outwards(whole) * (left * left * left)
    }

    /// Returns the change of the wind at x (m) if x changes by `towards` and the whole wind by
    /// `change`.
    pub fn differential(
        &self,
        (x, towards): ([f64; 3], Vector3<f64>),
        [whole, change]: [Vector3<f64>; 2],
    ) -> Vector3<f64> {
        let (left, slope) = self.left(x);
        let fades = 3.0 * left * left * slope.dot(&towards);
        self.pose.outwards(change) * (left * left * left) + self.pose.outwards(whole) * fades
    }

    /// Returns 1 - q at x (m), or 0 outside, and its gradient (1/m).
    fn left(&self, x: [f64; 3]) -> (f64, Vector3<f64>) {
        let (q, half) = self.squared(x.into());
        ((1.0 - q).max(0.0), half * -2.0)
    }

    /// Returns q at x (m) and half of its gradient (1/m).
    fn squared(&self, x: Vector3<f64>) -> (f64, Vector3<f64>) {
        let from_centre = x - self.pose.place.position;
        let ahead = from_centre.dot(&self.axis);
        let q = self.across * from_centre.norm_squared() + self.along * ahead * ahead;
        let half = from_centre * self.across + self.axis * (self.along * ahead);
        (q, half)
    }
}

/// Plane wave of a wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Wave {
    /// Amplitude (N, or m/s).
    #[serde(with = "crate::serial")]
    pub amplitude: Vector3<f64>,
    /// Wave number (rad/m).
    #[serde(with = "crate::serial")]
    pub number: Vector3<f64>,
    /// Angular frequency (rad/s).
    pub rate: f64,
    /// Phase (rad).
    pub phase: f64,
}

impl Wave {
    /// Returns the argument (rad) of its sine at a time (s) and a place (m).
    #[inline(always)]
    pub fn argument(&self, t: f64, [x, y, z]: [f64; 3]) -> f64 {
        let q = self.number;
        let begun = mul_add(-self.rate, t, self.phase);
        mul_add(q.x, x, mul_add(q.y, y, mul_add(q.z, z, begun)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{Path, Turn};

    #[test]
    fn a_wind_is_its_seed() {
        let (a, b) = (Wind::new(7, Vector3::z()), Wind::new(7, Vector3::z()));
        assert_eq!(a.at(1.5, [0.1, 0.2, 0.3]), b.at(1.5, [0.1, 0.2, 0.3]));
        assert_ne!(a, Wind::new(8, Vector3::z()));
    }

    /// Creates a wind in a region that swings and turns.
    fn fan() -> Wind {
        let region = Region {
            path: Path::Sine {
                center: Vector3::new(1.0, 0.0, 0.5),
                amplitude: Vector3::y(),
                rate: 2.0,
                phase: 0.3,
            },
            turn: Some(Turn { axis: Vector3::y(), rate: 1.3, start: 0.1, end: None }),
            radius: 9.0,
            length: 14.0,
        };
        let wind = Wind::new(3, Vector3::new(1.0, -0.5, 2.0));
        wind.within(region).unwrap()
    }

    #[test]
    fn the_differential_is_that_of_the_wind() {
        let step = 1e-6;
        for wind in [fan(), Wind::new(3, Vector3::new(1.0, -0.5, 2.0))] {
            for x in [[1.0, -0.4, 2.0], [5.0, 3.0, -6.0], [90.0, 0.0, 0.0]] {
                let towards = Vector3::new(0.3, -0.7, 0.6);
                let at = |share: f64| wind.at(0.7, (Vector3::from(x) + towards * share).into());
                let quotient = (at(step) - at(-step)) / (2.0 * step);
                let error = (wind.differential(0.7, x, towards) - quotient).norm();
                assert!(error < 1e-8, "{x:?}: {error}");
            }
        }
    }

    #[test]
    fn blocks_of_particles_feel_what_one_does() {
        blocks_agree(&Wind::new(3, Vector3::new(1.0, -0.5, 2.0)));
        blocks_agree(&fan());
    }

    fn blocks_agree(wind: &Wind) {
        // A whole block, a part of one, and a particle far away.
        let n = BLOCK + 5;
        let x = [1.7, -0.3, 0.9].map(|q| (0..n).map(|i| q * i as f64).collect::<Vec<_>>());
        let [mut x, y, z] = x;
        x[2] = 1e9;
        let mut f = [[1.0; BLOCK + 5]; 3];
        let [fx, fy, fz] = &mut f;
        wind.add(0.7, [&x, &y, &z], &mut [fx, fy, fz]);
        for i in 0..n {
            let expected = wind.at(0.7, [x[i], y[i], z[i]]);
            for axis in 0..3 {
                assert_eq!(f[axis][i], 1.0 + expected[axis], "{i}");
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
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
