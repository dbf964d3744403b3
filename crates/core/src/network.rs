//! Particles, springs, pins, and only the forces that a scene asked for.

mod tearing;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::colliders::{Capsule, Cuboid, Floor, Sphere};
use crate::constraints::{Constraint, Constraints};
use crate::error::{Error, at_least, positive};
use crate::forces::air::OnTriangles;
use crate::forces::buckling::{self, Buckling, Strip};
use crate::forces::flow::{self, Flow};
use crate::forces::sheet::Of;
use crate::forces::{columns_mut, drag, ending::Ending, gravity, sheet, springs, wind::Wind};
use crate::path::{Path, Place};
use crate::rows::{Part, Registers, Rows, Stage, Sweep};
use crate::sheet::Sheet;
use crate::spring::{Spring, SpringKind, SpringLaw};
use crate::system::{Coupling, Matrix, Mechanics, place_pins};

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
    spheres: Vec<Sphere>,
    boxes: Vec<Cuboid>,
    capsules: Vec<Capsule>,
    floor: Option<Floor>,
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
            spheres: vec![],
            boxes: vec![],
            capsules: vec![],
            floor: None,
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
                "a spring needs two ends, and this has {i} twice"
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

    /// Holds particles by one more constraint, by forces: a state that breaks it is drawn back to it.
    ///
    /// # Errors
    /// There is no such particle, both ends of a rod are the same, or a number makes no sense.
    pub fn add_constraint(&mut self, constraint: Constraint) -> Result<(), Error> {
        let (first, second) = constraint.ends();
        self.check_particle(first)?;
        self.check_particle(second.unwrap_or(first))?;
        self.constraints.add(constraint)
    }

    /// The constraints, their directions of length 1.
    #[must_use]
    pub fn constraints(&self) -> &[Constraint] {
        self.constraints.list()
    }

    /// Whether constraints hold particle i.
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        self.constraints()
            .iter()
            .any(|c| c.ends().0 == i || c.ends().1 == Some(i))
    }

    /// Draws particle i, which constraints hold, to a path, by a spring of that frequency (1/s): they stay as they are, which
    /// a pin would tear.
    pub(crate) fn draw(&mut self, particle: usize, path: Path, frequency: f64) {
        self.hand = Some(Hand {
            particle,
            path,
            frequency,
        });
    }

    /// Ends that.
    pub(crate) fn let_go(&mut self) {
        self.hand = None;
    }

    /// The rods attached to particle i: the other end and the length (m) of each.
    pub fn rods_of(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        self.constraints().iter().filter_map(move |c| match *c {
            Constraint::Rod { i: a, j: b, length } if a == i || b == i => Some((a + b - i, length)),
            _ => None,
        })
    }

    /// How far the positions x are from what the constraints ask for: the largest |C| (m). `None` without constraints.
    #[must_use]
    pub fn constraint_error(&self, x: &[f64]) -> Option<f64> {
        self.constraints.error(x)
    }

    /// Takes errors of the constraints back like a critically damped spring of this natural frequency w (1/s), C'' = -w2 C -
    /// 2 w C'. It is 10 unless set: gone within a second, and slow for any step that shows motion at all. Explicit
    /// methods need steps well below 1 / w.
    ///
    /// # Errors
    /// w is not a finite number above 0.
    pub fn set_feedback(&mut self, w: f64) -> Result<(), Error> {
        self.constraints.set_feedback(w)
    }

    /// Puts a sphere in the way.
    pub fn add_sphere(&mut self, sphere: Sphere) {
        self.spheres.push(sphere);
    }

    /// The spheres in the way.
    #[must_use]
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// Whether pins or obstacles are on their way, now or at some time.
    #[must_use]
    pub fn moves_by_itself(&self) -> bool {
        let pins = self.pins.iter().map(|pin| pin.path);
        let spheres = self.spheres.iter().map(|sphere| sphere.path);
        let boxes = self.boxes.iter().map(|cuboid| cuboid.path);
        let capsules = self.capsules.iter().map(|capsule| capsule.path);
        let mut paths = pins.chain(spheres).chain(boxes).chain(capsules);
        paths.any(|path| !matches!(path, Path::Still(_)))
    }

    /// Leads sphere k along `path` from now on.
    ///
    /// # Errors
    /// There is no such sphere.
    pub fn lead_sphere(&mut self, k: usize, path: Path) -> Result<(), Error> {
        self.check_sphere(k)?;
        self.spheres[k].path = path;
        Ok(())
    }

    /// Makes sphere k as large as that (m).
    ///
    /// # Errors
    /// There is no such sphere, or the radius is not a finite number above 0.
    pub fn resize_sphere(&mut self, k: usize, radius: f64) -> Result<(), Error> {
        self.check_sphere(k)?;
        positive("a sphere's radius", radius)?;
        self.spheres[k].radius = radius;
        Ok(())
    }

    /// # Errors
    /// There is no sphere k.
    pub fn check_sphere(&self, k: usize) -> Result<(), Error> {
        match self.spheres.len() {
            count if k < count => Ok(()),
            0 => Err(Error::Invalid("there is no sphere here".into())),
            count => Err(Error::Invalid(format!(
                "there is no sphere {k}: they are numbered 0 to {}",
                count - 1
            ))),
        }
    }

    /// Puts a box in the way.
    pub fn add_box(&mut self, cuboid: Cuboid) {
        self.boxes.push(cuboid);
    }

    /// The boxes in the way.
    #[must_use]
    pub fn boxes(&self) -> &[Cuboid] {
        &self.boxes
    }

    /// Puts a capsule in the way.
    pub fn add_capsule(&mut self, capsule: Capsule) {
        self.capsules.push(capsule);
    }

    /// The capsules in the way.
    #[must_use]
    pub fn capsules(&self) -> &[Capsule] {
        &self.capsules
    }

    /// Lays a floor.
    pub fn set_floor(&mut self, floor: Floor) {
        self.floor = Some(floor);
    }

    /// Takes the floor away, if there is one.
    pub fn remove_floor(&mut self) {
        self.floor = None;
    }

    /// The floor, if there is one.
    #[must_use]
    pub fn floor(&self) -> Option<Floor> {
        self.floor
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
                "springs of {others} particles are none for {n}"
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
        [
            (self.laws().next().is_some(), "springs"),
            (!self.strips.is_empty(), "buckling"),
            (self.springs_damped(), "spring damping"),
            (self.gravity.is_some(), "gravity"),
            (self.drag.is_some(), "drag"),
            (self.wind.is_some(), "wind"),
            (self.is_constrained(), "constraints"),
            (!self.spheres.is_empty(), "sphere"),
            (!self.boxes.is_empty(), "box"),
            (!self.capsules.is_empty(), "capsule"),
            (self.floor.is_some(), "floor"),
            (self.tear.is_some(), "tearing"),
        ]
        .into_iter()
        .filter_map(|(used, name)| used.then_some(name))
        .collect()
    }

    fn is_constrained(&self) -> bool {
        !self.constraints.list().is_empty()
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

    /// What the ending makes of the springs' forces.
    fn evaluate(&self, x: &[f64], v: &[f64], f: &mut [f64], ending: &Ending) {
        if let Some(sheet) = self.only_sheet().filter(|_| ending.air.is_none()) {
            sheet::set(Of::Forces, sheet, x, v, f, ending);
            return;
        }
        let n = self.particles();
        match &self.sheet {
            Some(sheet) => {
                for column in f.chunks_exact_mut(n) {
                    column[sheet.grid().particles()..].fill(0.0);
                }
                sheet::set(Of::Forces, sheet, x, v, f, &Ending::default());
            }
            None => f.fill(0.0),
        }
        springs::add_list(&self.list, x, v, f);
        springs::add_list(&self.strips, x, v, f);
        ending.apply(x, v, f);
    }

    /// The sheet, if it is all that holds the particles together.
    fn only_sheet(&self) -> Option<&Sheet> {
        self.sheet
            .as_ref()
            .filter(|sheet| sheet.grid().particles() == self.particles())
            .filter(|_| self.list.is_empty() && self.strips.is_empty())
    }

    /// The drag and the gravity that a drift carries: with constraints none, which hold against all forces together.
    fn drifting(&self, part: Part) -> (f64, Vector3<f64>) {
        match part {
            Part::Kick if !self.is_constrained() => (
                self.drag.unwrap_or_default(),
                self.gravity.unwrap_or_default(),
            ),
            _ => (0.0, Vector3::zeros()),
        }
    }

    /// Moves particles by what a drift carries. Where pins go is set right afterwards.
    fn flow(
        &self,
        part: Part,
        h: f64,
        particles: Range<usize>,
        x: [&mut [f64]; 3],
        v: [&mut [f64]; 3],
    ) {
        let (c, g) = self.drifting(part);
        match self.same {
            Some(w) => Flow::new(c, g, w, h).apply(x, v),
            None => flow::apply(c, g, &self.inverse_masses[particles], h, x, v),
        }
    }

    /// Pins of a row are where they are, whatever moved them in between.
    fn place_row(&self, t: f64, row: usize, registers: &mut Registers) {
        let cols = Rows::cols(self);
        for pin in self.pins_of(row * cols..(row + 1) * cols) {
            let place = pin.path.at(t);
            for axis in 0..3 {
                let i = pin.particle - row * cols;
                registers.stage.column_mut(row, axis)[i] = place.position[axis];
                registers.stage.column_mut(row, 3 + axis)[i] = place.velocity[axis];
            }
        }
    }

    /// What is added to the springs' forces at time t: of all forces, or of those that kick.
    fn others(&self, part: Part, t: f64) -> Ending<'_> {
        let all = part != Part::Kick || self.is_constrained();
        Ending {
            wind: self.push().map(|wind| (wind, t)),
            air: self.air(t),
            gravity: self.gravity.filter(|_| all).map(|g| (g, &*self.masses)),
            drag: self.drag.filter(|_| all),
            inertia: None,
            inverse_masses: None,
        }
    }

    /// Adds the forces of the constraints, if there are any, to all others: among them that of a hand.
    fn hold(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        if self.is_constrained() {
            if let Some(hand) = &self.hand {
                let (n, place, w) = (self.particles(), hand.path.at(t), hand.frequency);
                for axis in 0..3 {
                    let k = axis * n + hand.particle;
                    let pull = w * w * (x[k] - place.position[axis])
                        + 2.0 * w * (v[k] - place.velocity[axis]);
                    f[k] -= self.masses[hand.particle] * pull;
                }
            }
            let pin = |i: usize| {
                let pin = self.pins_of(i..i + 1).first();
                pin.map_or_else(Vector3::zeros, |pin| pin.path.at(t).acceleration)
            };
            self.constraints
                .add_forces(&self.inverse_masses, pin, [x, v], f);
        }
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

impl Mechanics for Network {
    fn inverse_masses(&self) -> &[f64] {
        &self.inverse_masses
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(x, v, f, &self.others(Part::All, t));
        self.hold(t, x, v, f);
    }

    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        if self.is_constrained() {
            self.forces(t, x, v, a);
            self.divide_by_masses(a);
            return;
        }
        let ending = Ending {
            inverse_masses: Some(&self.inverse_masses),
            ..self.others(Part::All, t)
        };
        self.evaluate(x, v, a, &ending);
    }

    fn rows(&self) -> Option<&dyn Rows> {
        // Triangles reach into rows above, which a sweep has left behind; constraints reach anywhere.
        let sweeps =
            self.only_sheet().is_some() && self.air(0.0).is_none() && !self.is_constrained();
        sweeps.then_some(self as &dyn Rows)
    }

    fn feedback(&self) -> Option<f64> {
        self.is_constrained().then(|| self.constraints.feedback())
    }

    fn force_differential(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        // How the turning of damped springs changes their forces, vectors do not know.
        let turns = self.springs_damped() && v.iter().any(|v| *v != 0.0);
        if let Some(sheet) = self.only_sheet().filter(|_| !turns) {
            let of = |stiffness, damping, p: &[f64], out: &mut [f64]| {
                let (of, sheet) = (
                    Of::Tangent { clamped: false },
                    sheet.scaled(stiffness, damping),
                );
                sheet::set(of, &sheet, x, p, out, &Ending::default());
            };
            of(1.0, 0.0, dx, df);
            if sheet.is_damped() && dv.iter().any(|dv| *dv != 0.0) {
                let mut damping = vec![0.0; df.len()];
                of(0.0, 1.0, dv, &mut damping);
                df.iter_mut()
                    .zip(damping)
                    .for_each(|(df, more)| *df += more);
            }
        } else {
            df.fill(0.0);
            self.couplings(x, &mut |coupling| {
                springs::add_differential(&coupling, x, v, dx, dv, df);
            });
        }
        if let Some(c) = self.drag {
            drag::add(c, dv, df);
        }
        if let Some(wind) = self.push() {
            wind.add_differential(t, x, dx, df);
        }
        if let Some(air) = self.air(t) {
            air.add_differential(x, v, dx, dv, df);
        }
    }

    fn couplings(&self, x: &[f64], visit: &mut dyn FnMut(Coupling)) {
        self.springs()
            .for_each(|spring| visit(springs::coupling(&spring, x)));
        self.strips
            .iter()
            .for_each(|strip| visit(springs::coupling(strip, x)));
    }

    fn multiply(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> bool {
        let Some(sheet) = self.only_sheet() else {
            return false;
        };
        let (of, a) = (
            Of::Tangent {
                clamped: matrix.clamped,
            },
            matrix.a,
        );
        let ending = Ending {
            inertia: Some(matrix.masses),
            inverse_masses: Some(matrix.free),
            ..Ending::default()
        };
        sheet::set(of, &sheet.scaled(a * a, a), matrix.x, p, out, &ending);
        true
    }

    fn speed(&self) -> f64 {
        let sheet = self.sheet.iter().flat_map(Sheet::springs).count() as f64;
        let (list, strips) = (self.list.len() as f64, self.strips.len() as f64);
        let all = sheet + list + strips;
        if all > 0.0 {
            all / (sheet / sheet::SPEED + list + strips * buckling::PRICE)
        } else {
            1.0
        }
    }

    fn drag_coefficient(&self) -> f64 {
        self.drag.unwrap_or(0.0)
    }

    fn pins(&self, t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for pin in &self.pins {
            visit(pin.particle, pin.path.at(t));
        }
    }

    /// Springs and wind. Gravity and drag are in the drift, unless there are constraints.
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.evaluate(x, v, f, &self.others(Part::Kick, t));
        self.hold(t, x, v, f);
    }

    fn kick_reads_velocity(&self) -> bool {
        self.air(0.0).is_some() || self.springs_damped() || self.is_constrained()
    }

    /// x' = v, v' = g - (c/m) v, exactly; with constraints v stays.
    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let all = 0..self.particles();
        self.flow(Part::Kick, h, all, columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }

    fn constrain(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        for sphere in &self.spheres {
            sphere.push_out(t, x, v);
        }
        for cuboid in &self.boxes {
            cuboid.push_out(t, x, v);
        }
        for capsule in &self.capsules {
            capsule.push_out(t, x, v);
        }
        if let Some(floor) = self.floor {
            floor.push_out(x, v);
        }
        place_pins(self, t, x, v);
    }
}

