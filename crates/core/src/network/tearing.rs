//! Tearing, and limits of strain. A spring longer than the limit times its rest length breaks,
//! together with all springs between the same two particles. A bend spring also breaks with a
//! structural spring along it: when no particle between its ends is left that structural springs
//! join to both. Triangles with a broken side are holes.

use std::ops::Range;

use super::elements::Elements;
use crate::contact::StrainLimit;
use crate::elements::force::{distance_squared, ends};
use crate::error::Error;
use crate::spring::{Spring, SpringKind};

/// Springs that have broken, and the limit at which others break.
#[derive(Clone, Debug, Default)]
pub(super) struct Tears {
    /// Length over rest length at which springs break.
    limit: Option<f64>,
    /// Pairs of particles between which springs have broken, in order.
    torn: Vec<[usize; 2]>,
}

impl Tears {
    /// Checks that springs can break at that stretch.
    pub fn check_limit(limit: Option<f64>) -> Result<(), Error> {
        match limit.filter(|limit| !limit.is_finite() || *limit <= 1.0) {
            Some(limit) => Err(Error::Invalid(format!(
                "the stretch at which springs break must be a finite number above 1, such as 2, not {limit}"
            ))),
            None => Ok(()),
        }
    }

    pub fn set_limit(&mut self, limit: Option<f64>) {
        self.limit = limit;
    }

    pub fn limit(&self) -> Option<f64> {
        self.limit
    }

    pub fn torn(&self) -> &[[usize; 2]] {
        &self.torn
    }

    /// Copies the pairs of others.
    pub fn copy_torn(&mut self, others: &Self) {
        self.torn.clone_from(&others.torn);
    }

    /// Returns whether a spring between particles i and j has broken.
    pub fn is_torn(&self, i: usize, j: usize) -> bool {
        self.torn.binary_search(&[i.min(j), i.max(j)]).is_ok()
    }

    /// Returns whether a triangle has all its sides.
    pub fn is_whole(&self, [a, b, c]: [usize; 3]) -> bool {
        !(self.is_torn(a, b) || self.is_torn(b, c) || self.is_torn(c, a))
    }

    /// Adds pairs of particles, given with the lower number first. Returns the number of new pairs.
    pub fn add(&mut self, pairs: impl IntoIterator<Item = [usize; 2]>) -> usize {
        let already = self.torn.len();
        self.torn.extend(pairs);
        self.torn.sort_unstable();
        self.torn.dedup();
        self.torn.len() - already
    }

    /// Returns whether springs at x (m) exceed the length at which they break, or fall short of it
    /// by at most the fraction `share`.
    pub fn is_overstretched(&self, elements: &Elements, x: &[f64], share: f64) -> bool {
        let is_too_long = |s: Spring| self.is_too_long(x, &s, share);
        self.limit.is_some() && elements.all_springs().any(is_too_long)
    }

    /// Returns whether a spring at x (m) exceeds the length at which it breaks, or falls short of
    /// it by at most the fraction `share`.
    fn is_too_long(&self, x: &[f64], s: &Spring, share: f64) -> bool {
        let most = self.limit.unwrap_or(f64::INFINITY) * s.law.rest_length * (1.0 - share);
        most > 0.0 && distance_squared(x, s.i, s.j) > most * most
    }

    /// Returns the pairs of particles between which springs break at x (m), with a `share` as
    /// above, and those of the bend springs along them.
    pub fn breaking(&self, elements: &Elements, x: &[f64], share: f64) -> Vec<[usize; 2]> {
        let is_too_long = |s: &Spring| self.is_too_long(x, s, share);
        let springs: Vec<Spring> = elements.all_springs().collect();
        let mut torn: Vec<_> = springs.iter().filter(|s| is_too_long(s)).map(ends).collect();
        torn.sort_unstable();
        let holds = |s: &&Spring| torn.binary_search(&ends(s)).is_err();
        let before = JoinedPairs::by(springs.iter());
        let after = JoinedPairs::by(springs.iter().filter(holds));
        let is_cut = |s: &&Spring| {
            s.kind == SpringKind::Bend && before.share(s.i, s.j) && !after.share(s.i, s.j)
        };
        let cut: Vec<_> = springs.iter().filter(is_cut).map(ends).collect();
        torn.extend(cut);
        torn
    }
}

