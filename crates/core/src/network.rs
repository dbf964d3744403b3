//! Particles, springs, pins, and only the forces that a scene asked for.

mod held;
mod mechanics;
mod obstacles;
mod tearing;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::constraints::Constraints;
use crate::contact::Obstacle;
use crate::elements::Sheet;
use crate::elements::air::OnTriangles;
use crate::elements::buckling::{Buckling, Strip};
use crate::elements::{ending::Ending, gravity, springs, wind::Wind};
use crate::error::{Error, at_least, positive};
use crate::path::Path;
use crate::spring::{Spring, SpringKind, SpringLaw};

/// A particle led along a path.
#[derive(Clone, Debug, PartialEq)]
struct Pin {
    particle: usize,
    path: Path,
}

/// A spring from where a hand is to a free particle, critically damped: -m (w2 (x - p) + 2 w (v - p')).
#[derive(Clone, Debug)]
struct Hand {
    particle: usize,
    path: Path,
    /// w (1/s).
    frequency: f64,
}

/// Energy by kind (J). Gravity's is zero at the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// m v2 / 2
    pub kinetic: f64,
    /// k (L - r)2 / 2, and that of arcs
    pub elastic: f64,
    /// -m g . x
    pub gravitational: f64,
}

impl Energy {
    /// The sum.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gravitational
    }
}

/// Particles and springs. Gravity, drag, wind and obstacles are absent until asked for, and cost nothing then.
#[derive(Clone, Debug)]
pub struct Network {
    masses: Vec<f64>,
    /// One over that of each particle, if they are all the same.
    same: Option<f64>,
    /// 0 where pinned.
    inverse_masses: Vec<f64>,
    sheet: Option<Sheet>,
    list: Vec<Spring>,
    strips: Vec<Strip>,
    /// The length over rest length at which springs break.
    tear: Option<f64>,
    /// The ends of those that have, in order.
    torn: Vec<[usize; 2]>,
    /// In the order of their particles.
    pins: Vec<Pin>,
    gravity: Option<Vector3<f64>>,
    drag: Option<f64>,
    wind: Option<Wind>,
    triangles: Arc<[[u32; 3]]>,
    constraints: Constraints,
    hand: Option<Hand>,
    obstacles: Vec<Obstacle>,
}

impl Network {
    /// Free particles of these masses (kg), and nothing else yet.
    ///
    /// # Errors
    /// There is none, or a mass is not a finite number above 0.
    pub fn new(masses: Vec<f64>) -> Result<Self, Error> {
        if masses.is_empty() {
            return Err(Error::Invalid(
                "a network needs at least one particle".into(),
            ));
        }
        for &m in &masses {
            positive("a particle's mass", m)?;
        }
        Ok(Self {
            inverse_masses: masses.iter().map(|m| 1.0 / m).collect(),
            same: masses
                .iter()
                .all(|&m| m == masses[0])
                .then(|| 1.0 / masses[0]),
            masses,
            sheet: None,
            list: vec![],
            strips: vec![],
            tear: None,
            torn: vec![],
            pins: vec![],
            gravity: None,
            drag: None,
            wind: None,
            triangles: Arc::default(),
            constraints: Constraints::default(),
            hand: None,
            obstacles: vec![],
        })
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.masses.len()
    }

    /// Mass of each particle (kg), of pinned ones too.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// # Errors
    /// There is no particle i.
    pub fn check_particle(&self, i: usize) -> Result<(), Error> {
        let n = self.particles();
        if i < n {
            Ok(())
        } else {
            Err(Error::Invalid(format!(
                "there is no particle {i}: they are numbered 0 to {}",
                n - 1
            )))
        }
    }

    /// Adds one spring.
    ///
    /// # Errors
    /// An end does not exist, or both are the same.
    pub fn add_spring(&mut self, spring: Spring) -> Result<(), Error> {
        self.check_ends(spring.i, spring.j)?;
        self.list.push(spring);
        Ok(())
    }

    fn check_ends(&self, i: usize, j: usize) -> Result<(), Error> {
        self.check_particle(i)?;
        self.check_particle(j)?;
        if i == j {
            return Err(Error::Invalid(format!(
                "a spring needs two different particles, not {i} twice"
            )));
        }
        Ok(())
    }

    /// Adds a bend spring that buckles, in place of one that does not.
    ///
    /// # Errors
    /// An end does not exist, or both are the same; a number is negative or not finite; the rest length or the stiffness
    /// against bending is 0, or the compression stiffness less than 4 pi2 `k_b` / r3.
    pub fn add_buckling(&mut self, buckling: Buckling) -> Result<(), Error> {
        self.check_ends(buckling.i, buckling.j)?;
        self.strips.push(Strip::new(buckling)?);
        Ok(())
    }

    /// The bend springs that buckle.
    pub fn buckling(&self) -> impl Iterator<Item = Buckling> {
        self.strips.iter().map(|strip| strip.of)
    }

