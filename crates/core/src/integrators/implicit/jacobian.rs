//! The Jacobian of f of a system without masses, or of rigid bodies: the system's own, or
//! differences of f. If a system is large and each of its numbers acts on few others, one
//! difference gives all columns of a colour of its [`Pattern`], and the matrix is sparse.

use std::ops::Range;

use nalgebra::ComplexField;

use super::lu::{Lu, SystemMatrix};
use super::newton::dot;
use super::pattern::Pattern;
use crate::error::Error;
use crate::integrators::method::MAX_DENSE;
use crate::measure::Measure;
use crate::random::SplitMix;
use crate::refusal::Refusal;
use crate::system::{ParticleSystem, rigid_of, size, without_derivative};
use crate::work::Work;

/// Step of a difference quotient, over the size of the number: about the root of the rounding
/// error.
const DIFFERENCE_SHARE: f64 = 1.490_116_119_384_765_6e-8;
/// Half the step of a central difference quotient, over the unit of the number.
const CENTRAL_SHARE: f64 = 1e-6;
/// The same for speeds of bodies, relative to that for positions: the resulting motion is tiny.
const SPEED_DIFFERENCE_SHARE: f64 = 1e-3;

/// Least size of a plain number, over its change in a step or over the largest number, if that is
/// smaller.
const LEAST_SIZE: f64 = 1e-3;

/// Size that counts as zero, as a share of the largest number: it would round away twice.
const NO_SIZE: f64 = f64::EPSILON * f64::EPSILON;
/// Least size: the step of its difference quotient is still a normal number.
const LEAST: f64 = f64::MIN_POSITIVE / NO_SIZE;

/// Number of plain numbers from which on a pattern is searched.
const MANY: usize = 32;

/// Largest number of entries of the factors of a sparse matrix: they take 160 MiB, as real and as
/// complex numbers.
const MOST: usize = 1 << 22;

/// Share of their size by which numbers change where the pattern is searched, away from a state at
/// which an entry happens to vanish.
const SEARCH_SHARE: f64 = 1e-5;

/// Share of the changes of a number by which they may miss the change that follows from the
/// matrix: by more, an entry is not in its pattern.
const MISSING_SHARE: f64 = 1e-3;
/// Largest rounding error of f, over its size, that is told from such a miss.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Lists the numbers of the state that the equations are solved for: all, except those of particles
/// on rigid bodies, which f does not read.
pub(super) fn unknowns(system: &dyn ParticleSystem) -> Vec<usize> {
    let mut all = vec![];
    system.measures(&mut |numbers, _| all.extend(numbers));
    all
}

/// Jacobian with respect to the unknowns, with its scratch.
pub(super) struct Jacobian {
    pub unknowns: Vec<usize>,
    /// Unit of each unknown, in which changes are compared, and the step of its difference
    /// quotient.
    units: Vec<[f64; 2]>,
    /// Cost of an evaluation of f, in multiplications within rows; infinite for rigid bodies, whose
    /// matrices are small.
    evaluation: f64,
    pub matrix: SystemMatrix,
    /// Entries of the mass matrix M, column by column; none if it is 1.
    pub mass: Vec<(u32, u32, f64)>,
    /// Whether differences are central: for bodies and constraints, of whose equations implicit
    /// Euler may make a single iteration, which keeps the error of the matrix.
    is_central: bool,
    /// Whether a pattern is still to be searched.
    searches: bool,
    at: Vec<f64>,
    f: Vec<f64>,
    changed: Vec<f64>,
    /// Changes of the unknowns that follow from a sparse matrix, and their sizes.
    follow: Vec<[f64; 2]>,
    /// Entries of a sparse matrix that the system knows.
    entries: Vec<(u32, u32, f64)>,
    /// Whether the system knows its pattern.
    is_given: bool,
}