/// Sorted pairs of particles that structural springs join, each in both orders.
struct JoinedPairs(Vec<[usize; 2]>);

impl JoinedPairs {
    fn by<'a>(springs: impl Iterator<Item = &'a Spring>) -> Self {
        let structural = springs.filter(|s| s.kind == SpringKind::Structural);
        let mut pairs: Vec<_> = structural.flat_map(|s| [[s.i, s.j], [s.j, s.i]]).collect();
        pairs.sort_unstable();
        Self(pairs)
    }

    /// Returns whether a particle is a neighbour of both i and j.
    fn share(&self, i: usize, j: usize) -> bool {
        let first = self.0.partition_point(|pair| pair[0] < i);
        let mut of_i = self.0[first..].iter().take_while(|pair| pair[0] == i);
        of_i.any(|[_, m]| self.0.binary_search(&[*m, j]).is_ok())
    }
}

/// Limits of strain, and the springs that they apply to.
#[derive(Clone, Debug, Default)]
pub(super) struct StrainLimits {
    /// Particles among which springs are limited, and the limits of length over rest length.
    all: Vec<(Range<usize>, f64)>,
    /// Limited springs, unless springs or pins have changed since they were listed.
    listed: Option<StrainLimit>,
}

impl StrainLimits {
    pub fn all(&self) -> &[(Range<usize>, f64)] {
        &self.all
    }

    /// Sets or removes the limit among some of n particles. Springs break at `tear` rest lengths.
    pub fn set(
        &mut self,
        particles: Range<usize>,
        limit: Option<f64>,
        n: usize,
        tear: Option<f64>,
    ) -> Result<(), Error> {
        if particles.is_empty() || particles.end > n {
            return Err(Error::Invalid(format!(
                "there are no particles {} to {}: the network has {n}",
                particles.start, particles.end,
            )));
        }
        if let Some(limit) = limit {
            if !limit.is_finite() || limit <= 1.0 {
                return Err(Error::Invalid(format!(
                    "the limit of strain must be a finite number above 1, such as 1.1, not {limit}"
                )));
            }
            check_tear(limit, tear)?;
        }
        let apart =
            |other: &Range<usize>| other.end <= particles.start || particles.end <= other.start;
        self.all.retain(|(other, _)| apart(other));
        if let Some(limit) = limit {
            let before = |(other, _): &(Range<usize>, f64)| other.end <= particles.start;
            let place = self.all.partition_point(before);
            self.all.insert(place, (particles, limit));
        }
        self.forget();
        Ok(())
    }

    /// Checks that the limits let springs reach the `tear` rest lengths at which they break.
    pub fn check_tear(&self, tear: Option<f64>) -> Result<(), Error> {
        let mut limits = self.all.iter();
        limits.try_for_each(|(_, limit)| check_tear(*limit, tear))
    }

    /// Drops the list of springs, because springs or pins have changed.
    pub fn forget(&mut self) {
        self.listed = None;
    }

    /// Lists the limited springs, if there are any and they are not listed yet.
    pub fn list(&mut self, elements: &Elements, inverse_masses: &[f64]) {
        if self.listed.is_some() || self.all.is_empty() {
            return;
        }
        let longest = |i: usize, j: usize| {
            let limits = &self.all;
            let (particles, limit) = limits.get(limits.partition_point(|(p, _)| p.end <= i))?;
            (particles.contains(&i) && particles.contains(&j)).then_some(limit)
        };
        let springs = elements.springs().filter_map(|s| {
            let limit = longest(s.i, s.j)?;
            let is_limited = s.kind != SpringKind::Bend && s.law.rest_length > 0.0;
            is_limited.then_some(([s.i, s.j], limit * s.law.rest_length))
        });
        self.listed = Some(StrainLimit::new(springs, inverse_masses));
    }

    /// Returns the limited springs, as last listed.
    pub fn listed(&self) -> Option<&StrainLimit> {
        self.listed.as_ref()
    }
}

/// Checks that springs limited to a stretch can reach the one at which they break.
fn check_tear(limit: f64, tear: Option<f64>) -> Result<(), Error> {
    match tear.filter(|tear| limit <= *tear) {
        Some(tear) => Err(Error::Invalid(format!(
            "springs limited to {limit} times their rest length never break at {tear} times: a \
             limit of strain must be above the stretch at which springs break, or one of the two \
             be left out"
        ))),
        None => Ok(()),
    }
}
