//! Springs of a network, whichever element they are in.

use super::Network;
use crate::elements::force::{check_ends, distance};
use crate::elements::{Buckling, BucklingSprings, Element, Finish, Springs};
use crate::error::{Error, at_least, positive};
use crate::spring::{Spring, SpringKind};

impl Network {
    /// Changes the single springs.
    fn change_springs(&mut self, change: impl FnOnce(&mut Springs)) {
        self.strained = None;
        for element in &mut self.elements {
            if let Element::Springs(springs) = element {
                return change(springs);
            }
        }
        let mut springs = Springs::default();
        change(&mut springs);
        self.insert(springs.into());
    }

    /// Adds one spring.
    ///
    /// # Errors
    /// An end does not exist, or both are the same.
    pub fn add_spring(&mut self, spring: Spring) -> Result<(), Error> {
        check_ends([spring.i, spring.j], self.particles())?;
        self.change_springs(|springs| springs.push(spring));
        Ok(())
    }

    /// Adds springs in any order, and keeps all in the order of their ends: neighbours in memory
    /// are then used one after another.
    ///
    /// # Errors
    /// As [`add_spring`](Self::add_spring), for the first that cannot be: none after it is added.
    pub fn add_springs(&mut self, springs: impl IntoIterator<Item = Spring>) -> Result<(), Error> {
        let added = springs
            .into_iter()
            .try_for_each(|spring| self.add_spring(spring));
        for element in &mut self.elements {
            if let Element::Springs(springs) = element {
                springs.sort();
            }
        }
        added
    }

    /// Adds a bend spring that buckles, in place of one that does not.
    ///
    /// # Errors
    /// An end does not exist, or both are the same; a number is negative or not finite; the rest
    /// length or the stiffness against bending is 0, or the compression stiffness less than 4 pi2
    /// `k_b` / r3.
    pub fn add_buckling(&mut self, buckling: Buckling) -> Result<(), Error> {
        check_ends([buckling.i, buckling.j], self.particles())?;
        for element in &mut self.elements {
            if let Element::BucklingSprings(springs) = element {
                return springs.push(buckling);
            }
        }
        let mut springs = BucklingSprings::default();
        springs.push(buckling)?;
        self.add(springs)
    }

    fn buckling_springs(&self) -> impl Iterator<Item = &BucklingSprings> {
        self.elements.iter().filter_map(|element| match element {
            Element::BucklingSprings(springs) => Some(springs),
            _ => None,
        })
    }

    /// The bend springs that buckle.
    pub fn buckling(&self) -> impl Iterator<Item = Buckling> {
        self.buckling_springs().flat_map(BucklingSprings::all)
    }

    /// Every spring by itself, those of sheets first; none that buckles.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.elements.iter().flat_map(Element::springs)
    }

    /// Every spring by itself, those that buckle as they are while straight.
    pub fn all_springs(&self) -> impl Iterator<Item = Spring> {
        let straight = self.buckling_springs().flat_map(BucklingSprings::straight);
        self.springs().chain(straight)
    }

    /// The springs attached to particle i, those that buckle as they are while straight.
    pub fn springs_of(&self, i: usize) -> impl Iterator<Item = Spring> {
        self.all_springs().filter(move |s| s.i == i || s.j == i)
    }

    /// Each neighbour of particle i in a solid, with its distance at rest (m).
    pub(crate) fn neighbours_in_solids(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let solids = self.elements.iter().filter_map(Element::solid);
        solids.flat_map(move |solid| solid.neighbours(i))
    }

    /// Whether there are springs or solids.
    #[must_use]
    pub fn is_elastic(&self) -> bool {
        self.elements
            .iter()
            .any(|e| e.is_elastic() && !e.is_empty())
    }

    /// Whether springs or solids are damped.
    #[must_use]
    pub fn is_damped(&self) -> bool {
        let mut elements = self.elements.iter().filter(|e| e.is_elastic());
        elements.any(|e| e.force().reads_velocity())
    }

    /// Makes every spring and solid so many times as stiff, and damps it by the root of that more:
    /// its damping ratio stays.
    ///
    /// # Errors
    /// The factor is not a finite number above 0.
    pub fn scale_stiffness(&mut self, factor: f64) -> Result<(), Error> {
        self.scale_springs(factor, factor.sqrt())
    }

    /// Makes every spring and solid so many times as stiff, and so many times as damped, and
    /// likewise the fluid: the square of its speed of sound, and its viscosity.
    ///
    /// # Errors
    /// The factor of the stiffness is not a finite number above 0, or that of the damping not one
    /// of at least 0.
    pub fn scale_springs(&mut self, stiffness: f64, damping: f64) -> Result<(), Error> {
        positive("the factor of the stiffness", stiffness)?;
        at_least(0.0, "the factor of the damping", damping)?;
        for element in &mut self.elements {
            element.force_mut().scale(stiffness, damping);
        }
        Ok(())
    }

    /// Takes over the springs, the solids and the fluid of another network of the same particles.
    /// Those that have broken here stay broken.
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
        let is_tuned = |e: &Element| e.is_elastic() || e.fluid().is_some();
        self.replace(is_tuned, None);
        for element in other.elements.iter().filter(|e| is_tuned(e)) {
            self.insert(element.clone());
        }
        self.remove_torn();
        Ok(())
    }

    /// Writes the forces (N) of all springs to f, in the state (x, v).
    pub fn spring_forces(&self, x: &[f64], v: &[f64], f: &mut [f64]) {
        let springs = self.elements.iter().filter(|e| e.is_elastic());
        self.sum(springs, &self.at(0.0, x, v), f, &Finish::default());
    }

    /// The strain at each particle at x (m), n x 3: the most by which the length of one of its
    /// springs over that at rest, or a principal stretch of one of its tetrahedra, differs from 1;
    /// NaN where there are neither. Springs of rest length 0 have none.
    #[must_use]
    pub fn strains(&self, x: &[f64]) -> Vec<f64> {
        let mut strains = vec![f64::NAN; self.particles()];
        for s in self.all_springs().filter(|s| s.law.rest_length > 0.0) {
            let strain = (distance(x, s.i, s.j) / s.law.rest_length - 1.0).abs();
            for i in [s.i, s.j] {
                strains[i] = strains[i].max(strain);
            }
        }
        let solids = self.elements.iter().filter_map(Element::solid);
        for (corners, strain) in solids.flat_map(|solid| solid.strains(x)) {
            for i in corners {
                strains[i as usize] = strains[i as usize].max(strain);
            }
        }
        strains
    }

    /// Length over rest length of the structural spring that is stretched most, or the largest
    /// principal stretch of a solid, if there is any.
    #[must_use]
    pub fn largest_stretch(&self, x: &[f64]) -> Option<f64> {
        let structural = |s: &Spring| s.kind == SpringKind::Structural && s.law.rest_length > 0.0;
        let of_springs = self.springs().filter(structural);
        let of_springs = of_springs.map(|s| distance(x, s.i, s.j) / s.law.rest_length);
        let solids = self.elements.iter().filter_map(Element::solid);
        let of_solids = solids.flat_map(|solid| solid.stretches(x));
        let of_solids = of_solids.map(|(_, stretches)| stretches.max());
        of_springs.chain(of_solids).reduce(f64::max)
    }
}
