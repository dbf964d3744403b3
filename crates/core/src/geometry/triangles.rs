//! Triangles of surfaces, open or closed.

use std::ops::Deref;
use std::sync::{Arc, OnceLock};

use crate::sets::Sets;

/// List of triangles, each given by its corners.
#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    all: Arc<[[u32; 3]]>,
    /// Those of open surfaces and those of closed ones, once they were asked for.
    split: OnceLock<[Arc<[[u32; 3]]>; 2]>,
}

impl Default for Triangles {
    fn default() -> Self {
        std::iter::empty().collect()
    }
}

impl FromIterator<[u32; 3]> for Triangles {
    fn from_iter<I: IntoIterator<Item = [u32; 3]>>(all: I) -> Self {
        Self { all: all.into_iter().collect(), split: OnceLock::new() }
    }
}

impl Deref for Triangles {
    type Target = [[u32; 3]];

    fn deref(&self) -> &Self::Target {
        &self.all
    }
}

impl Triangles {
    /// Returns the triangles of open surfaces and those of closed ones, each in the order of the
    /// list. Triangles with a common corner belong to the same surface. It is closed if each side
    /// is that of two triangles.
    pub fn open_and_closed(&self) -> [&[[u32; 3]]; 2] {
        let split = self.split.get_or_init(|| {
            let is_open = is_open(&self.all);
            if is_open.iter().all(|is_open| *is_open) {
                return [Arc::clone(&self.all), Arc::default()];
            }
            let of = |open: bool| {
                let all = self.all.iter().zip(&is_open);
                all.filter(|(_, is_open)| **is_open == open).map(|(corners, _)| *corners).collect()
            };
            [of(true), of(false)]
        });
        split.each_ref().map(|triangles| &**triangles)
    }
}

/// Returns whether each triangle belongs to an open surface.
fn is_open(triangles: &[[u32; 3]]) -> Vec<bool> {
    let sides = triangles.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<_> = sides.map(|[i, j]| [*i.min(j), *i.max(j)]).collect();
    sides.sort_unstable();
    let points = triangles.as_flattened().iter().max();
    let points = points.map_or(0, |last| *last as usize + 1);
    let mut surfaces = Sets::new(points);
    for [i, j] in &sides {
        surfaces.join(*i, *j);
    }
    let mut is_open = vec![false; points];
    for same in sides.chunk_by(|one, other| one == other) {
        is_open[surfaces.find(same[0][0]) as usize] |= same.len() != 2;
    }
    let of = triangles.iter().map(|[i, ..]| surfaces.find(*i));
    of.map(|surface| is_open[surface as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists the sides of a tetrahedron.
    fn tetrahedron(first: u32) -> [[u32; 3]; 4] {
        [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]].map(|corners| corners.map(|i| first + i))
    }

    #[test]
    fn a_surface_is_closed_while_no_triangle_is_missing() {
        let (whole, rest) = (tetrahedron(0), &tetrahedron(4)[1..]);
        let sheet = [[8, 9, 10], [9, 11, 10]];
        let all: Triangles = rest.iter().copied().chain(whole).chain(sheet).collect();
        let [open, closed] = all.open_and_closed();
        assert_eq!(closed, whole);
        assert_eq!(open, [rest, &sheet].concat());
        // A fin on an edge opens the surface.
        let finned: Triangles = whole.into_iter().chain([[0, 1, 9]]).collect();
        let [open, closed] = finned.open_and_closed();
        assert_eq!((open.len(), closed.len()), (5, 0));
        let none = Triangles::default();
        assert_eq!(none.open_and_closed(), [&[] as &[[u32; 3]]; 2]);
    }
}
