//! The camera, whose eye is on a sphere around its target.

use nalgebra::{Isometry3, Matrix4, Orthographic3, Perspective3, Point3, Vector3};

/// Vertical field of view (rad).
const FIELD_OF_VIEW: f32 = 0.75;
/// Largest pitch (rad), so that the eye does not pass over the poles.
const MAX_PITCH: f32 = 1.5;
/// Initial distances of the eye (m) for which the unit of length is 1 m.
const METRE_DISTANCES: std::ops::Range<f32> = 0.3..100.0;
/// Least and largest distance of the eye, and farthest target, in units of length.
const MIN_DISTANCE: f32 = 0.05;
const MAX_DISTANCE: f32 = 1e3;
const MAX_TARGET_DISTANCE: f32 = 1e6;

/// A camera that looks at its target from a distance, turned by a yaw around the vertical and
/// raised by a pitch.
///
/// ```
/// use a3_render::Camera;
///
/// let mut camera = Camera::look_at([0.0, 1.0, 3.0], [0.0; 3]);
/// // What it looks at is in the middle of the picture, 3.16 m away.
/// let ([x, y], distance) = camera.project([0.0; 3], 1.5).unwrap();
/// let near = |a: f32, b: f32| (a - b).abs() < 1e-4;
/// assert!(near(x, 0.5) && near(y, 0.5) && near(distance, 10f32.sqrt()));
/// camera.orbit(0.5, 0.0);
/// assert!(near(camera.eye().coords.norm(), 10f32.sqrt()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Target (m).
    target: Point3<f32>,
    /// Yaw (rad), from the z-axis towards the x-axis.
    yaw: f32,
    /// Pitch (rad).
    pitch: f32,
    /// Distance of the eye from the target (m).
    distance: f32,
    /// Whether the projection is parallel: orthographic, not perspective.
    parallel: bool,
    /// Unit of length of the scene (m).
    unit: f32,
    /// Left, top, width and height of the part of the picture in whose middle the target is, as
    /// shares of the picture.
    focus: [f32; 4],
}

impl Camera {
    /// Creates a camera that looks from `eye` at `target` (m), which must not be the same point.
    #[must_use]
    pub fn look_at(eye: [f32; 3], target: [f32; 3]) -> Self {
        let target = Point3::from(target);
        let d = Point3::from(eye) - target;
        let distance = d.norm().max(1e-9);
        let sine = (d.y / distance).clamp(-1.0, 1.0);
        let power = 10.0f32.powf(distance.log10().floor());
        let in_metres = METRE_DISTANCES.contains(&distance);
        Self {
            target,
            yaw: d.x.atan2(d.z),
            pitch: sine.asin().clamp(-MAX_PITCH, MAX_PITCH),
            distance,
            parallel: false,
            unit: if in_metres { 1.0 } else { power },
            focus: [0.0, 0.0, 1.0, 1.0],
        }
    }

    /// Returns the unit of length (m) of the scene: 1, or a power of ten for a much smaller or
    /// larger scene. It sets the size of balls, and of the squares of the floor.
    #[must_use]
    pub fn unit(&self) -> f32 {
        self.unit
    }

    /// Chooses the part of the picture in which the view is centred and into which it fits: its
    /// left, top, width and height, as shares of the picture. The rest shows the surroundings.
    ///
    /// # Panics
    /// Panics if the width or the height is not above 0.
    pub fn set_focus(&mut self, focus: [f32; 4]) {
        let is_open = focus[2] > 0.0 && focus[3] > 0.0;
        assert!(is_open, "an empty focus: {focus:?}");
        self.focus = focus;
    }

    /// Returns whether another camera shows the same in its focus.
    #[must_use]
    pub fn shows_as(&self, other: &Self) -> bool {
        Self { focus: other.focus, ..*self } == *other
    }

    /// Moves the target, unless the new one is too far away.
    fn aim(&mut self, target: Point3<f32>) {
        let farthest = MAX_TARGET_DISTANCE * self.unit.max(1.0);
        if target.coords.iter().all(|c| c.abs() < farthest) {
            self.target = target;
        }
    }

    /// Returns whether the projection is parallel: orthographic, not perspective.
    #[must_use]
    pub fn is_parallel(&self) -> bool {
        self.parallel
    }

    /// Chooses an orthographic or a perspective projection. Things at the distance of the target
    /// keep their size.
    pub fn set_parallel(&mut self, parallel: bool) {
        self.parallel = parallel;
    }

