//! Surfaces of a network: triangles, obstacles, and their contact properties; and contact as a
//! force: primitives nearer than their thickness repel each other.

use std::sync::OnceLock;

use super::particles::Particles;
use super::tearing::Tears;
use crate::constraints::Constraint;
use crate::contact::{ContactLayer, Obstacle, Shape, Skin, Surface, reaching_on};
use crate::coupling::{Coupling, RankOneCoupling};
use crate::elements::Wind;
use crate::elements::force::{At, Force};
use crate::energy::Energy;
use crate::error::Error;
use crate::geometry::Triangles;
use crate::path::{Path, Turn};
use crate::pin::Pin;
use crate::rigid::Body;

/// Rigid bodies, with the constraints that may join them.
type Jointed<'a> = (&'a [Body], &'a [Constraint]);

/// Largest number of obstacles whose solids are found whenever one is added.
const MAX_EAGER: usize = 32;

/// Contact properties of a network: skins, loose edges, drops, and self-contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// Skin of each particle.
    pub skins: Vec<Skin>,
    /// Edges that are in no triangle, such as those of a rope. An edge with equal ends is a point.
    pub edges: Vec<[u32; 2]>,
    /// Particles of a fluid, which touch soft bodies and obstacles, but neither one another nor
    /// rigid bodies.
    pub drops: Vec<u32>,
    /// Whether surfaces touch one another and themselves, or only obstacles.
    pub bodies: bool,
}

/// Triangles, obstacles, and contact properties, if surfaces can touch.
#[derive(Clone, Debug, Default)]
pub(super) struct Surfaces {
    pub triangles: Triangles,
    touch: Option<Touch>,
    obstacles: Vec<Obstacle>,
    /// The obstacles as single particles meet them, if that differs.
    solids: OnceLock<Option<Vec<Obstacle>>>,
}

impl Surfaces {
    pub fn touch(&self) -> Option<&Touch> {
        self.touch.as_ref()
    }

    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Returns the obstacles as single particles meet them.
    pub fn solids(&self) -> &[Obstacle] {
        let solids = self.solids.get_or_init(|| reaching_on(&self.obstacles));
        solids.as_ref().unwrap_or(&self.obstacles)
    }

    /// Finds the solids again: at once if there are few, because steps should allocate nothing.
    fn renew_solids(&mut self) {
        self.solids.take();
        if self.obstacles.len() <= MAX_EAGER {
            self.solids();
        }
    }

    pub fn set_touch(&mut self, touch: Option<Touch>, particles: &Particles) -> Result<(), Error> {
        if let Some(touch) = &touch {
            if touch.skins.len() != particles.len() {
                return Err(Error::Dimension {
                    expected: particles.len(),
                    found: touch.skins.len(),
                });
            }
            touch.skins.iter().try_for_each(Skin::check)?;
            for i in touch.edges.iter().flatten().chain(&touch.drops) {
                particles.check(*i as usize)?;
            }
        }
        self.touch = touch;
        Ok(())
    }

    pub fn add_obstacle(&mut self, obstacle: Obstacle) -> Result<(), Error> {
        obstacle.check()?;
        self.obstacles.push(obstacle);
        self.renew_solids();
        Ok(())
    }

    pub fn remove_obstacle(&mut self, k: usize) -> Result<Obstacle, Error> {
        self.check_obstacle(k)?;
        let removed = self.obstacles.remove(k);
        self.renew_solids();
        Ok(removed)
    }

    pub fn lead_obstacle(&mut self, k: usize, path: Path) -> Result<&Obstacle, Error> {
        self.check_obstacle(k)?;
        self.obstacles[k].path = path;
        self.renew_solids();
        Ok(&self.obstacles[k])
    }

    pub fn reshape_obstacle(&mut self, k: usize, shape: Shape) -> Result<(), Error> {
        self.check_obstacle(k)?;
        shape.check()?;
        self.obstacles[k].shape = shape;
        self.renew_solids();
        Ok(())
    }

    /// Checks that obstacle k exists.
    pub fn check_obstacle(&self, k: usize) -> Result<(), Error> {
        match self.obstacles.len() {
            count if k < count => Ok(()),
            0 => Err(Error::Invalid("there is no obstacle here".into())),
            count => Err(Error::Invalid(format!(
                "there is no obstacle {k}: they are numbered 0 to {}",
                count - 1
            ))),
        }
    }

    /// Removes triangles of which a side has broken.
    pub fn leave_out_holes(&mut self, tears: &Tears) {
        let whole = |corners: &&[u32; 3]| tears.is_whole(corners.map(|i| i as usize));
        self.triangles = self.triangles.iter().filter(whole).copied().collect();
    }

