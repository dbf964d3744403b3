//! Points that are at the same place, since files have several there where normals, textures or
//! nodes change: one for all of them.

use crate::description::Triple;

/// Distance of points that are at the same place, as a share of the mesh's longest side: what the
/// roundings of a few single-precision numbers add up to.
const SAME: f64 = 1e-6;

/// Sides of the cells in which points are sorted, in that distance: a point is near to few.
const CELL: f64 = 4.0;

/// For each point the first one that is at the same place.
pub(super) fn places(positions: &[Triple]) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let size = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let near = SAME * size.into_iter().fold(f64::MIN_POSITIVE / SAME, f64::max);
    // Where a point is among the cells: of sides 1, from 0 on.
    let scaled = |i: usize| [0, 1, 2].map(|axis| (positions[i][axis] - low[axis]) / (CELL * near));
    let cell = |i: usize| scaled(i).map(|x| x.floor() as u32);
    let mut cells: Vec<_> = (0..positions.len()).map(cell).collect();
    cells.sort_unstable();
    cells.dedup();
    let is_near = |i: usize, k: usize| {
        let apart = [0, 1, 2].map(|axis| positions[i][axis] - positions[k][axis]);
        apart.iter().map(|x| x * x).sum::<f64>() <= near * near
    };
    // Of the points in a cell, those that are the first at their place: few, as they are apart.
    let mut firsts = vec![vec![]; cells.len()];
    let mut same = Vec::with_capacity(positions.len());
    for i in 0..positions.len() {
        // The cells within reach: one or two along each axis.
        let at = scaled(i);
        let span = at.map(|x| {
            let [from, to] = [x - 1.0 / CELL, x + 1.0 / CELL].map(|x| x.max(0.0) as u32);
            from..=to
        });
        let [xs, ys, zs] = span;
        let around = xs.flat_map(|x| {
            let (ys, zs) = (ys.clone(), zs.clone());
            ys.flat_map(move |y| zs.clone().map(move |z| [x, y, z]))
        });
        let there = around.filter_map(|cell| cells.binary_search(&cell).ok());
        let known = there.flat_map(|cell| &firsts[cell]).copied();
        let first = known.filter(|k| is_near(i, *k as usize)).min();
        if let (None, Ok(own)) = (first, cells.binary_search(&cell(i))) {
            firsts[own].push(i as u32);
        }
        same.push(first.unwrap_or(i as u32));
    }
    same
}
