//! How far vertices are from the straight courses along which the collision safeguard takes them.

use nalgebra::Vector3;

use super::layer::{Buffers, ContactLayer};
use super::obstacle::Obstacle;
use super::surface::Surface;
use crate::interval::Interval;

/// Largest distance of a cubic course from its chord, over the step times the difference between
/// the velocity at one end and that of the chord.
const BULGE: f64 = 4.0 / 27.0;

/// Positions (m) and velocities (m/s) of all vertices at both ends of a step.
struct StepEnds<'a> {
    x: [&'a [Vector3<f64>]; 2],
    v: [&'a [Vector3<f64>]; 2],
    h: f64,
}

impl StepEnds<'_> {
    /// Returns the largest distance of vertex i from its straight course (m).
    fn stray(&self, i: usize) -> f64 {
        let chord = self.x[1][i] - self.x[0][i];
        let strays = self.v.map(|v| (v[i] * self.h - chord).norm());
        BULGE * (strays[0] + strays[1])
    }

    /// Returns the positions of vertex i at both ends (m).
    fn ends(&self, i: usize) -> [Vector3<f64>; 2] {
        self.x.map(|x| x[i])
    }
}

/// Box around all that something reaches in a step (m).
struct Around {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Around {
    /// Returns the box around places (m), and all that is nearer to them than a distance (m).
    fn new(places: impl Iterator<Item = Vector3<f64>>, reach: f64) -> Self {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let start = [low, high].map(Vector3::repeat);
        let [low, high] = places.fold(start, |[low, high], x| [low.inf(&x), high.sup(&x)]);
        let reach = Vector3::repeat(reach);
        Self { low: low - reach, high: high + reach }
    }

    /// Returns the box around an obstacle between two times (s): a floor is all that is below it.
    fn of(obstacle: &Obstacle, times: [f64; 2]) -> Self {
        let places = times.map(|t| obstacle.path.at(t).position);
        let mut around = Self::new(places.into_iter(), obstacle.shape.reach());
        if obstacle.shape.reach().is_infinite() {
            around.high.y = places[0].y.max(places[1].y);
        }
        around
    }

    fn meets(&self, other: &Self) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}

/// Returns the largest distance of a vertex from its straight course in a step of h (s) from the
/// state y0 at time t (s) to y1, over the least thickness that is not 0: of vertices of rigid
/// bodies that may meet something and, if `soft_count`, of all others.
pub(crate) fn bulge(
    layer: &ContactLayer,
    Interval { t, h }: Interval,
    [y0, y1]: [&[f64]; 2],
    soft_count: bool,
) -> f64 {
    let (surface, obstacles) = (layer.surface(), layer.obstacles());
    let soft = |i: &&u32| surface.solid(**i).is_none();
    let soft = surface.bodies.vertices.iter().filter(soft);
    let has_soft = soft.clone().chain(&surface.drops.vertices).next().is_some();
    if surface.rigid().is_empty() && !(soft_count && has_soft) {
        return 0.0;
    }
    let half = 3 * surface.particles();
    let bulge = layer.scratch.lend(|Buffers { motion, .. }| {
        let (begins, ends) = (&mut motion.x0, &mut motion.moves.points);
        surface.place(obstacles, t, &y0[..half], begins);
        surface.place(obstacles, t + h, &y1[..half], ends);
        let (before, after) = (&mut motion.v0.points, &mut motion.v.points);
        surface.speeds(obstacles, t, &y0[half..2 * half], before);
        surface.speeds(obstacles, t + h, &y1[half..2 * half], after);
        let courses = StepEnds { x: [begins, ends], v: [before, after], h };
        let obstacles: Vec<_> = (obstacles.iter().map(|it| Around::of(it, [t, t + h]))).collect();
        let rigid = rigid_near(surface, &obstacles, &courses);
        let soft = soft.chain(&surface.drops.vertices).map(|i| *i as usize);
        let soft = soft.filter(|_| soft_count);
        let counted: Vec<_> = rigid.into_iter().chain(soft).collect();
        let turning = surface.obstacles.vertices.iter().map(|i| *i as usize);
        let turning = turning.filter(|_| !counted.is_empty());
        let strays = counted.iter().copied().chain(turning).map(|i| courses.stray(i));
        strays.fold(0.0, f64::max)
    });
    bulge / surface.least_thickness()
}

/// Returns the vertices of rigid bodies that come near something in a step: an obstacle or, if
/// surfaces touch one another, soft ones and bodies that are not joined to theirs.
fn rigid_near(surface: &Surface, obstacles: &[Around], courses: &StepEnds) -> Vec<usize> {
    let thickest = surface.thickest();
    let around = |center: usize, points: std::ops::Range<usize>| {
        let away = points.map(|i| (courses.x[0][i] - courses.x[0][center]).norm());
        let reach = away.fold(0.0, f64::max) + courses.stray(center) + 2.0 * thickest;
        Around::new(courses.ends(center).into_iter(), reach)
    };
    let rigid = surface.rigid();
    let bodies: Vec<_> = (rigid.iter().map(|it| around(it.center(), it.points()))).collect();
    let soft = surface.bodies.vertices.iter().map(|i| *i as usize);
    let soft = soft.filter(|i| surface.touches_itself && surface.solid(*i as u32).is_none());
    let strays = soft.clone().map(|i| courses.stray(i)).fold(0.0, f64::max);
    let soft = Around::new(soft.flat_map(|i| courses.ends(i)), strays);
    let meets = |k: usize| {
        let own = &bodies[k];
        let center = |k: usize| [rigid[k].center() as u32];
        let touches = |j: usize| j != k && !surface.are_one(&center(k), &center(j));
        let mut others = 0..rigid.len();
        obstacles.iter().any(|other| own.meets(other))
            || own.meets(&soft)
            || surface.touches_itself && others.any(|j| own.meets(&bodies[j]) && touches(j))
    };
    let near = (0..rigid.len()).filter(|k| meets(*k));
    near.flat_map(|k| rigid[k].points()).collect()
}