    /// Moves eye and target by a vector (m).
    pub fn shift(&mut self, by: [f32; 3]) {
        self.aim(self.target + Vector3::from(by));
    }

    /// Turns the eye around the target (rad).
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        if yaw.is_finite() && pitch.is_finite() {
            self.yaw = (self.yaw + yaw).rem_euclid(std::f32::consts::TAU);
            self.pitch = (self.pitch + pitch).clamp(-MAX_PITCH, MAX_PITCH);
        }
    }

    /// Turns the eye around the target (rad), but no further down than to a height (m), unless it
    /// is below that already.
    pub fn orbit_above(&mut self, yaw: f32, pitch: f32, height: f32) {
        let sine = (height - self.target.y) / self.distance;
        let least = sine.clamp(-1.0, 1.0).asin().min(self.pitch);
        self.orbit(yaw, pitch.max(least - self.pitch));
    }

    /// Moves eye and target parallel to the picture, by fractions of its height.
    pub fn pan(&mut self, right: f32, up: f32) {
        let height = 2.0 * self.distance * (0.5 * FIELD_OF_VIEW).tan() / self.focus[3];
        let (x, y, _) = self.axes();
        self.aim(self.target + (x * right + y * up) * height);
    }

    /// Sets the distance of the eye from the target (m), within bounds.
    fn set_distance(&mut self, distance: f32) {
        self.distance = distance.clamp(MIN_DISTANCE * self.unit, MAX_DISTANCE * self.unit);
    }

    /// Multiplies the distance of the eye from the target by a factor.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() {
            self.set_distance(self.distance * factor);
        }
    }

    /// Changes the distance as [`zoom`](Self::zoom) does, but keeps the point that is seen at a
    /// place in the picture, at the distance of the target, at that place.
    pub fn zoom_at(&mut self, factor: f32, at: [f32; 2], aspect: f32) {
        let stays = Point3::from(self.unproject(at, self.distance, aspect));
        let before = self.distance;
        self.zoom(factor);
        self.aim(stays + (self.target - stays) * (self.distance / before));
    }

    /// Turns the eye to a yaw around the vertical, from the z-axis towards the x-axis, and a pitch
    /// (rad).
    pub fn turn_to(&mut self, yaw: f32, pitch: f32) {
        (self.yaw, self.pitch) = (0.0, 0.0);
        self.orbit(yaw, pitch);
    }

    /// Moves the camera so that a ball (m) fills the picture, without turning it.
    pub fn see(&mut self, center: [f32; 3], radius: f32) {
        if radius < MAX_DISTANCE * self.unit {
            self.aim(Point3::from(center));
            self.set_distance(radius / (0.5 * FIELD_OF_VIEW).sin());
        }
    }

    /// Returns the position of the eye (m).
    #[must_use]
    pub fn eye(&self) -> Point3<f32> {
        let (_, _, z) = self.axes();
        self.target + z * self.distance
    }

    /// Returns the target (m).
    #[must_use]
    pub fn target(&self) -> Point3<f32> {
        self.target
    }

    /// Returns the unit vectors to the right, up, and towards the eye.
    #[must_use]
    pub fn axes(&self) -> (Vector3<f32>, Vector3<f32>, Vector3<f32>) {
        let ((sy, cy), (sp, cp)) = (self.yaw.sin_cos(), self.pitch.sin_cos());
        let z = Vector3::new(cp * sy, sp, cp * cy);
        let x = Vector3::new(cy, 0.0, -sy);
        (x, z.cross(&x), z)
    }

    /// Returns the matrix from world to clip space, with z from 0 to 1, for a picture of this width
    /// over height. The field of view is horizontal in a tall picture, so that the scene stays in
    /// view.
    #[must_use]
    pub fn view_projection(&self, aspect: f32) -> Matrix4<f32> {
        #[rustfmt::skip]
        let half_depth = Matrix4::new(
            1.0, 0.0, 0.0, 0.0,
            0.0, 1.0, 0.0, 0.0,
            0.0, 0.0, 0.5, 0.5,
            0.0, 0.0, 0.0, 1.0,
        );
        let [left, top, width, height] = self.focus;
        let aspect = aspect * width / height;
        let (right, up) = (2.0 * left + width - 1.0, 1.0 - 2.0 * top - height);
        #[rustfmt::skip]
        let focus = Matrix4::new(
            width, 0.0, 0.0, right,
            0.0, height, 0.0, up,
            0.0, 0.0, 1.0, 0.0,
            0.0, 0.0, 0.0, 1.0,
        );
        let fovy = Self::field_of_view(aspect);
        let projection = if self.parallel {
            let half = self.distance * (0.5 * fovy).tan();
            // Things behind the eye are visible too: a parallel projection has no point of view.
            let far = 5.0 * self.distance + 50.0 * self.unit;
            let wide = half * aspect;
            Orthographic3::new(-wide, wide, -half, half, -far, far).to_homogeneous()
        } else {
            let near = 0.02 * self.distance;
            let far = 20.0 * self.distance + 100.0 * self.unit;
            Perspective3::new(aspect, fovy, near, far).to_homogeneous()
        };
        focus
            * half_depth
            * projection
            * Isometry3::look_at_rh(&self.eye(), &self.target, &Vector3::y()).to_homogeneous()
    }

    /// Returns the vertical field of view of a picture of this width over height (rad).
    fn field_of_view(aspect: f32) -> f32 {
        2.0 * ((0.5 * FIELD_OF_VIEW).tan() / aspect.min(1.0)).atan()
    }

    /// Projects a point of the world (m). Returns its place in the picture, from 0 to 1 from the
    /// left and from the top, and its distance from the eye along the view (m); `None` for a point
    /// behind the eye.
    #[must_use]
    pub fn project(&self, point: [f32; 3], aspect: f32) -> Option<([f32; 2], f32)> {
        self.projection(aspect)(point)
    }

    /// Returns a function that [projects](Self::project) many points.
    pub fn projection(&self, aspect: f32) -> impl Fn([f32; 3]) -> Option<([f32; 2], f32)> + use<> {
        let matrix = self.view_projection(aspect);
        let (eye, (_, _, towards), parallel) = (self.eye(), self.axes(), self.parallel);
        move |point| {
            let point = Point3::from(point);
            let clip = matrix * point.to_homogeneous();
            let place = [0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w];
            let depth = towards.dot(&(eye - point));
            (parallel || clip.w > 0.0).then_some((place, depth))
        }
    }

    /// Returns the point of the world (m) at a place in the picture, at a distance from the eye
    /// along the view (m): the inverse of [`project`](Self::project).
    #[must_use]
    pub fn unproject(&self, at: [f32; 2], distance: f32, aspect: f32) -> [f32; 3] {
        let depth = [distance, self.distance][usize::from(self.parallel)];
        let [left, top, width, height] = self.focus;
        let at = [(at[0] - left) / width, (at[1] - top) / height];
        let aspect = aspect * width / height;
        let half = depth * (0.5 * Self::field_of_view(aspect)).tan();
        let (x, y, z) = self.axes();
        let across = x * ((2.0 * at[0] - 1.0) * half * aspect) + y * ((1.0 - 2.0 * at[1]) * half);
        (self.eye() + across - z * distance).coords.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zooming_leaves_what_is_under_the_pointer() {
        for (at, aspect) in [([0.5, 0.5], 1.7), ([0.2, 0.9], 1.7), ([0.8, 0.1], 0.5)] {
            let mut camera = Camera::look_at([3.0, 2.0, 5.0], [0.1, 1.0, -0.2]);
            let distance = camera.distance;
            let stays = camera.unproject(at, distance, aspect);
            camera.zoom_at(0.7, at, aspect);
            assert!((camera.distance / distance - 0.7).abs() < 1e-6);
            let (found, _) = camera.project(stays, aspect).unwrap();
            let off = (found[0] - at[0]).hypot(found[1] - at[1]);
            assert!(off < 1e-5, "{found:?}");
            camera.zoom_at(f32::NAN, at, aspect);
            assert!(camera.eye().coords.iter().all(|c| c.is_finite()));
        }
    }

    #[test]
    fn the_eye_turns_down_to_the_floor_and_no_further() {
        let mut camera = Camera::look_at([3.0, 2.0, 5.0], [0.1, 1.0, -0.2]);
        camera.orbit_above(0.1, -9.0, 0.25);
        assert!((camera.eye().y - 0.25).abs() < 1e-4, "{}", camera.eye());
        camera.orbit_above(0.1, 0.5, 0.25);
        assert!(camera.eye().y > 1.0);
        // One that is below stays where it is, and turns up.
        let mut below = Camera::look_at([3.0, -1.0, 5.0], [0.1, 1.0, -0.2]);
        below.orbit_above(0.0, -0.1, 0.25);
        assert!((below.eye().y + 1.0).abs() < 1e-4, "{}", below.eye());
        below.orbit_above(0.0, 0.1, 0.25);
        assert!(below.eye().y > -0.9);
    }

    #[test]
    fn an_orthographic_picture_has_parallel_lines_and_the_same_size_at_the_target() {
        for aspect in [1.7, 0.6] {
            let mut camera = Camera::look_at([3.0, 2.0, 5.0], [0.1, 1.0, -0.2]);
            let (x, _, z) = camera.axes();
            let seen = |camera: &Camera, p: Point3<f32>| camera.project(p.into(), aspect).unwrap();
            let beside = camera.target() + x * 0.3;
            let ([before, _], _) = seen(&camera, beside);
            camera.set_parallel(true);
            let ([after, _], depth) = seen(&camera, beside);
            assert!((before - after).abs() < 1e-5 && (depth - camera.distance).abs() < 1e-4);
            // A point nearer to the eye or behind it is seen at the same place.
            for near in [1.0, 20.0] {
                let ([there, _], depth) = seen(&camera, beside + z * near);
                assert!((there - after).abs() < 1e-5);
                assert!((depth - (camera.distance - near)).abs() < 1e-3, "{depth}");
            }
            let point = [0.4, 1.3, 0.9];
            let (at, depth) = camera.project(point, aspect).unwrap();
            let back = camera.unproject(at, depth, aspect);
            assert!((Point3::from(back) - Point3::from(point)).norm() < 1e-4);
            let stays = camera.unproject([0.2, 0.7], camera.distance, aspect);
            camera.zoom_at(0.7, [0.2, 0.7], aspect);
            let (found, _) = camera.project(stays, aspect).unwrap();
            assert!((found[0] - 0.2).hypot(found[1] - 0.7) < 1e-5, "{found:?}");
        }
    }

    #[test]
    fn a_ball_that_is_to_be_seen_fills_the_picture() {
        for (aspect, yaw, pitch) in [(1.7, 0.0, 0.0), (1.0, 1.6, 0.3), (0.6, -2.0, 1.5)] {
            let mut camera = Camera::look_at([90.0, 2.0, 5.0], [80.0, 1.0, -0.2]);
            camera.turn_to(yaw, pitch);
            camera.see([1.0, -2.0, 3.0], 0.5);
            let (x, y, z) = camera.axes();
            assert!((z.y - pitch.sin()).abs() < 1e-5);
            let mut most = 0.0_f32;
            for k in 0..64 {
                let (sin, cos) = (k as f32 * 0.1).sin_cos();
                let point = Point3::new(1.0, -2.0, 3.0) + 0.5 * (x * cos + y * sin);
                let ([u, v], _) = camera.project(point.coords.into(), aspect).unwrap();
                most = most.max((u - 0.5).abs()).max((v - 0.5).abs());
            }
            assert!((0.42..0.5).contains(&most), "{most}");
        }
    }

    #[test]
    fn no_drag_turns_it_into_nan() {
        let mut camera = Camera::look_at([0.0, 0.0, 5.0], [0.0; 3]);
        let mut seed = 1u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let wild = match seed >> 60 {
                0 => f32::INFINITY,
                1 => f32::NAN,
                2 => 0.0,
                3 => 1e30,
                _ => 1.0,
            };
            wild * ((seed >> 40) as f32 / (1u64 << 23) as f32 - 1.0)
        };
        for k in 0..1_000_000 {
            camera.orbit(random(), random());
            camera.pan(random(), random());
            camera.zoom(1.0 + 0.3 * random());
            if k % 16 == 0 {
                let matrix = camera.view_projection(1.6);
                assert!(matrix.iter().all(|m| m.is_finite()), "{camera:?}");
            }
        }
    }

    #[test]
    fn what_is_a_thousand_times_as_small_looks_the_same() {
        for parallel in [false, true] {
            let seen = |unit: f32| {
                let scaled = |p: [f32; 3]| p.map(|x| unit * x);
                let mut camera = Camera::look_at(scaled([2.0, 3.0, 4.0]), scaled([0.0, 1.0, 0.0]));
                camera.set_parallel(parallel);
                camera.zoom(0.1);
                let matrix = camera.view_projection(1.5);
                let clip = matrix * Point3::from(scaled([0.1, 1.2, 0.1])).to_homogeneous();
                (camera.unit() / unit, clip.xyz() / clip.w)
            };
            let metres = seen(1.0);
            for unit in [1e-6, 1e-3, 1e3] {
                let found = seen(unit);
                assert!((found.0 / metres.0 - 1.0).abs() < 1e-5, "{found:?}");
                assert!((found.1 - metres.1).norm() < 1e-4, "{found:?} {metres:?}");
            }
        }
    }
}