    /// Adds springs in whatever order, and keeps all in the order of their ends: neighbours in memory are then used one
    /// after another.
    ///
    /// # Errors
    /// As [`add_spring`](Self::add_spring), for the first that cannot be: none after it is added.
    pub fn add_springs(&mut self, springs: impl IntoIterator<Item = Spring>) -> Result<(), Error> {
        let added = springs
            .into_iter()
            .try_for_each(|spring| self.add_spring(spring));
        self.list
            .sort_by_key(|Spring { i, j, .. }| (*i.min(j), *i.max(j)));
        added
    }

    /// Holds the first particles together as a sheet.
    ///
    /// # Errors
    /// The sheet has more particles than there are.
    pub fn set_sheet(&mut self, sheet: Sheet) -> Result<(), Error> {
        self.check_particle(sheet.grid().particles() - 1)?;
        self.sheet = Some(sheet);
        Ok(())
    }

    /// Leads particle i along `path` from now on, whether it was pinned before or not.
    ///
    /// # Errors
    /// There is no such particle.
    pub fn pin(&mut self, i: usize, path: Path) -> Result<(), Error> {
        self.check_particle(i)?;
        match self.pins.binary_search_by_key(&i, |pin| pin.particle) {
            Ok(k) => self.pins[k].path = path,
            Err(k) => self.pins.insert(k, Pin { particle: i, path }),
        }
        self.inverse_masses[i] = 0.0;
        Ok(())
    }

    /// Lets particle i go. Does nothing if it is free.
    pub fn unpin(&mut self, i: usize) {
        if let Ok(k) = self.pins.binary_search_by_key(&i, |pin| pin.particle) {
            self.pins.remove(k);
            self.inverse_masses[i] = 1.0 / self.masses[i];
        }
    }

    /// Gives every pin the path that `path` makes of its own.
    pub fn lead_pins(&mut self, mut path: impl FnMut(usize, Path) -> Path) {
        for pin in &mut self.pins {
            pin.path = path(pin.particle, pin.path);
        }
    }

    /// The pinned particles and their paths.
    pub fn pins(&self) -> impl Iterator<Item = (usize, Path)> {
        self.pins.iter().map(|pin| (pin.particle, pin.path))
    }

    /// The pins among some particles.
    fn pins_of(&self, particles: Range<usize>) -> &[Pin] {
        let before = |i: usize| self.pins.partition_point(|pin| pin.particle < i);
        &self.pins[before(particles.start)..before(particles.end)]
    }

    /// Whether particle i is pinned.
    #[must_use]
    pub fn is_pinned(&self, i: usize) -> bool {
        self.inverse_masses[i] == 0.0
    }

    /// Asks for gravity g (m/s2).
    pub fn set_gravity(&mut self, g: Vector3<f64>) {
        self.gravity = (g != Vector3::zeros()).then_some(g);
    }

    /// g (m/s2), if asked for.
    #[must_use]
    pub fn gravity(&self) -> Option<Vector3<f64>> {
        self.gravity
    }

    /// Asks for viscous drag -c v, c in kg/s, on each particle.
    ///
    /// # Errors
    /// c is negative or not finite.
    pub fn set_drag(&mut self, c: f64) -> Result<(), Error> {
        at_least(0.0, "the drag", c)?;
        self.drag = (c > 0.0).then_some(c);
        Ok(())
    }

    /// c (kg/s), if asked for.
    #[must_use]
    pub fn drag(&self) -> Option<f64> {
        self.drag
    }

    /// Lets wind blow, or calms it.
    pub fn set_wind(&mut self, wind: Option<Wind>) {
        self.wind = wind;
    }

    /// The wind, if it blows.
    #[must_use]
    pub fn wind(&self) -> Option<&Wind> {
        self.wind.as_ref()
    }

    /// Spans triangles between particles, for [wind](Wind::on_triangles) to blow on, in place of those there were.
    ///
    /// # Errors
    /// A corner does not exist.
    pub fn set_triangles(
        &mut self,
        triangles: impl IntoIterator<Item = [usize; 3]>,
    ) -> Result<(), Error> {
        let checked = triangles.into_iter().map(|corners| {
            corners.iter().try_for_each(|&i| self.check_particle(i))?;
            Ok(corners.map(|i| i as u32))
        });
        self.triangles = checked.collect::<Result<_, Error>>()?;
        Ok(())
    }

