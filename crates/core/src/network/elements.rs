//! Elements of a network: the forces that a scene asks for, in the order of the table.

use std::any::Any;
use std::ops::Range;

use nalgebra::Vector3;

use super::element::Element;
use crate::contact::ContactLayer;
use crate::elements::force::{ASSEMBLY, At, ByParticle, DriftForces, Force, Matter};
use crate::elements::sheet::{Quantity, set};
use crate::elements::{Airflow, Drag, Finish, Fluid, Gravity, Sheet, Solid, Wind};
use crate::error::Error;
use crate::products::ITERATION;

/// Elements in the order of their types, and those of one type in the order in which they were
/// added.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    all: Vec<Element>,
    /// Number of particles.
    particles: usize,
    /// Particles that are in no sheet.
    single: Vec<Range<usize>>,
}

impl Elements {
    /// Creates an empty list of elements, for n particles.
    pub fn new(n: usize) -> Self {
        Self {
            all: vec![],
            particles: n,
            single: std::iter::once(0..n).collect(),
        }
    }

    /// Returns the number of particles.
    pub fn particles(&self) -> usize {
        self.particles
    }

    pub fn all(&self) -> &[Element] {
        &self.all
    }

    pub fn all_mut(&mut self) -> &mut [Element] {
        &mut self.all
    }

    /// Adds an element after those of its type, if its particles exist and are in no other sheet.
    pub fn add(&mut self, element: Element) -> Result<(), Error> {
        element.force().check(self.particles)?;
        if let Some(sheet) = element.get::<Sheet>() {
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

    /// Adds an element after those of its type, without checks.
    pub fn insert(&mut self, element: Element) {
        let rank = element.rank();
        let place = self.all.partition_point(|e| e.rank() <= rank);
        self.all.insert(place, element);
        let mut sheets: Vec<_> = self.sheets().map(Sheet::particles).collect();
        sheets.sort_by_key(|particles| particles.start);
        let ends = sheets.iter().map(|particles| particles.end);
        let starts = sheets.iter().map(|particles| particles.start);
        let (from, to) = (
            std::iter::once(0).chain(ends),
            starts.chain([self.particles]),
        );
        let between = from.zip(to).map(|(from, to)| from..to);
        self.single = between.filter(|particles| !particles.is_empty()).collect();
    }

    /// Removes the elements for which `is` is true, and adds one in their place.
    pub fn replace(&mut self, is: impl Fn(&Element) -> bool, by: Option<Element>) {
        self.all.retain(|element| !is(element));
        if let Some(element) = by {
            self.insert(element);
        }
    }

    /// Removes all elements of type T, and adds one in their place.
    pub fn replace_all<T: Any + Into<Element>>(&mut self, by: Option<T>) {
        let is = |element: &Element| element.get::<T>().is_some();
        self.replace(is, by.map(Into::into));
    }

    /// Sets gravity g (m/s2); zero means none.
    pub fn set_gravity(&mut self, g: Vector3<f64>) {
        self.replace_all((g != Vector3::zeros()).then_some(Gravity(g)));
    }

    /// Sets the coefficient c (kg/s) of viscous drag; zero means none.
    pub fn set_drag(&mut self, c: f64) {
        self.replace_all((c > 0.0).then_some(Drag(c)));
    }

    /// Sets the wind on particles or on triangles, or none.
    pub fn set_wind(&mut self, wind: Option<&Wind>) {
        let element = wind.copied().map(|wind| match wind.air() {
            Some(air) => Airflow { wind, air }.into(),
            None => wind.into(),
        });
        self.replace(|element| element.force().is_wind(), element);
    }

    /// Removes the springs between pairs of particles.
    pub fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        for element in &mut self.all {
            element.force_mut().remove_springs(torn);
        }
        // An empty element would still prevent sweeps.
        let is_left = |e: &Element| e.get::<Sheet>().is_some() || !e.is_elastic() || !e.is_empty();
        self.all.retain(is_left);
    }

    /// Returns the elements of type T.
    pub fn of<T: Any>(&self) -> impl Iterator<Item = &T> + Clone {
        self.all.iter().filter_map(Element::get)
    }

    /// Returns the first element of type T, to be changed.
    pub fn first_mut<T: Any>(&mut self) -> Option<&mut T> {
        self.all.iter_mut().find_map(Element::get_mut)
    }

    pub fn sheets(&self) -> impl Iterator<Item = &Sheet> + Clone {
        self.of()
    }

    pub fn solids(&self) -> impl Iterator<Item = &Solid> {
        self.of()
    }

    pub fn elastic(&self) -> impl Iterator<Item = &Element> + Clone {
        self.all.iter().filter(|element| element.is_elastic())
    }

    pub fn fluid(&self) -> Option<&Fluid> {
        self.of().next()
    }

    pub fn contact_layer(&self) -> Option<&ContactLayer> {
        self.of().next()
    }

    pub fn gravity(&self) -> Option<Vector3<f64>> {
        self.of().next().map(|Gravity(g)| *g)
    }

    pub fn drag(&self) -> Option<f64> {
        self.of().next().map(|Drag(c)| *c)
    }

    pub fn wind(&self) -> Option<&Wind> {
        let on_triangles = self.of::<Airflow>().map(|airflow| &airflow.wind);
        self.of().chain(on_triangles).next()
    }

    /// Returns the names of the forces in use: elastic ones, their damping, and then others.
    pub fn names(&self) -> Vec<&'static str> {
        let mut names = vec![];
        let mut list = |used: bool, name| {
            if used && !names.contains(&name) {
                names.push(name);
            }
        };
        for element in self.elastic() {
            list(!element.is_empty(), element.force().name());
        }
        for element in self.elastic() {
            let force = element.force();
            list(force.reads_velocity(), force.damping_name());
        }
        for element in self.all.iter().filter(|element| !element.is_elastic()) {
            list(true, element.force().name());
        }
        names
    }