impl Rows for Network {
    fn rows(&self) -> usize {
        self.sheet.map_or(0, |sheet| sheet.grid().rows())
    }

    fn cols(&self) -> usize {
        self.sheet.map_or(0, |sheet| sheet.grid().cols())
    }

    fn begin(&self, sweep: &mut Sweep) {
        if let Some(sheet) = &self.sheet {
            sheet::begin(sheet, sweep.laws.column_mut(0, 0));
        }
        sweep.found.clear();
    }

    fn drift(&self, part: Part, t: f64, h: f64, row: usize, registers: &mut Registers) {
        let cols = Rows::cols(self);
        let [x, y, z, u, v, w] = registers.stage.columns_mut(row);
        let particles = row * cols..(row + 1) * cols;
        self.flow(part, h, particles, [x, y, z], [u, v, w]);
        self.place_row(t + h, row, registers);
    }

    fn advance(
        &self,
        number: usize,
        stage: &Stage,
        rows: Range<usize>,
        registers: &mut Registers,
        sweep: &mut Sweep,
    ) {
        let Some(sheet) = &self.sheet else { return };
        let ending = Ending {
            inverse_masses: Some(&self.inverse_masses),
            ..self.others(stage.part, stage.t)
        };
        let flow = self.same.filter(|_| stage.drift != 0.0).map(|w| {
            let (c, g) = self.drifting(stage.part);
            Flow::new(c, g, w, stage.drift)
        });
        for row in rows {
            sheet::Advance {
                sheet,
                ending: &ending,
                flow,
                number,
                stage,
                row,
                registers,
                sweep,
            }
            .run();
            if stage.drift == 0.0 || flow.is_some() {
                self.place_row(stage.until, row, registers);
            } else {
                Rows::drift(self, stage.part, stage.t, stage.drift, row, registers);
            }
        }
    }
}
