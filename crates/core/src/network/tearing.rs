//! What is stretched too far tears. A spring longer than the limit times its rest length breaks. A bend spring breaks also
//! where a structural spring that it runs along has: when no particle is left between its ends that is held to both.
//! Triangles that have lost a side are holes.

use super::{Network, Strip};
use crate::error::Error;
use crate::spring::{Spring, SpringKind};

impl Network {
    /// Lets springs break at so many times their rest length, or never, which is how a network begins. Those of rest
    /// length 0 do not.
    ///
    /// # Errors
    /// The limit is not a finite number above 1.
    pub fn set_tear(&mut self, limit: Option<f64>) -> Result<(), Error> {
        if let Some(limit) = limit.filter(|limit| !limit.is_finite() || *limit <= 1.0) {
            return Err(Error::Invalid(format!(
                "the stretch at which springs break must be a finite number above 1, such as 2, not {limit}"
            )));
        }
        self.tear = limit;
        Ok(())
    }

    /// The length over rest length at which springs break, if they do.
    #[must_use]
    pub fn tear_limit(&self) -> Option<f64> {
        self.tear
    }

    /// Springs that have broken.
    #[must_use]
    pub fn tears(&self) -> usize {
        self.torn.len()
    }

    /// Between which particles, the lower number first, in order.
    #[must_use]
    pub fn torn(&self) -> &[[usize; 2]] {
        &self.torn
    }

    /// Breaks the springs between these particles.
    ///
    /// # Errors
    /// There is none between two of them.
    pub fn break_springs(&mut self, pairs: &[[usize; 2]]) -> Result<(), Error> {
        if pairs.is_empty() {
            return Ok(());
        }
        let straight = self.strips.iter().map(Strip::straight);
        let springs = self.springs().chain(straight);
        let mut there: Vec<_> = springs.map(|s| ends(s.i, s.j)).collect();
        there.sort_unstable();
        for &[i, j] in pairs {
            if there.binary_search(&ends(i, j)).is_err() {
                return Err(Error::Invalid(format!(
                    "there is no spring between particles {i} and {j}"
                )));
            }
        }
        self.torn.extend(pairs.iter().map(|&[i, j]| ends(i, j)));
        self.torn.sort_unstable();
        self.torn.dedup();
        self.leave_out_torn();
        self.leave_out_holes();
        Ok(())
    }

    /// Takes over the springs and triangles of the same network as it began, but for those between these particles.
    ///
    /// # Errors
    /// It has not as many particles, or no such springs.
    pub fn mend(&mut self, whole: &Self, torn: &[[usize; 2]]) -> Result<(), Error> {
        self.torn.clone_from(&whole.torn);
        self.copy_springs(whole)?;
        self.triangles.clone_from(&whole.triangles);
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

    /// Leaves out springs between particles where one has broken.
    pub(super) fn leave_out_torn(&mut self) {
        if self.torn.is_empty() {
            return;
        }
        let mut springs: Vec<Spring> = self.springs().collect();
        if self.sheet.take().is_some() {
            springs.sort_by_key(|s| ends(s.i, s.j));
        }
        springs.retain(|s| !self.is_torn(s.i, s.j));
        self.list = springs;
        let torn = std::mem::take(&mut self.torn);
        self.strips
            .retain(|strip| torn.binary_search(&ends(strip.of.i, strip.of.j)).is_err());
        self.torn = torn;
    }

    /// Leaves out triangles that have lost a side.
    fn leave_out_holes(&mut self) {
        let whole = |corners: &&[u32; 3]| self.is_whole(corners.map(|i| i as usize));
        self.triangles = self.triangles.iter().filter(whole).copied().collect();
    }

    /// Breaks the springs that are too long at x (m), and those that go with them. How many they are.
    pub fn tear(&mut self, x: &[f64]) -> usize {
        let Some(limit) = self.tear else { return 0 };
        let n = self.particles();
        let breaks = |i: usize, j: usize, rest_length: f64| {
            let d = |axis: usize| x[axis * n + i] - x[axis * n + j];
            let squared = d(0) * d(0) + d(1) * d(1) + d(2) * d(2);
            let most = limit * rest_length;
            most > 0.0 && squared > most * most
        };
        let spring_breaks = |s: &Spring| breaks(s.i, s.j, s.law.rest_length);
        let strips = || self.strips.iter().map(Strip::straight);
        if !self.springs().chain(strips()).any(|s| spring_breaks(&s)) {
            return 0;
        }
        // Families of one law have no holes.
        let mut springs: Vec<Spring> = self.springs().collect();
        if self.sheet.take().is_some() {
            springs.sort_by_key(|s| ends(s.i, s.j));
        }
        let before = Held::by(&springs);
        let already = self.torn.len();
        let torn = &mut self.torn;
        let mut keep = |i: usize, j: usize, holds: bool| {
            if !holds {
                torn.push(ends(i, j));
            }
            holds
        };
        springs.retain(|s| keep(s.i, s.j, !spring_breaks(s)));
        let after = Held::by(&springs);
        let cut = |i: usize, j: usize| before.share(i, j) && !after.share(i, j);
        springs.retain(|s| keep(s.i, s.j, s.kind != SpringKind::Bend || !cut(s.i, s.j)));
        self.strips.retain(|strip| {
            let s = strip.straight();
            keep(s.i, s.j, !spring_breaks(&s) && !cut(s.i, s.j))
        });
        self.list = springs;
        self.torn.sort_unstable();
        self.leave_out_holes();
        self.torn.len() - already
    }
}

fn ends(i: usize, j: usize) -> [usize; 2] {
    [i.min(j), i.max(j)]
}

/// Who is held to whom by structural springs, both ways, in order.
struct Held(Vec<[usize; 2]>);

impl Held {
    fn by(springs: &[Spring]) -> Self {
        let structural = springs.iter().filter(|s| s.kind == SpringKind::Structural);
        let mut pairs: Vec<_> = structural.flat_map(|s| [[s.i, s.j], [s.j, s.i]]).collect();
        pairs.sort_unstable();
        Self(pairs)
    }

    /// Whether a particle is held to both i and j.
    fn share(&self, i: usize, j: usize) -> bool {
        let first = self.0.partition_point(|pair| pair[0] < i);
        let mut of_i = self.0[first..].iter().take_while(|pair| pair[0] == i);
        of_i.any(|[_, m]| self.0.binary_search(&[*m, j]).is_ok())
    }
}
