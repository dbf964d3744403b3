//! Tearing. A spring longer than the limit times its rest length breaks, and with it all between
//! the same two particles. A bend spring breaks also where a structural spring that it runs along
//! has: when no particle is left between its ends that structural springs join to both. Triangles
//! that have lost a side are holes.

use super::Network;
use crate::elements::Element;
use crate::elements::force::{distance_squared, ends};
use crate::error::Error;
use crate::spring::{Spring, SpringKind};

impl Network {
    /// Lets springs break at so many times their rest length, or never, as in a new network.
    /// Springs of rest length 0 never break.
    ///
    /// # Errors
    /// The limit is not a finite number above 1, or a limit of strain keeps springs below it.
    pub fn set_tear(&mut self, limit: Option<f64>) -> Result<(), Error> {
        if let Some(limit) = limit.filter(|limit| !limit.is_finite() || *limit <= 1.0) {
            return Err(Error::Invalid(format!(
                "the stretch at which springs break must be a finite number above 1, such as 2, not {limit}"
            )));
        }
        self.check_tear(limit)?;
        self.tear = limit;
        Ok(())
    }

    /// The length over rest length at which springs break, if they do.
    #[must_use]
    pub fn tear_limit(&self) -> Option<f64> {
        self.tear
    }

    /// Number of pairs of particles between which springs have broken.
    #[must_use]
    pub fn tears(&self) -> usize {
        self.torn.len()
    }

    /// Pairs of particles between which springs have broken, the lower number of each first, in
    /// order.
    #[must_use]
    pub fn torn(&self) -> &[[usize; 2]] {
        &self.torn
    }

    /// Breaks the springs between these pairs of particles.
    ///
    /// # Errors
    /// There is no spring between a pair of them.
    pub fn break_springs(&mut self, pairs: &[[usize; 2]]) -> Result<(), Error> {
        if pairs.is_empty() {
            return Ok(());
        }
        let mut there: Vec<_> = self.all_springs().map(|s| ends(&s)).collect();
        there.sort_unstable();
        for &[i, j] in pairs {
            if there.binary_search(&[i.min(j), i.max(j)]).is_err() {
                return Err(Error::Invalid(format!(
                    "there is no spring between particles {i} and {j}"
                )));
            }
        }
        self.break_between(pairs.iter().map(|&[i, j]| [i.min(j), i.max(j)]));
        Ok(())
    }

    /// Takes over the springs and triangles of the same network as it began, but for those between
    /// these pairs of particles.
    ///
    /// # Errors
    /// The other has not as many particles, or no such springs.
    pub fn mend(&mut self, whole: &Self, torn: &[[usize; 2]]) -> Result<(), Error> {
        self.torn.clone_from(&whole.torn);
        self.copy_springs(whole)?;
        self.triangles.clone_from(&whole.triangles);
        self.renew_contact();
        let more = torn.iter().filter(|[i, j]| !whole.is_torn(*i, *j));
        self.break_springs(&more.copied().collect::<Vec<_>>())
    }

    /// Whether a spring between particles i and j has broken.
    #[must_use]
    pub fn is_torn(&self, i: usize, j: usize) -> bool {
        self.torn.binary_search(&[i.min(j), i.max(j)]).is_ok()
    }

    /// Whether a triangle has all its sides: whoever draws leaves out the others.
    #[must_use]
    pub fn is_whole(&self, [a, b, c]: [usize; 3]) -> bool {
        !(self.is_torn(a, b) || self.is_torn(b, c) || self.is_torn(c, a))
    }

    /// Breaks the springs between pairs of particles, the lower number of each first. How many
    /// pairs are new.
    fn break_between(&mut self, pairs: impl IntoIterator<Item = [usize; 2]>) -> usize {
        let already = self.torn.len();
        self.torn.extend(pairs);
        self.torn.sort_unstable();
        self.torn.dedup();
        self.remove_torn();
        self.leave_out_holes();
        self.renew_contact();
        self.torn.len() - already
    }

    /// Removes the springs between particles where one has broken.
    pub(super) fn remove_torn(&mut self) {
        if !self.torn.is_empty() {
            self.strained = None;
            for element in &mut self.elements {
                element.force_mut().remove_springs(&self.torn);
            }
            // What is empty would still keep sweeps away.
            let is_left = |e: &Element| e.sheet().is_some() || !e.is_elastic() || !e.is_empty();
            self.elements.retain(is_left);
        }
    }

    /// Leaves out triangles that have lost a side.
    fn leave_out_holes(&mut self) {
        let whole = |corners: &&[u32; 3]| self.is_whole(corners.map(|i| i as usize));
        self.triangles = self.triangles.iter().filter(whole).copied().collect();
    }

    /// Whether springs at x (m) are so long that they break, or lack no more than that share of
    /// their length.
    pub(crate) fn is_overstretched(&self, x: &[f64], share: f64) -> bool {
        self.tear.is_some() && self.all_springs().any(|s| self.is_too_long(x, &s, share))
    }

    /// Whether a spring at x (m) is so long that it breaks, or lacks no more than that share of its
    /// length.
    fn is_too_long(&self, x: &[f64], s: &Spring, share: f64) -> bool {
        let most = self.tear.unwrap_or(f64::INFINITY) * s.law.rest_length * (1.0 - share);
        most > 0.0 && distance_squared(x, s.i, s.j) > most * most
    }

    /// Breaks the springs that are too long at x (m), or lack no more than that share of their
    /// length, and those that go with them. Returns between how many pairs.
    pub fn tear(&mut self, x: &[f64], share: f64) -> usize {
        if !self.is_overstretched(x, share) {
            return 0;
        }
        let is_too_long = |s: &Spring| self.is_too_long(x, s, share);
        let springs: Vec<Spring> = self.all_springs().collect();
        let mut torn: Vec<_> = springs
            .iter()
            .filter(|s| is_too_long(s))
            .map(ends)
            .collect();
        torn.sort_unstable();
        let holds = |s: &&Spring| torn.binary_search(&ends(s)).is_err();
        let before = Neighbours::by(springs.iter());
        let after = Neighbours::by(springs.iter().filter(holds));
        let is_cut = |s: &&Spring| {
            s.kind == SpringKind::Bend && before.share(s.i, s.j) && !after.share(s.i, s.j)
        };
        let cut: Vec<_> = springs.iter().filter(is_cut).map(ends).collect();
        self.break_between(torn.into_iter().chain(cut))
    }
}

/// The pairs of particles that structural springs join, both ways, in order.
struct Neighbours(Vec<[usize; 2]>);

impl Neighbours {
    fn by<'a>(springs: impl Iterator<Item = &'a Spring>) -> Self {
        let structural = springs.filter(|s| s.kind == SpringKind::Structural);
        let mut pairs: Vec<_> = structural.flat_map(|s| [[s.i, s.j], [s.j, s.i]]).collect();
        pairs.sort_unstable();
        Self(pairs)
    }

    /// Whether a particle is a neighbour of both i and j.
    fn share(&self, i: usize, j: usize) -> bool {
        let first = self.0.partition_point(|pair| pair[0] < i);
        let mut of_i = self.0[first..].iter().take_while(|pair| pair[0] == i);
        of_i.any(|[_, m]| self.0.binary_search(&[*m, j]).is_ok())
    }
}
