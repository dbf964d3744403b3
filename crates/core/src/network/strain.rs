//! Limits of strain of the bodies of a network.

use std::ops::Range;

use super::elements::Elements;
use crate::contact::StrainLimit;
use crate::error::Error;
use crate::spring::SpringKind;

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
