//! Springs of a network, of all its elements.

use super::element::Element;
use super::elements::Elements;
use crate::elements::force::{check_ends, distance, ends};
use crate::elements::{Buckling, BucklingSprings, Cords, Sheet, Springs};
use crate::error::Error;
use crate::spring::{Spring, SpringKind};

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