impl Jacobian {
    /// Creates room for the Jacobian of a system.
    pub fn new(system: &dyn ParticleSystem) -> Self {
        let (dim, unknowns) = (system.dim(), unknowns(system));
        let (count, is_rigid) = (unknowns.len(), rigid_of(system).is_some());
        let mut is_plain = true;
        system.measures(&mut |_, measure| is_plain &= measure == Measure::Plain);
        let is_central = is_rigid || !is_plain && system.mechanics().is_none();
        let is_sparse = count >= MANY && count == dim && !is_central;
        let given = is_sparse.then(|| system.sparsity().iter().copied());
        let given = given.and_then(|given| pattern_of(count, given));
        let mass = system.mass_matrix().to_vec();
        Self {
            units: Vec::with_capacity(count),
            evaluation: if is_rigid { f64::INFINITY } else { system.evaluation_cost() },
            unknowns,
            is_given: given.is_some(),
            searches: given.is_none() && count >= MANY && !is_central,
            matrix: given.map_or_else(|| full(count), |given| sparse(given, &mass)),
            mass,
            is_central,
            at: vec![0.0; dim],
            f: vec![0.0; dim],
            changed: vec![0.0; dim],
            follow: vec![],
            entries: vec![],
        }
    }

    /// Returns the number of unknowns.
    pub fn order(&self) -> usize {
        self.unknowns.len()
    }

    /// Checks that the matrix is not too large.
    ///
    /// # Errors
    /// It is neither small nor sparse.
    pub fn check(&self) -> Result<(), Error> {
        let numbers = self.unknowns.len();
        let is_small = numbers <= MAX_DENSE || self.searches;
        if is_small || matches!(self.matrix, SystemMatrix::Sparse(..)) {
            return Ok(());
        }
        Err(Error::Unsupported {
            method: "the implicit method",
            why: Refusal::TooDense { numbers, most: MAX_DENSE },
        })
    }

    /// Returns the pattern that was found: 0 before a search and 1 for a full matrix, else 2 and
    /// the rows of each column after their number.
    pub fn pattern(&self) -> Vec<usize> {
        match &self.matrix {
            SystemMatrix::Full(_) => vec![usize::from(!self.searches)],
            SystemMatrix::Sparse(pattern, _) => {
                let columns = (0..self.unknowns.len()).map(|j| &pattern.rows[pattern.column(j)]);
                let lists = columns.flat_map(|rows| {
                    let rows = rows.iter().map(|row| *row as usize);
                    std::iter::once(rows.len()).chain(rows)
                });
                std::iter::once(2).chain(lists).collect()
            }
        }
    }

    /// Forgets the pattern, because the system may have changed.
    pub fn forget(&mut self) {
        if self.is_given {
            return;
        }
        self.searches = self.unknowns.len() >= MANY && !self.is_central;
        if matches!(self.matrix, SystemMatrix::Sparse(..)) {
            self.matrix = full(self.unknowns.len());
        }
    }

    /// Restores a pattern that was found. Returns false if it is of another system.
    pub fn set_pattern(&mut self, pattern: &[usize]) -> bool {
        let size = self.unknowns.len();
        let Some((&kind, mut lists)) = pattern.split_first() else {
            return false;
        };
        if kind < 2 {
            if lists.is_empty() {
                self.forget();
                self.searches &= kind == 0;
            }
            return lists.is_empty();
        }
        let mut columns = vec![];
        while let Some((&count, rest)) = lists.split_first() {
            let Some((rows, rest)) = rest.split_at_checked(count) else {
                return false;
            };
            let is_rising = rows.windows(2).all(|pair| pair[0] < pair[1]);
            if !is_rising || rows.last().is_some_and(|row| *row >= size) {
                return false;
            }
            columns.push(rows.iter().map(|row| *row as u32).collect());
            lists = rest;
        }
        let found = Some(columns).filter(|columns| columns.len() == size);
        let found = found.and_then(|columns| Pattern::of(&columns, MOST));
        let Some(found) = found else {
            return false;
        };
        (self.searches, self.matrix) = (false, sparse(found, &self.mass));
        true
    }

    /// Returns the work of linear algebra with this number of multiplications.
    pub fn algebra(&self, multiplications: f64) -> Work {
        Work { algebra: multiplications / self.evaluation, ..Work::default() }
    }

    /// Writes the product of M with numbers.
    pub fn multiply_mass(&self, numbers: &[f64], out: &mut [f64]) {
        if self.mass.is_empty() {
            return out.copy_from_slice(numbers);
        }
        out.fill(0.0);
        for (i, j, value) in &self.mass {
            out[*i as usize] += value * numbers[*j as usize];
        }
    }

