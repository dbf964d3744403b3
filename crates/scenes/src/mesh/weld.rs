//! Welding: points at the same place become one. Files have several points at a place where
//! normals, textures or nodes change.

use crate::description::Triple;

/// Largest distance of points that count as one, relative to the mesh's longest side: the sum of a
/// few rounding errors in single precision.
const WELD_DISTANCE: f64 = 1e-6;

/// Side of the cells into which points are sorted, relative to that distance: few points are near
/// the border of a cell.
const CELL: f64 = 4.0;

/// Finds for each point the first one at the same place.
pub(super) fn places(positions: &[Triple]) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let size = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let near = WELD_DISTANCE
        * size
            .into_iter()
            .fold(f64::MIN_POSITIVE / WELD_DISTANCE, f64::max);
    // Coordinates in which the cells have sides of 1 and begin at 0.
    let scaled = |i: usize| [0, 1, 2].map(|axis| (positions[i][axis] - low[axis]) / (CELL * near));
    let cell = |i: usize| scaled(i).map(|x| x.floor() as u32);
    let mut cells: Vec<_> = (0..positions.len()).map(cell).collect();
    cells.sort_unstable();
    cells.dedup();
    let is_near = |i: usize, k: usize| {
        let apart = [0, 1, 2].map(|axis| positions[i][axis] - positions[k][axis]);
        apart.iter().map(|x| x * x).sum::<f64>() <= near * near
    };
    // The points in a cell that are the first at their place. They are few, because they are apart.
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
