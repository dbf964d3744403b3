//! Particles, pins, constraints, and only those forces that a scene asks for.

mod bodies;
mod compliant;
mod constrained;
mod crossed;
mod energies;
mod fluid;
mod layer;
mod matrix;
mod mechanics;
mod obstacles;
mod price;
mod scratch;
mod springs;
mod strain;
mod tearing;

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::constraints::Constraints;
use crate::contact::{Obstacle, StrainLimit};
use crate::elements::force::check_particle;
use crate::elements::{Airflow, Drag, Element, Gravity, Sheet, Wind};
use crate::error::{Error, at_least, positive};
use crate::path::Path;
use crate::rigid::Body;

pub use layer::Touch;

/// A particle led along a path.
#[derive(Clone, Debug, PartialEq)]
struct Pin {
    particle: usize,
    path: Path,
}

/// Particles, and the elements and constraints that act on them. What is not asked for costs
/// nothing.
#[derive(Clone, Debug)]
pub struct Network {
    masses: Vec<f64>,
    /// One over the mass of each particle (1/kg), if all masses are the same.
    uniform_inverse_mass: Option<f64>,
    /// One over the mass of each particle (1/kg), 0 where it is pinned.
    inverse_masses: Vec<f64>,
    /// Pins in the order of their particles.
    pins: Vec<Pin>,
    constraints: Constraints,
    /// Elements in the order of their kinds, and those of one kind as they were added.
    elements: Vec<Element>,
    /// The particles that are in no sheet.
    single: Vec<Range<usize>>,
    triangles: Arc<[[u32; 3]]>,
    /// The length over rest length at which springs break.
    tear: Option<f64>,
    /// Pairs of particles between which springs have broken, in order.
    torn: Vec<[usize; 2]>,
    /// Particles among which springs are limited, and the limits of length over rest length.
    strain_limits: Vec<(Range<usize>, f64)>,
    /// The springs that are limited, unless springs or pins have changed since they were listed.
    strained: Option<StrainLimit>,
    obstacles: Vec<Obstacle>,
    /// What can touch, if surfaces do.
    touch: Option<Touch>,
    /// Rigid bodies, and scratch for their evaluations.
    bodies: Vec<Body>,
    scratch: scratch::Scratch,
}