    /// The triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The wind at time t, if it blows on triangles.
    fn air(&self, t: f64) -> Option<OnTriangles<'_>> {
        let wind = self.wind.as_ref()?;
        Some(OnTriangles {
            wind,
            air: wind.air()?,
            t,
            triangles: &self.triangles,
        })
    }

    /// The wind, if it pushes particles.
    fn push(&self) -> Option<&Wind> {
        self.wind.as_ref().filter(|wind| wind.air().is_none())
    }

    /// The sheet, if there is one.
    #[must_use]
    pub fn sheet(&self) -> Option<&Sheet> {
        self.sheet.as_ref()
    }

    /// Every spring by itself, those of the sheet first; none that buckles.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.sheet
            .iter()
            .flat_map(Sheet::springs)
            .chain(self.list.iter().copied())
    }

    /// The springs attached to particle i, those that buckle as they are while straight.
    pub fn springs_of(&self, i: usize) -> impl Iterator<Item = Spring> {
        self.springs()
            .chain(self.strips.iter().map(Strip::straight))
            .filter(move |s| s.i == i || s.j == i)
    }

    /// Makes every spring so many times as stiff, and damps it by the root of that more: its damping ratio stays.
    ///
    /// # Errors
    /// The factor is not a finite number above 0.
    pub fn scale_stiffness(&mut self, factor: f64) -> Result<(), Error> {
        self.scale_springs(factor, factor.sqrt())
    }

    /// Makes every spring so many times as stiff, and so many times as damped.
    ///
    /// # Errors
    /// The factor of the stiffness is not a finite number above 0, or that of the damping not one of at least 0.
    pub fn scale_springs(&mut self, stiffness: f64, damping: f64) -> Result<(), Error> {
        positive("the factor of the stiffness", stiffness)?;
        at_least(0.0, "the factor of the damping", damping)?;
        let sheet = self.sheet.iter_mut().flat_map(Sheet::laws_mut);
        let list = self.list.iter_mut().map(|spring| &mut spring.law);
        for law in sheet.chain(list) {
            law.stiffness *= stiffness;
            law.damping *= damping;
        }
        for Strip { of, .. } in &mut self.strips {
            of.bending *= stiffness;
            of.compression *= stiffness;
            of.tension *= stiffness;
            of.damping *= damping;
        }
        Ok(())
    }

    /// Takes over the springs of another network of the same particles. Those that have broken here stay broken.
    ///
    /// # Errors
    /// The other has not as many particles.
    pub fn copy_springs(&mut self, other: &Self) -> Result<(), Error> {
        let (n, others) = (self.particles(), other.particles());
        if n != others {
            return Err(Error::Invalid(format!(
                "the springs of a network of {others} particles do not fit one of {n}"
            )));
        }
        self.sheet = other.sheet;
        self.list.clone_from(&other.list);
        self.strips.clone_from(&other.strips);
        self.leave_out_torn();
        Ok(())
    }

    fn laws(&self) -> impl Iterator<Item = SpringLaw> {
        self.sheet
            .iter()
            .flat_map(|sheet| *sheet.laws())
            .chain(self.list.iter().map(|s| s.law))
    }

    /// Names of the forces and obstacles this network pays for.
    #[must_use]
    pub fn forces_in_use(&self) -> Vec<&'static str> {
        let met = |name: &str| {
            let mut obstacles = self.obstacles.iter();
            obstacles.any(|obstacle| obstacle.shape.name() == name)
        };
        [
            (self.laws().next().is_some(), "springs"),
            (!self.strips.is_empty(), "buckling"),
            (self.springs_damped(), "spring damping"),
            (self.gravity.is_some(), "gravity"),
            (self.drag.is_some(), "drag"),
            (self.wind.is_some(), "wind"),
            (self.is_constrained(), "constraints"),
            (met("sphere"), "sphere"),
            (met("box"), "box"),
            (met("capsule"), "capsule"),
            (met("floor"), "floor"),
            (self.tear.is_some(), "tearing"),
        ]
        .into_iter()
        .filter_map(|(used, name)| used.then_some(name))
        .collect()
    }

    /// Whether any spring is.
    fn springs_damped(&self) -> bool {
        self.laws().any(|law| law.damping > 0.0)
            || self.strips.iter().any(|strip| strip.of.damping > 0.0)
    }

    /// The springs' part of the force (N).
    pub fn spring_forces(&self, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(x, v, f, &Ending::default());
    }

    /// The energy in the state (x, v). Drag, damping and wind have none.
    #[must_use]
    pub fn energy(&self, x: &[f64], v: &[f64]) -> Energy {
        let n = self.particles();
        let kinetic = v
            .chunks_exact(n)
            .map(|v| {
                v.iter()
                    .zip(&self.masses)
                    .map(|(v, m)| 0.5 * m * v * v)
                    .sum::<f64>()
            })
            .sum();
        let straight = self.springs().map(|spring| springs::energy(&spring, x));
        let buckled = self.strips.iter().map(|strip| springs::energy(strip, x));
        let elastic = straight.chain(buckled).sum();
        let gravitational = self
            .gravity
            .map_or(0.0, |g| gravity::energy(g, &self.masses, x));
        Energy {
            kinetic,
            elastic,
            gravitational,
        }
    }

    /// Length over rest length of the structural spring that is stretched most; 1 if there is none.
    #[must_use]
    pub fn largest_stretch(&self, x: &[f64]) -> f64 {
        self.springs()
            .filter(|s| s.kind == SpringKind::Structural && s.law.rest_length > 0.0)
            .map(|s| springs::length(x, &s) / s.law.rest_length)
            .reduce(f64::max)
            .unwrap_or(1.0)
    }
}