    /// Returns the forces that act on each particle by itself.
    pub fn by_particle(&self) -> impl Iterator<Item = &dyn ByParticle> {
        self.all.iter().filter_map(|e| e.force().by_particle())
    }

    /// Returns whether sheets alone couple particles, and all particles are in sheets.
    pub fn are_in_rows(&self) -> bool {
        let in_rows = |element: &Element| {
            let force = element.force();
            element.get::<Sheet>().is_some()
                || force.drift_forces().is_some()
                || force.by_particle().is_some()
        };
        self.single.is_empty() && self.all.iter().all(in_rows)
    }

    /// Returns whether all matter consists of springs of constant stiffness and damping.
    pub fn are_springs(&self) -> bool {
        let is_spring = |e: &Element| match e.force().matter() {
            None | Some(Matter::Springs) => true,
            Some(Matter::Elastic) => e.is_empty(),
            Some(Matter::Fluid) => false,
        };
        self.all.iter().all(is_spring)
    }

    /// Returns the sum of gravity and drag.
    pub fn drift_forces(&self) -> DriftForces {
        let all = self.all.iter().filter_map(|e| e.force().drift_forces());
        all.fold(DriftForces::default(), |a, b| DriftForces {
            gravity: a.gravity + b.gravity,
            drag: a.drag + b.drag,
        })
    }

    /// Sets f to the finished sum of all forces except gravity and drag.
    pub fn evaluate(&self, at: &At, f: &mut [f64], finish: &Finish) {
        let is_other = |e: &&Element| e.force().drift_forces().is_none();
        self.sum(self.all.iter().filter(is_other), at, f, finish);
    }

    /// Sets f to the finished sum of some elements. Those that are no sheets come first, in their
    /// order. Each sheet is added to these, and finishes its own particles, so that their numbers
    /// pass through memory once.
    pub fn sum<'a>(
        &'a self,
        elements: impl Iterator<Item = &'a Element> + Clone,
        at: &At,
        f: &mut [f64],
        finish: &Finish,
    ) {
        let is_other = |element: &&Element| element.get::<Sheet>().is_none();
        let mut others = elements.clone().filter(is_other).peekable();
        let added = others.peek().is_some();
        if added {
            f.fill(0.0);
        } else {
            self.clear_single(f);
        }
        others.for_each(|element| element.force().add_forces(at, f));
        for sheet in elements.filter_map(Element::get::<Sheet>) {
            set(Quantity::Forces, sheet, &[at.x, at.v], f, added, finish);
        }
        self.finish_single(at.v, f, finish);
    }

    /// Sets f to zero on particles that are in no sheet.
    pub fn clear_single(&self, f: &mut [f64]) {
        for column in f.chunks_exact_mut(self.particles) {
            for particles in &self.single {
                column[particles.clone()].fill(0.0);
            }
        }
    }

    /// Finishes f on particles that are in no sheet.
    pub fn finish_single(&self, v: &[f64], f: &mut [f64], finish: &Finish) {
        for particles in &self.single {
            finish.apply(particles, v, f);
        }
    }

    /// Returns the sum of a number over all elements.
    fn sum_of(&self, number: impl Fn(&dyn Force) -> f64) -> f64 {
        self.all.iter().map(|element| number(element.force())).sum()
    }

    /// Returns the time of an evaluation of the forces coupling by coupling, over that of an
    /// evaluation by the elements' own kernels; 1 without couplings.
    pub fn speed(&self) -> f64 {
        let couplings = self.sum_of(|force| force.cost().couplings);
        if couplings > 0.0 {
            couplings / self.sum_of(|force| force.cost().price)
        } else {
            1.0
        }
    }

    /// Returns the price of the assembly of the couplings, in evaluations of the forces.
    pub fn assembly(&self) -> f64 {
        let price = self.sum_of(|force| force.cost().price);
        if price > 0.0 {
            self.sum_of(|force| force.assembly()) / price
        } else {
            ASSEMBLY
        }
    }

    /// Returns the price of an iteration with the damping alone, in evaluations of the forces.
    pub fn iteration(&self) -> f64 {
        let price = self.sum_of(|force| force.cost().price);
        if price > 0.0 {
            self.sum_of(|force| force.iteration() * force.cost().price) / price
        } else {
            ITERATION
        }
    }
}
