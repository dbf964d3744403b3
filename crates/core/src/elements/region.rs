//! Region in which a wind blows: an ellipsoid, still or moving, as a fan's.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, positive};
use crate::path::{Path, Pose, Turn};

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
        let of_turn = turn.map_or(f64::INFINITY, |turn| {
            0.5 * std::f64::consts::PI / turn.rate.abs()
        });
        self.path.quarter_period(times).min(of_turn)
    }

    /// Returns the region at time t (s), for a wind along a direction before any turn.
    pub(super) fn at(&self, t: f64, direction: Vector3<f64>) -> Stream {
        let pose = Pose {
            place: self.path.at(t),
            orientation: self.turn.map(|turn| turn.orientation(t)),
        };
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
