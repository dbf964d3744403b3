//! Limits of strain of the bodies of a network.

use std::ops::Range;

use super::Network;
use crate::contact::StrainLimit;
use crate::error::Error;
use crate::spring::SpringKind;

impl Network {
    /// Limits the length over rest length of structural and shear springs among some particles, in
    /// place of limits of any of these; or lets them be as long as they may. Springs of rest length
    /// 0 are not limited. Integrators know nothing of it: a [`Simulation`](crate::Simulation)
    /// shortens what is too long after each step.
    ///
    /// # Errors
    /// The limit is not a finite number above 1, or there are no such particles; or springs that
    /// break at that stretch or above would never be stretched so far.
    pub fn set_strain_limit(
        &mut self,
        particles: Range<usize>,
        limit: Option<f64>,
    ) -> Result<(), Error> {
        if particles.is_empty() || particles.end > self.particles() {
            return Err(Error::Invalid(format!(
                "there are no particles {} to {}: the network has {}",
                particles.start,
                particles.end,
                self.particles()
            )));
        }
        if let Some(limit) = limit {
            if !limit.is_finite() || limit <= 1.0 {
                return Err(Error::Invalid(format!(
                    "the limit of strain must be a finite number above 1, such as 1.1, not {limit}"
                )));
            }
            check_tear(limit, self.tear)?;
        }
        let apart =
            |other: &Range<usize>| other.end <= particles.start || particles.end <= other.start;
        self.strain_limits.retain(|(other, _)| apart(other));
        if let Some(limit) = limit {
            let before = |(other, _): &(Range<usize>, f64)| other.end <= particles.start;
            let place = self.strain_limits.partition_point(before);
            self.strain_limits.insert(place, (particles, limit));
        }
        self.strained = None;
        Ok(())
    }

    /// Limits of the length over rest length of springs, each with the particles among which it
    /// applies.
    #[must_use]
    pub fn strain_limits(&self) -> &[(Range<usize>, f64)] {
        &self.strain_limits
    }

    /// `Ok` if springs can be stretched so far that they break at `tear` rest lengths.
    ///
    /// # Errors
    /// They are limited to that or less.
    pub(super) fn check_tear(&self, tear: Option<f64>) -> Result<(), Error> {
        let mut limits = self.strain_limits.iter();
        limits.try_for_each(|(_, limit)| check_tear(*limit, tear))
    }

    /// Lists the springs that are limited, if any are and if they are not listed yet.
    pub(crate) fn list_strained(&mut self) {
        if self.strained.is_some() || self.strain_limits.is_empty() {
            return;
        }
        let longest = |i: usize, j: usize| {
            let limits = &self.strain_limits;
            let (particles, limit) = limits.get(limits.partition_point(|(p, _)| p.end <= i))?;
            (particles.contains(&i) && particles.contains(&j)).then_some(limit)
        };
        let springs = self.springs().filter_map(|s| {
            let limit = longest(s.i, s.j)?;
            let is_limited = s.kind != SpringKind::Bend && s.law.rest_length > 0.0;
            is_limited.then_some(([s.i, s.j], limit * s.law.rest_length))
        });
        self.strained = Some(StrainLimit::new(springs, &self.inverse_masses));
    }

    /// The springs that are limited, as they were last listed.
    pub(crate) fn strained(&self) -> Option<&StrainLimit> {
        self.strained.as_ref()
    }
}

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
