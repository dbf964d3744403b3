//! Marching squares: the outlines of a region of the plane that is symmetric about the horizontal
//! axis.

use std::collections::BTreeMap;

use crate::geometry::{Point, Rect};

/// Returns the closed outlines of the region where `inside` is true, which is on the same side of
/// each outline throughout. The region is cut off at the edges of the window, which must reach as
/// far below 0 as above. The width of the window is divided into `columns` squares.
pub fn outlines(inside: impl Fn(Point) -> bool, window: Rect, columns: usize) -> Vec<Vec<Point>> {
    let step = window.width() / columns as f64;
    // Rows of squares above the axis; there are equally many below it.
    let rows = (window.y1 / step).ceil() as usize;
    let inside = |[x, y]: Point| inside([x, y.abs()]);
    let at = |i: usize, j: usize| [window.x0 + i as f64 * step, (j as f64 - rows as f64) * step];
    let (nx, ny) = (columns + 1, 2 * rows + 1);
    let mut nodes = vec![false; nx * ny];
    // Nodes on the edge of the window count as outside, so that every outline is closed.
    for j in rows..ny - 1 {
        for i in 1..nx - 1 {
            let there = inside(at(i, j));
            nodes[j * nx + i] = there;
            nodes[(ny - 1 - j) * nx + i] = there;
        }
    }
    // For each edge where an outline enters a square, the edge where it leaves that square.
    let mut next = BTreeMap::new();
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let is_in = corners.map(|[i, j]| nodes[j * nx + i]);
            let leaves = |k: usize| is_in[k] && !is_in[(k + 1) % 4];
            let enters = |k: usize| !is_in[k] && is_in[(k + 1) % 4];
            let edge = |k: usize| {
                (corners[k].min(corners[(k + 1) % 4]), corners[k].max(corners[(k + 1) % 4]))
            };
            for k in (0..4).filter(|k| leaves(*k)) {
                if let Some(m) = (1..4).map(|back| (k + 4 - back) % 4).find(|m| enters(*m)) {
                    next.insert(edge(k), edge(m));
                }
            }
        }
    }
    // The point where the outline crosses an edge, by bisection.
    let cut = |(a, b): ([usize; 2], [usize; 2])| {
        let (mut there, mut not) = (at(a[0], a[1]), at(b[0], b[1]));
        if !nodes[a[1] * nx + a[0]] {
            (there, not) = (not, there);
        }
        for _ in 0..12 {
            let middle = [f64::midpoint(there[0], not[0]), f64::midpoint(there[1], not[1])];
            *(if inside(middle) { &mut there } else { &mut not }) = middle;
        }
        there
    };
    let mut found = vec![];
    while let Some((first, mut edge)) = next.pop_first() {
        let mut outline = vec![cut(first)];
        while edge != first {
            outline.push(cut(edge));
            match next.remove(&edge) {
                Some(following) => edge = following,
                None => break,
            }
        }
        found.push(outline);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(outline: &[Point]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        let twice: f64 = outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
        twice / 2.0
    }

    #[test]
    fn eulers_disc_has_its_area() {
        let disc = |[x, y]: Point| (1.0 + x).hypot(y) <= 1.0;
        let found = outlines(disc, Rect::new(-3.0, -2.0, 1.0, 2.0), 60);
        assert_eq!(found.len(), 1);
        let ratio = area(&found[0]).abs() / std::f64::consts::PI;
        assert!((ratio - 1.0).abs() < 0.003, "{ratio}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn a_region_outside_a_disc_is_a_frame_with_a_hole() {
        let outside = |[x, y]: Point| (1.0 - x).hypot(y) >= 1.0;
        let found = outlines(outside, Rect::new(-2.0, -3.0, 4.0, 3.0), 120);
        let areas: Vec<_> = found.iter().map(|outline| area(outline)).collect();
        assert_eq!(areas.len(), 2, "{areas:?}");
        let sum = areas.iter().sum::<f64>().abs();
        assert!((sum - (36.0 - std::f64::consts::PI)).abs() < 0.4, "{sum}");
    }

    #[test]
    fn nothing_has_no_outline() {
        assert!(outlines(|_| false, Rect::new(-1.0, -1.0, 1.0, 1.0), 20).is_empty());
    }
}
