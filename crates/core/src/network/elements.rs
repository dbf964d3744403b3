//! Elements of a network: the forces that a scene asks for, each with a line in one table, and
//! their springs.
//!
//! The part of an implicit step's matrix whose couplings are multiplied together is that of
//! springs in sheets, and of single springs if there are many.

use std::any::Any;
use std::ops::Range;

use nalgebra::Vector3;

use crate::contact::ContactLayer;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::force::{
    ASSEMBLY, At, ByParticle, DriftForces, Force, Matter, check_ends, distance, ends,
};
use crate::elements::sheet::{Quantity, set};
use crate::elements::{
    Airflow, Attraction, Buckling, BucklingSprings, Cords, Drag, Finish, Fluid, Gas, Gravity,
    OwnForce, Sheet, Solid, Springs, Wind,
};
use crate::error::Error;
use crate::products::ITERATION;
use crate::spring::{Spring, SpringKind};
use crate::system::divide_by_masses;

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
        Self { all: vec![], particles: n, single: std::iter::once(0..n).collect() }
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
        let (from, to) = (std::iter::once(0).chain(ends), starts.chain([self.particles]));
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
        if couplings > 0.0 { couplings / self.sum_of(|force| force.cost().price) } else { 1.0 }
    }

    /// Returns the price of the assembly of the couplings, in evaluations of the forces.
    pub fn assembly(&self) -> f64 {
        let price = self.sum_of(|force| force.cost().price);
        if price > 0.0 { self.sum_of(|force| force.assembly()) / price } else { ASSEMBLY }
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

macro_rules! elements {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// One of the forces of a network.
        #[derive(Clone, Debug)]
        #[expect(clippy::large_enum_variant, reason = "the large one occurs once in a network")]
        #[non_exhaustive]
        pub enum Element {
            $($(#[$doc])* $name($name),)*
        }

        impl Element {
            /// Returns the force of the element.
            pub(crate) fn force(&self) -> &dyn Force {
                match self {
                    $(Self::$name(element) => element,)*
                }
            }

            /// Returns the force of the element, to be changed.
            pub(crate) fn force_mut(&mut self) -> &mut dyn Force {
                match self {
                    $(Self::$name(element) => element,)*
                }
            }

            /// Returns the force as one of type T, if it is one: a comparison of variants, once
            /// compiled.
            pub(crate) fn get<T: Any>(&self) -> Option<&T> {
                match self {
                    $(Self::$name(element) => (element as &dyn Any).downcast_ref(),)*
                }
            }

            /// Returns the force as one of type T, to be changed, if it is one.
            pub(crate) fn get_mut<T: Any>(&mut self) -> Option<&mut T> {
                match self {
                    $(Self::$name(element) => (element as &mut dyn Any).downcast_mut(),)*
                }
            }

            /// Returns the position of the element's type in the table, which is the order of
            /// summation.
            pub(crate) fn rank(&self) -> u8 {
                enum Rank {
                    $($name,)*
                }
                match self {
                    $(Self::$name(_) => Rank::$name as u8,)*
                }
            }
        }

        $(impl From<$name> for Element {
            fn from(element: $name) -> Self {
                Self::$name(element)
            }
        })*
    };
}

// In the order in which a network sums them.
elements! {
    /// Springs of a grid of particles.
    Sheet,
    /// Single springs.
    Springs,
    /// Bend springs that buckle.
    BucklingSprings,
    /// Springs that only pull.
    Cords,
    /// Fluid of smoothed particles.
    Fluid,
    /// Tetrahedra of an elastic material.
    Solid,
    /// Gas in a closed surface.
    Gas,
    /// Uniform gravity.
    Gravity,
    /// Viscous drag.
    Drag,
    /// Wind that pushes each particle.
    Wind,
    /// Wind that blows on triangles.
    Airflow,
    /// A critically damped spring from a moving point to a particle.
    Attraction,
    /// Repulsion of surfaces that are nearer than their thickness.
    ContactLayer,
    /// A force that is a function.
    OwnForce,
}

impl Element {
    /// Returns whether the force is elastic: springs or a solid.
    pub(crate) fn is_elastic(&self) -> bool {
        matches!(self.force().matter(), Some(Matter::Springs | Matter::Elastic))
    }

    /// Returns whether the element couples no particles.
    pub(crate) fn is_empty(&self) -> bool {
        self.force().cost().couplings == 0.0
    }
}

/// Writes the product of the matrix of these springs with p to out. Returns their number.
pub(super) fn multiply(elements: &Elements, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
    let in_sheets: usize = elements.sheets().map(Sheet::len).sum();
    let clamped = matrix.clamped;
    let finish = Finish {
        inertia: Some(matrix.masses),
        inverse_masses: Some(matrix.free),
        ..Finish::default()
    };
    elements.clear_single(out);
    for sheet in elements.sheets() {
        let quantity = Quantity::Tangent { clamped };
        let sheet = sheet.scaled(matrix.stiffness, matrix.damping);
        set(quantity, &sheet, &[matrix.x, p], out, false, &finish);
    }
    elements.finish_single(p, out, &finish);
    let Some(packed) = elements.of::<Springs>().find_map(Springs::packed) else {
        return in_sheets;
    };
    packed.add_product(matrix, p, out);
    // The product is 0 on pinned particles.
    divide_by_masses(matrix.free, out);
    in_sheets + packed.len()
}

/// Adds the blocks of these springs to the diagonal of the matrix. Returns their number.
pub(super) fn add_diagonal(elements: &Elements, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
    let all = elements.all().iter();
    all.map(|element| element.force().add_diagonal(matrix, diagonal)).sum()
}

/// Visits all other couplings.
pub(super) fn other_couplings(
    elements: &Elements,
    t: f64,
    x: &[f64],
    clamped: bool,
    visit: &mut dyn FnMut(Coupling),
) {
    let all = elements.all().iter().map(Element::force);
    for force in all.filter(|force| !force.multiplies_together()) {
        force.couplings(t, x, clamped, visit);
    }
}

impl Elements {
    /// Adds one spring between particles that exist.
    pub fn add_spring(&mut self, spring: Spring) -> Result<(), Error> {
        check_ends([spring.i, spring.j], self.particles())?;
        if let Some(springs) = self.first_mut::<Springs>() {
            springs.push(spring);
            return Ok(());
        }
        let mut springs = Springs::default();
        springs.push(spring);
        self.insert(springs.into());
        Ok(())
    }

    /// Sorts the single springs by their ends.
    pub fn sort_springs(&mut self) {
        if let Some(springs) = self.first_mut::<Springs>() {
            springs.sort();
        }
    }

    /// Adds a bend spring that buckles, between particles that exist.
    pub fn add_buckling(&mut self, buckling: Buckling) -> Result<(), Error> {
        check_ends([buckling.i, buckling.j], self.particles())?;
        if let Some(springs) = self.first_mut::<BucklingSprings>() {
            return springs.push(buckling);
        }
        let mut springs = BucklingSprings::default();
        springs.push(buckling)?;
        self.add(springs.into())
    }

    pub fn buckling(&self) -> impl Iterator<Item = Buckling> {
        self.of::<BucklingSprings>().flat_map(BucklingSprings::all)
    }

    /// Returns the springs of sheets, and then the single ones.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        let single = self.of::<Springs>().flat_map(Springs::all).copied();
        self.sheets().flat_map(Sheet::springs).chain(single)
    }

    pub fn all_springs(&self) -> impl Iterator<Item = Spring> {
        self.springs().chain(self.straight()).chain(self.cords())
    }

    /// Returns the springs that buckle, as they are while straight.
    fn straight(&self) -> impl Iterator<Item = Spring> {
        let buckling = self.of::<BucklingSprings>();
        buckling.flat_map(BucklingSprings::straight)
    }

    /// Returns the springs that only pull.
    pub fn cords(&self) -> impl Iterator<Item = Spring> {
        self.of::<Cords>().flat_map(Cords::springs)
    }

    /// Checks that there is a spring between each of these pairs of particles.
    pub fn check_springs(&self, pairs: &[[usize; 2]]) -> Result<(), Error> {
        let mut there: Vec<_> = self.all_springs().map(|s| ends(&s)).collect();
        there.sort_unstable();
        for &[i, j] in pairs {
            if there.binary_search(&[i.min(j), i.max(j)]).is_err() {
                return Err(Error::Invalid(format!(
                    "there is no spring between particles {i} and {j}"
                )));
            }
        }
        Ok(())
    }

    /// Replaces the springs, the solids and the fluid by those of others, of the same particles.
    pub fn copy_springs(&mut self, others: &Self) -> Result<(), Error> {
        let [n, of_others] = [self, others].map(Self::particles);
        if n != of_others {
            return Err(Error::Invalid(format!(
                "the springs of a network of {of_others} particles do not fit one of {n}"
            )));
        }
        let is_matter = |element: &Element| element.force().matter().is_some();
        self.replace(is_matter, None);
        for element in others.all().iter().filter(|element| is_matter(element)) {
            self.insert(element.clone());
        }
        Ok(())
    }

    /// Returns the strain at each particle at x (m).
    pub fn strains(&self, x: &[f64]) -> Vec<f64> {
        let mut strains = vec![f64::NAN; self.particles()];
        let stretch = |s: &Spring| distance(x, s.i, s.j) / s.law.rest_length - 1.0;
        let others = self.springs().chain(self.straight());
        let others = others.map(|s| (s, stretch(&s).abs()));
        let cords = self.cords().map(|s| (s, stretch(&s).max(0.0)));
        let all = others.chain(cords);
        for (s, strain) in all.filter(|(s, _)| s.law.rest_length > 0.0) {
            for i in [s.i, s.j] {
                strains[i] = strains[i].max(strain);
            }
        }
        for (corners, strain) in self.solids().flat_map(|solid| solid.strains(x)) {
            for i in corners {
                strains[i as usize] = strains[i as usize].max(strain);
            }
        }
        strains
    }

    /// Returns the largest length over rest length of a structural spring, or principal stretch of
    /// a solid.
    pub fn largest_stretch(&self, x: &[f64]) -> Option<f64> {
        let structural = |s: &Spring| s.kind == SpringKind::Structural && s.law.rest_length > 0.0;
        let of_springs = self.springs().chain(self.cords()).filter(structural);
        let of_springs = of_springs.map(|s| distance(x, s.i, s.j) / s.law.rest_length);
        let of_solids = self.solids().flat_map(|solid| solid.stretches(x));
        let of_solids = of_solids.map(|(_, stretches)| stretches.max());
        of_springs.chain(of_solids).reduce(f64::max)
    }
}