    /// Factorises `shift` M - `scale` J. Returns false if it is singular or not finite.
    pub fn factorise<T>(&self, factors: &mut Lu<T>, shift: T, scale: f64) -> bool
    where
        T: ComplexField<RealField = f64> + Copy,
    {
        factors.factorise((shift, &self.mass), scale, &self.matrix)
    }

    /// Returns the norm of the unknowns in a state, in their units.
    pub fn norm(&self, y: &[f64]) -> f64 {
        let numbers = self.unknowns.iter().zip(&self.units);
        let squares = numbers.map(|(i, [unit, _])| (y[*i] / unit).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Finds the units at y, where f is known. With rigid bodies they are the largest radius, the
    /// speed that covers it in a time a, the length of a quaternion, and the angular momentum at
    /// which the body's surface has that speed; without bodies, plain numbers.
    fn measure(&mut self, system: &dyn ParticleSystem, a: f64, y: &[f64]) {
        let (mut length, mut most) = (0.0_f64, 0.0_f64);
        system.measures(&mut |numbers, measure| match measure {
            Measure::Rotation { radius } => length = length.max(radius),
            Measure::Plain => most = y[numbers].iter().fold(most, |most, y| most.max(y.abs())),
            _ => (),
        });
        let bound = without_derivative(system);
        let of_plain = |k: usize, f: f64| {
            // A tiny change of such a number would round away beside others.
            let change = match bound.binary_search(&k) {
                Ok(_) => LEAST_SIZE * most,
                Err(_) => LEAST_SIZE * (a * f).abs().min(most),
            };
            let scale = system.scales().get(k).copied();
            let own = y[k].abs().max(scale.unwrap_or(change));
            let sizes = [(own, NO_SIZE * most), (LEAST_SIZE * most, 0.0)];
            let size = sizes.into_iter().find(|(size, none)| size > none && *size > LEAST);
            // Towards where the number goes: beyond, f may not be defined.
            size.map_or(1.0, |(size, _)| size).copysign(f)
        };
        let speed = length / a.abs();
        let Self { units, f, is_central, .. } = self;
        let share = if *is_central { CENTRAL_SHARE } else { DIFFERENCE_SHARE };
        units.clear();
        system.measures(&mut |numbers, measure| {
            let unit = match measure {
                Measure::Position => length,
                Measure::Rotation { .. } => dot(&y[numbers.clone()], &y[numbers.clone()]).sqrt(),
                Measure::Velocity => speed,
                Measure::Momentum { speed: own } => speed / own,
                Measure::Plain | Measure::Alike => 0.0,
            };
            let of_unit = match measure {
                Measure::Position | Measure::Rotation { .. } => share * unit,
                _ => SPEED_DIFFERENCE_SHARE * share * unit,
            };
            units.extend(numbers.map(|k| {
                if unit > 0.0 {
                    return [unit, of_unit];
                }
                let size = match measure {
                    Measure::Plain => of_plain(k, f[k]),
                    _ => size(system, k, y[k]),
                };
                let step = share * size;
                // Exactly the difference of two numbers.
                [1.0, if *is_central { step } else { (y[k] + step) - y[k] }]
            }));
        });
    }

    /// Forms the Jacobian at y, for steps of about a (s). One that the system knows counts as an
    /// evaluation for each of its columns or, if it is sparse, for each of their colours.
    pub fn form(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> Work {
        let count = self.unknowns.len();
        if let Some(work) = self.take_entries(system, t, y) {
            return work;
        }
        if let SystemMatrix::Full(matrix) = &mut self.matrix
            && count == y.len()
            && count <= MAX_DENSE
            && system.jacobian(t, y, matrix)
        {
            self.units.clear();
            self.units.resize(count, [1.0, 0.0]);
            return Work::of(count as u64);
        }
        let mut work = Work::default();
        if !self.is_central {
            system.eval_f(t, y, &mut self.f);
            work = Work::of(1);
        }
        self.measure(system, a, y);
        self.at.copy_from_slice(y);
        let mut grows = true;
        if std::mem::take(&mut self.searches) {
            work += self.search(system, t, y).0;
        }
        while std::mem::take(&mut grows) {
            work += self.difference(system, t, y);
            let (cost, is_met) = self.is_met(system, t, y);
            work += cost;
            if !is_met {
                let (cost, found) = self.search(system, t, y);
                work += cost;
                grows = found;
            }
        }
        work
    }

    /// Takes the entries at y of a sparse matrix that the system knows. Returns the cost; `None` if
    /// the system is small, or its matrix is not known or not sparse.
    fn take_entries(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Option<Work> {
        let is_dense = matches!(self.matrix, SystemMatrix::Full(_)) && !self.searches
            || self.unknowns.len() != y.len();
        self.entries.clear();
        if is_dense || !system.jacobian_entries(t, y, &mut self.entries) {
            return None;
        }
        let count = self.unknowns.len();
        let entries = &self.entries;
        loop {
            if let SystemMatrix::Sparse(pattern, values) = &mut self.matrix {
                values.fill(0.0);
                let put = |(row, column, value): &(u32, u32, f64)| {
                    let places = pattern.column(*column as usize);
                    let place = pattern.rows[places.clone()].binary_search(row).ok()?;
                    values[places.start + place] += value;
                    Some(())
                };
                if entries.iter().map(put).all(|is_put| is_put.is_some()) {
                    self.units.clear();
                    self.units.resize(count, [1.0, 0.0]);
                    return Some(Work::of(pattern.colours.len() as u64));
                }
            }
            // Entries that were 0 until now.
            let known = match &self.matrix {
                SystemMatrix::Sparse(pattern, _) => pattern.places(),
                SystemMatrix::Full(_) => vec![],
            };
            let new = entries.iter().map(|(row, column, _)| (*row, *column));
            // The matrix of a step, M - a J, mostly has a diagonal also where J has none.
            let diagonal = (0..count as u32).map(|k| (k, k));
            self.searches = false;
            let all = known.into_iter().chain(new).chain(diagonal);
            let Some(found) = pattern_of(count, all) else {
                self.matrix = full(count);
                return None;
            };
            self.matrix = sparse(found, &self.mass);
        }
    }

    /// Searches the pattern of the matrix near y. Returns the cost, and whether it has become
    /// larger.
    fn search(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> (Work, bool) {
        let Self { unknowns, units, matrix, mass, searches, at, f, changed, .. } = self;
        let mut random = SplitMix(1);
        let all = unknowns.iter().zip(&*units);
        let mut shifts = || -> Vec<f64> {
            let share = SEARCH_SHARE / DIFFERENCE_SHARE;
            let all = all.clone();
            all.map(|(_, [_, step])| share * step * random.between(0.5, 1.0)).collect()
        };
        let (away, moves) = (shifts(), shifts());
        at.copy_from_slice(y);
        for (j, away) in unknowns.iter().zip(&away) {
            at[*j] += away;
        }
        let mut base = vec![0.0; y.len()];
        system.eval_f(t, at, &mut base);
        if base.iter().any(|f| !f.is_finite()) {
            at.copy_from_slice(y);
            base.copy_from_slice(f);
        }
        if base.iter().any(|f| !f.is_finite()) {
            *searches = true;
            return (Work::of(1), false);
        }
        let (mut count, mut failed) = (1, false);
        let found = Pattern::find(unknowns.len(), MOST, |ranges: &[Range<usize>]| {
            let columns = || ranges.iter().flat_map(Clone::clone);
            let before: Vec<_> = columns().map(|k| at[unknowns[k]]).collect();
            columns().for_each(|k| at[unknowns[k]] += moves[k]);
            system.eval_f(t, at, changed);
            for (k, before) in columns().zip(before) {
                at[unknowns[k]] = before;
            }
            count += 1;
            // An evaluation that failed, after which all do.
            failed |= changed.iter().all(|f| f.is_nan());
            let differs = |i: usize| !failed && changed[i].to_bits() != base[i].to_bits();
            let rows = unknowns.iter().zip(0..);
            rows.filter(|(i, _)| differs(**i)).map(|(_, row)| row).collect()
        });
        at.copy_from_slice(y);
        if failed {
            *searches = true;
            return (Work::of(count), false);
        }
        let known = match &*matrix {
            SystemMatrix::Sparse(known, _) => Some(known),
            SystemMatrix::Full(_) => None,
        };
        let found = match known {
            Some(known) => found.and_then(|found| known.joined(&found, MOST)),
            None => found,
        };
        let grows = match (known, &found) {
            (Some(known), Some(found)) => found.rows.len() > known.rows.len(),
            (known, found) => known.is_some() || found.is_some(),
        };
        if grows {
            *matrix = found.map_or_else(|| full(unknowns.len()), |found| sparse(found, mass));
        }
        (Work::of(count), grows)
    }

    /// Computes the matrix by difference quotients at y, where f is known. Returns the cost.
    fn difference(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        let Self { unknowns, units, matrix, is_central, at, f, changed, .. } = self;
        let count = unknowns.len();
        match matrix {
            SystemMatrix::Full(matrix) if matrix.len() < count * count => Work::default(),
            SystemMatrix::Full(matrix) => {
                for (column, &j) in unknowns.iter().enumerate() {
                    let [_, mut step] = units[column];
                    at[j] = y[j] + step;
                    system.eval_f(t, at, changed);
                    if *is_central {
                        at[j] = y[j] - step;
                        system.eval_f(t, at, f);
                        step *= 2.0;
                    }
                    at[j] = y[j];
                    for (row, &i) in unknowns.iter().enumerate() {
                        matrix[row * count + column] = (changed[i] - f[i]) / step;
                    }
                }
                Work::of(count as u64 * if *is_central { 2 } else { 1 })
            }
            SystemMatrix::Sparse(pattern, values) => {
                for columns in &pattern.colours {
                    for k in columns {
                        at[unknowns[*k]] += units[*k][1];
                    }
                    system.eval_f(t, at, changed);
                    for column in columns {
                        at[unknowns[*column]] = y[unknowns[*column]];
                        for k in pattern.column(*column) {
                            let i = unknowns[pattern.rows[k] as usize];
                            values[k] = (changed[i] - f[i]) / units[*column][1];
                        }
                    }
                }
                Work::of(pattern.colours.len() as u64)
            }
        }
    }

    /// Returns whether all entries of a sparse matrix are in its pattern, by changes of all numbers
    /// at y, where f is known; and the cost.
    fn is_met(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> (Work, bool) {
        let SystemMatrix::Sparse(pattern, values) = &self.matrix else {
            return (Work::default(), true);
        };
        let mut random = SplitMix(2);
        let follow = &mut self.follow;
        follow.clear();
        follow.resize(self.unknowns.len(), [0.0; 2]);
        for (column, (j, [_, step])) in self.unknowns.iter().zip(&self.units).enumerate() {
            let step = step * random.between(0.5, 1.0);
            self.at[*j] = y[*j] + step;
            for k in pattern.column(column) {
                let [change, size] = &mut follow[pattern.rows[k] as usize];
                *change += values[k] * step;
                *size += (values[k] * step).abs();
            }
        }
        system.eval_f(t, &self.at, &mut self.changed);
        self.at.copy_from_slice(y);
        let is_met = self.unknowns.iter().zip(&*follow).all(|(i, [change, size])| {
            let (before, after) = (self.f[*i], self.changed[*i]);
            let rounding = ROUNDING * (before.abs() + after.abs());
            (after - before - change).abs() <= MISSING_SHARE * size + rounding
        });
        (Work::of(1), is_met)
    }
}

/// Returns the pattern of an order with entries in these rows and columns, if there are some, and
/// few.
fn pattern_of(order: usize, entries: impl Iterator<Item = (u32, u32)>) -> Option<Pattern> {
    let mut columns = vec![vec![]; order];
    let mut is_empty = true;
    for (row, column) in entries {
        columns[column as usize].push(row);
        is_empty = false;
    }
    for rows in &mut columns {
        rows.sort_unstable();
        rows.dedup();
    }
    Pattern::of(&columns, MOST).filter(|_| !is_empty)
}

/// Returns a matrix of zeros of a pattern, for sums with one that has these entries.
fn sparse(pattern: Pattern, mass: &[(u32, u32, f64)]) -> SystemMatrix {
    let pattern = pattern.summed_with(mass, MOST);
    let values = vec![0.0; pattern.rows.len()];
    SystemMatrix::Sparse(pattern, values)
}

/// Returns room for a full matrix of an order; none if it is too large.
fn full(order: usize) -> SystemMatrix {
    let room = if order > MAX_DENSE { 0 } else { order * order };
    SystemMatrix::Full(vec![0.0; room])
}
