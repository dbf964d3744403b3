//! Hand that pulls particles and obstacles: plans their paths from the state that is shown.

use nalgebra::Vector3;

use super::pins::{Grabbed, PULL_TIME};
use super::state::RunState;
use crate::columns::row;
use crate::contact::Shape;
use crate::error::Error;
use crate::network::{Network, ropes_of};
use crate::path::Path;
use crate::scene::{Model, Scene};

/// Largest speed of a hand, in radii of the scene per second.
const PULL_SPEED: f64 = 10.0;

/// Largest distance from which a spring attracts a particle under constraints, in radii of the
/// scene.
const HELD_REACH: f64 = 0.05;

/// Largest distance from which a spring attracts any other particle, in radii of the scene.
const FREE_REACH: f64 = 0.5;

/// Share of the particle's distance from its target by which each pull moves the hand further: so
/// the particle gets there under any load.
const FOLLOWED_SHARE: f64 = 0.25;

/// Share of its lead over the particle that a hand keeps in each pull while a spring is too long.
const EASED_SHARE: f64 = 0.8;

/// Least and greatest distance to which a hand may bring the ends of a rod, in lengths of the rod,
/// before the other end has followed.
const ROD_LENGTHS: (f64, f64) = (0.95, 1.05);

/// Hand, and the state that it acts on.
pub(super) struct Hand<'a> {
    network: &'a Network,
    /// State that is shown.
    y: &'a [f64],
    /// Time that is shown (s).
    time: f64,
    /// Radius of the scene (m).
    radius: f64,
    /// Largest length to which it stretches springs, in rest lengths.
    reach: f64,
}

impl<'a> Hand<'a> {
    /// Returns the hand on a run with masses; `None` without masses. `radius` is that of the scene
    /// (m).
    pub fn of(scene: &Scene, model: &'a Model, state: &'a RunState, radius: f64) -> Option<Self> {
        model.network().map(|network| Self {
            network,
            y: &state.y,
            time: state.time(),
            radius,
            reach: scene.reach,
        })
    }

    /// Takes hold of particle i where it is.
    ///
    /// # Errors
    /// There is no such particle.
    pub fn grab(&self, i: usize) -> Result<Grabbed, Error> {
        self.network.check_particle(i)?;
        Ok(Grabbed {
            particle: i,
            was_pinned: self.network.is_pinned(i),
            path: Path::Still(self.position(i)),
        })
    }

    /// Pulls a particle towards `target` (m), as far as springs, rods, ropes and its own
    /// speed allow.
    pub fn pull(&self, grabbed: Grabbed, target: Vector3<f64>) -> Grabbed {
        let i = grabbed.particle;
        let from = self.position(i);
        let within =
            |share: f64, ahead: Vector3<f64>| from + ahead.cap_magnitude(share * self.radius);
        let path = match grabbed.is_attracted(self.network) {
            true if self.network.is_held(i) => self.way(from, within(HELD_REACH, target - from)),
            // The hand moves on from where it was, until the particle is at the target, or where
            // its springs are as long as they may be.
            true => {
                let hand = grabbed.path.at(self.time).position;
                let goal = self.within_reach(i, from, target);
                let ahead = if goal == from {
                    (hand - from) * EASED_SHARE
                } else {
                    hand - from + (goal - from) * FOLLOWED_SHARE
                };
                self.way(hand, within(FREE_REACH, ahead))
            }
            false => self.way(from, self.within_reach(i, from, target)),
        };
        Grabbed { path, ..grabbed }
    }

    /// Checks that obstacle k can be grabbed.
    ///
    /// # Errors
    /// There is no such obstacle, or it is a floor.
    pub fn check_obstacle(&self, k: usize) -> Result<(), Error> {
        self.network.check_obstacle(k)?;
        if self.network.obstacles()[k].shape == Shape::Floor {
            return Err(Error::Invalid("a floor cannot be pushed".into()));
        }
        Ok(())
    }

    /// Returns the path of obstacle k from its place now to a target (m); without a target, it
    /// stays. `None` if there is no such obstacle.
    pub fn push(&self, k: usize, target: Option<Vector3<f64>>) -> Option<Path> {
        let from = self.network.obstacles().get(k)?.path.at(self.time).position;
        Some(target.map_or(Path::Still(from), |target| self.way(from, target)))
    }

    fn position(&self, i: usize) -> Vector3<f64> {
        row(self.y, self.network.particles(), i)
    }

    /// Returns the path of a hand that starts to move now.
    fn way(&self, from: Vector3<f64>, to: Vector3<f64>) -> Path {
        let start = self.time;
        let time = PULL_TIME.max((to - from).norm() / (PULL_SPEED * self.radius));
        Path::Line { from, to, start, end: start + time }
    }

    /// Returns the farthest point towards `target` at which no spring of particle i and no edge of
    /// its tetrahedra is too long, no rod too long or too short, and no rope too long. One that
    /// already is may not become worse.
    fn within_reach(&self, i: usize, from: Vector3<f64>, target: Vector3<f64>) -> Vector3<f64> {
        let way = target - from;
        let springs = self.network.springs_of(i);
        let springs = springs.map(|s| (s.i + s.j - i, s.law.rest_length));
        let springs = springs
            .chain(self.network.neighbours_in_solids(i))
            .map(|(other, rest)| (other, 0.0, self.reach * rest));
        let rods = self.network.rods_of(i);
        let rods =
            rods.map(|(other, length)| (other, ROD_LENGTHS.0 * length, ROD_LENGTHS.1 * length));
        let ropes = ropes_of(self.network, i).map(|(other, length)| (other, 0.0, length));
        let share = springs
            .chain(rods)
            .chain(ropes)
            .map(|(other, shortest, longest)| {
                share(from - self.position(other), way, shortest, longest)
            })
            .fold(1.0, f64::min);
        from + share * way
    }
}

/// Returns the share, at most 1, of `way` (m) after which a particle at d (m) from the other end of
/// a spring or rod would come nearer than `shortest` or farther than `longest` (m).
fn share(d: Vector3<f64>, way: Vector3<f64>, shortest: f64, longest: f64) -> f64 {
    let (a, b, distance) = (way.norm_squared(), d.dot(&way), d.norm());
    if a == 0.0 {
        return 1.0;
    }
    // Where it crosses a limit: the roots u of |d + u way| = limit are (-b -+ root) / a.
    let squared = |limit: f64| b * b - a * (d.norm_squared() - limit * limit);
    let leaves = (-b + squared(longest.max(distance)).max(0.0).sqrt()) / a;
    let enters = squared(shortest.min(distance));
    if shortest > 0.0 && b < 0.0 && enters >= 0.0 {
        leaves.min(((-b - enters.sqrt()) / a).max(0.0))
    } else {
        leaves
    }
}
