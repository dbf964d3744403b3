//! Air that streams past a rigid body: its force and torque, by a quadrature over the faces.
//!
//! The faces are small beside the body, and smaller in the region of a wind. The nodes turn with
//! the body, and no piece is added or left out where the wind is not zero: so force and torque are
//! as smooth as the wind.

use nalgebra::Vector3;

use crate::elements::{Airflow, Stream};
use crate::rigid::{Face, Moving};

/// Number of pieces of a flat side that bounds the work in long, thin regions, where fewer do not
/// suffice.
const MOST_PIECES: f64 = 1000.0;

/// Body in a stream of air at one time.
pub(super) struct Pass<'a> {
    pub airflow: &'a Airflow,
    /// Region of the wind, if it has one.
    pub stream: Option<&'a Stream>,
    /// Time (s).
    pub t: f64,
    /// Position of the centre (m).
    pub place: Vector3<f64>,
    /// Velocity of the centre (m/s).
    pub velocity: Vector3<f64>,
    pub moving: Moving,
}

impl Pass<'_> {
    /// Returns the force (N) and the torque (N m) about the centre of a body with these faces and
    /// that radius (m).
    pub fn over(&self, faces: &[Face], radius: f64) -> [Vector3<f64>; 2] {
        let mut sum = [Vector3::zeros(); 2];
        let Some(stream) = self.stream else {
            for face in faces {
                face.nodes(radius, &mut |at, area| {
                    self.add([at, area], [1.0, 0.0], &mut sum);
                });
            }
            return sum;
        };
        let area = stream.section().min(4.0 * radius * radius);
        let longest = stream.width().max((area / MOST_PIECES).sqrt());
        let is_near = |middle: Vector3<f64>, reach: f64| {
            stream.reaches(self.place + self.moving.rotation * middle, reach)
        };
        for face in faces {
            // Still air everywhere, and in the region what the wind changes.
            face.nodes(radius, &mut |at, area| {
                self.add([at, area], [0.0, 1.0], &mut sum);
            });
            face.pieces(longest, &is_near, &mut |piece| {
                piece.nodes(longest.min(radius), &mut |at, area| {
                    self.add([at, area], [1.0, -1.0], &mut sum);
                });
            });
        }
        sum
    }

    /// Adds the force and torque at a node, times the first share in the wind and times the second
    /// in still air.
    fn add(
        &self,
        [at, area]: [Vector3<f64>; 2],
        [wind, still]: [f64; 2],
        sum: &mut [Vector3<f64>; 2],
    ) {
        let [arm, area] = [at, area].map(|vector| self.moving.rotation * vector);
        let own = self.velocity + self.moving.spin.cross(&arm);
        let mut force = Vector3::zeros();
        if wind != 0.0 {
            let blown = self
                .airflow
                .wind
                .in_stream(self.stream, self.t, (self.place + arm).into());
            force += self.airflow.on_closed(blown - own, area) * wind;
        }
        if still != 0.0 {
            force += self.airflow.on_closed(-own, area) * still;
        }
        sum[0] += force;
        sum[1] += arm.cross(&force);
    }
}