impl Network {
    /// Free particles of these masses (kg), without any force.
    ///
    /// # Errors
    /// There is no particle, or a mass is not a finite number above 0.
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
            uniform_inverse_mass: masses
                .iter()
                .all(|&m| m == masses[0])
                .then(|| 1.0 / masses[0]),
            pins: vec![],
            constraints: Constraints::default(),
            elements: vec![],
            single: std::iter::once(0..masses.len()).collect(),
            triangles: Arc::default(),
            tear: None,
            torn: vec![],
            strain_limits: vec![],
            strained: None,
            masses,
            obstacles: vec![],
            touch: None,
            bodies: vec![],
            scratch: scratch::Scratch::default(),
        })
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.masses.len()
    }

    /// Mass of each particle (kg), of pinned ones too; 0 for a point of a rigid body.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// `Ok` if particle i exists.
    ///
    /// # Errors
    /// There is no particle i.
    pub fn check_particle(&self, i: usize) -> Result<(), Error> {
        check_particle(i, self.particles())
    }

    /// Adds an element, after those of its kind.
    ///
    /// # Errors
    /// A particle that it names does not exist, or a particle would be in two sheets.
    pub fn add(&mut self, element: impl Into<Element>) -> Result<(), Error> {
        let element = element.into();
        element.force().check(self.particles())?;
        if let Element::Sheet(sheet) = &element {
            let new = sheet.particles();
            let overlaps = |old: Range<usize>| old.start < new.end && new.start < old.end;
            if self.sheets().any(|sheet| overlaps(sheet.particles())) {
                return Err(Error::Invalid(format!(
                    "particles {} to {} cannot all be in a new sheet: some are in one already",
                    new.start,
                    new.end - 1
                )));
            }
        }
        self.insert(element);
        Ok(())
    }

    fn insert(&mut self, element: Element) {
        self.strained = None;
        let rank = element.rank();
        let place = self.elements.partition_point(|e| e.rank() <= rank);
        self.elements.insert(place, element);
        let mut sheets: Vec<_> = self.sheets().map(Sheet::particles).collect();
        sheets.sort_by_key(|particles| particles.start);
        let ends = sheets.iter().map(|particles| particles.end);
        let starts = sheets.iter().map(|particles| particles.start);
        let (from, to) = (
            std::iter::once(0).chain(ends),
            starts.chain([self.particles()]),
        );
        let between = from.zip(to).map(|(from, to)| from..to);
        self.single = between.filter(|particles| !particles.is_empty()).collect();
    }

    /// The elements, in the order of their kinds.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The sheets.
    pub fn sheets(&self) -> impl Iterator<Item = &Sheet> {
        self.elements.iter().filter_map(Element::sheet)
    }

    /// Leads particle i along `path` from now on, whether it was pinned before or not.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it.
    pub fn pin(&mut self, i: usize, path: Path) -> Result<(), Error> {
        self.check_particle(i)?;
        self.check_led(i)?;
        match self.pins.binary_search_by_key(&i, |pin| pin.particle) {
            Ok(k) => self.pins[k].path = path,
            Err(k) => {
                self.pins.insert(k, Pin { particle: i, path });
                self.strained = None;
            }
        }
        self.inverse_masses[i] = 0.0;
        Ok(())
    }

    /// Leads particles along paths, as [`pin`](Self::pin) does one: the last path of each counts.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it; none is pinned then.
    pub fn pin_all(&mut self, pins: Vec<(usize, Path)>) -> Result<(), Error> {
        for (i, _) in &pins {
            self.check_particle(*i)?;
            self.check_led(*i)?;
        }
        for &(i, _) in &pins {
            self.inverse_masses[i] = 0.0;
        }
        let pins = pins
            .into_iter()
            .map(|(particle, path)| Pin { particle, path });
        self.pins.extend(pins);
        self.pins.sort_by_key(|pin| pin.particle);
        self.pins.dedup_by(|later, first| {
            let same = later.particle == first.particle;
            if same {
                first.path = later.path;
            }
            same
        });
        self.strained = None;
        Ok(())
    }

    /// Lets particle i go. Does nothing if it is free.
    pub fn unpin(&mut self, i: usize) {
        if let Ok(k) = self.pins.binary_search_by_key(&i, |pin| pin.particle) {
            self.pins.remove(k);
            self.strained = None;
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
        self.inverse_masses[i] == 0.0 && !self.is_carried(i)
    }

    /// Takes the place of all elements of a kind.
    fn replace(&mut self, is: impl Fn(&Element) -> bool, by: Option<Element>) {
        self.elements.retain(|element| !is(element));
        if let Some(element) = by {
            self.insert(element);
        }
    }

    /// Sets gravity g (m/s2); zero means none.
    pub fn set_gravity(&mut self, g: Vector3<f64>) {
        let gravity = (g != Vector3::zeros()).then_some(Gravity(g).into());
        self.replace(|element| matches!(element, Element::Gravity(_)), gravity);
    }

    /// Gravity g (m/s2), if there is any.
    #[must_use]
    pub fn gravity(&self) -> Option<Vector3<f64>> {
        self.elements.iter().find_map(|element| match element {
            Element::Gravity(Gravity(g)) => Some(*g),
            _ => None,
        })
    }

    /// Sets the coefficient c (kg/s) of viscous drag -c v on each particle; zero means none.
    ///
    /// # Errors
    /// c is negative or not finite.
    pub fn set_drag(&mut self, c: f64) -> Result<(), Error> {
        at_least(0.0, "the drag", c)?;
        let drag = (c > 0.0).then_some(Drag(c).into());
        self.replace(|element| matches!(element, Element::Drag(_)), drag);
        Ok(())
    }

    /// Coefficient c (kg/s) of viscous drag, if there is any.
    #[must_use]
    pub fn drag(&self) -> Option<f64> {
        self.elements.iter().find_map(|element| match element {
            Element::Drag(Drag(c)) => Some(*c),
            _ => None,
        })
    }

    /// Lets wind blow on particles or on triangles, or calms it.
    pub fn set_wind(&mut self, wind: Option<Wind>) {
        let element = wind.map(|wind| match wind.air() {
            Some(air) => Airflow { wind, air }.into(),
            None => wind.into(),
        });
        let is = |element: &Element| matches!(element, Element::Wind(_) | Element::Airflow(_));
        self.replace(is, element);
    }

    /// The wind, if it blows.
    #[must_use]
    pub fn wind(&self) -> Option<&Wind> {
        self.elements.iter().find_map(|element| match element {
            Element::Wind(wind) | Element::Airflow(Airflow { wind, .. }) => Some(wind),
            _ => None,
        })
    }

    /// Spans triangles between particles, for [wind](Wind::on_triangles) to blow on, in place of
    /// earlier ones.
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
        self.renew_contact();
        Ok(())
    }

    /// The triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Names of the forces and obstacles this network pays for.
    #[must_use]
    pub fn forces_in_use(&self) -> Vec<&'static str> {
        let mut names = vec![];
        let mut list = |used: bool, name| {
            if used && !names.contains(&name) {
                names.push(name);
            }
        };
        let (elastic, others): (Vec<_>, Vec<_>) = self
            .elements
            .iter()
            .partition(|element| element.is_elastic());
        for element in &elastic {
            list(!element.is_empty(), element.force().name());
        }
        for element in elastic {
            let damping = element.solid().map_or("spring damping", |_| "viscosity");
            list(element.force().reads_velocity(), damping);
        }
        for element in others {
            list(true, element.force().name());
        }
        list(self.is_constrained(), "constraints");
        for name in ["sphere", "box", "capsule", "floor"] {
            let mut obstacles = self.obstacles.iter();
            list(
                obstacles.any(|obstacle| obstacle.shape.name() == name),
                name,
            );
        }
        list(self.tear.is_some(), "tearing");
        list(!self.strain_limits.is_empty(), "strain limit");
        names
    }
}