    /// Creates the contact of these surfaces and bodies, if they can touch. Particles that have
    /// left a fluid, in order, touch nothing.
    pub fn layer(&self, bodies: Jointed, tears: &Tears, drained: &[u32]) -> Option<ContactLayer> {
        self.touch.as_ref().map(|touch| {
            let is_whole = |[a, b]: &[u32; 2]| !tears.is_torn(*a as usize, *b as usize);
            let edges: Vec<_> = touch.edges.iter().copied().filter(is_whole).collect();
            let drops = touch.drops.iter();
            let drops = drops.filter(|i| drained.binary_search(i).is_err());
            let drops: Vec<_> = drops.map(|i| [*i; 2]).collect();
            self.contact((&touch.skins, touch.bodies), [&edges, &drops], bodies)
        })
    }

    /// Creates the contact of all surfaces of n particles and of bodies, also if contact is off.
    pub fn layer_of_all(&self, bodies: Jointed, n: usize) -> ContactLayer {
        self.contact((&vec![Skin::default(); n], true), [&[]; 2], bodies)
    }

    fn contact(
        &self,
        (skins, touches_itself): (&[Skin], bool),
        [edges, drops]: [&[[u32; 2]]; 2],
        (bodies, constraints): Jointed,
    ) -> ContactLayer {
        let obstacles = &self.obstacles;
        let surface =
            Surface::new(skins, &self.triangles, edges, bodies, obstacles, touches_itself);
        let joined = constraints.iter().filter_map(|constraint| match constraint {
            Constraint::Joint(joint) => joint.second.map(|second| [joint.first, second]),
            _ => None,
        });
        let surface = surface.with_joined(joined).with_drops(drops);
        ContactLayer::new(surface, obstacles.clone())
    }
}

/// Motion that a scene prescribes: that of pins, obstacles and wind.
pub(super) struct Prescribed<'a> {
    pub particles: &'a Particles,
    pub obstacles: &'a [Obstacle],
    pub wind: Option<&'a Wind>,
}

impl Prescribed<'_> {
    fn paths(&self) -> impl Iterator<Item = &Path> {
        let obstacles = self.obstacles.iter().map(|obstacle| &obstacle.path);
        let pins = self.particles.pins().iter().map(|pin| &pin.path);
        pins.chain(obstacles)
    }

    fn turns(&self) -> impl Iterator<Item = Turn> {
        self.obstacles.iter().filter_map(|obstacle| obstacle.turn)
    }

    /// Returns whether pins or obstacles move at any time, or pins let go.
    pub fn moves(&self) -> bool {
        let moves = |path: &Path| !matches!(path, Path::Still(_));
        let lets_go = self.particles.next_release().is_finite();
        lets_go
            || !self.particles.released().is_empty()
            || self.paths().any(moves)
            || self.turns().next().is_some()
    }

    /// Returns the first time after t (s) at which a path or a turn begins or ends, or a pin lets
    /// go; infinite if there is none.
    pub fn next_known_time(&self, t: f64) -> f64 {
        let of_pins = self.particles.pins().iter().flat_map(Pin::known_times);
        let of_obstacles = self.obstacles.iter().flat_map(Obstacle::known_times);
        let of_wind = self.wind.into_iter().flat_map(Wind::known_times);
        let all = of_pins.chain(of_obstacles).chain(of_wind);
        all.filter(|time| *time > t).fold(f64::INFINITY, f64::min)
    }

    /// Returns a quarter of the shortest period from time t (s) to `end` (s).
    pub fn quarter_period(&self, t: f64, end: f64) -> f64 {
        let times = [t, end];
        let of_paths = self.paths().map(|path| path.quarter_period(times));
        let of_turns = self.turns().filter(|turn| turn.is_on(times));
        let of_turns = of_turns.map(|turn| 0.5 * std::f64::consts::PI / turn.rate.abs());
        let of_wind = self.wind.map(|wind| wind.quarter_period(times));
        let all = of_paths.chain(of_turns).chain(of_wind);
        all.fold(f64::INFINITY, f64::min)
    }
}

impl Force for ContactLayer {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        self.add_repulsion(at.t, at.x, at.v, f);
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        self.add_repulsion_differential(at.t, [at.x, at.v], d, df);
    }

    /// Visits couplings along the normals alone: the part from the rotation of a normal is left
    /// out, as if clamped. Points of obstacles are places.
    fn couplings(&self, t: f64, x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        let n = x.len() / 3;
        self.stiffnesses(t, x, |points, pair| {
            let (mut ends, mut weights) = (points.map(|i| i as usize), pair.weights);
            let particle = ends.into_iter().fold(usize::MAX, usize::min);
            for (end, weight) in ends.iter_mut().zip(&mut weights) {
                if *end >= n {
                    (*end, *weight) = (particle, 0.0);
                }
            }
            visit(Coupling::RankOne(RankOneCoupling {
                ends,
                weights,
                direction: pair.normal.into(),
                stiffness: pair.stiffness,
                damping: pair.damping,
            }));
        });
    }

    fn energy(&self, at: &At) -> Energy {
        Energy { contact: self.repulsion_energy(at.t, at.x, at.v), ..Energy::default() }
    }

    fn reads_velocity(&self) -> bool {
        self.is_damped()
    }
}
