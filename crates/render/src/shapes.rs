//! Shapes: the sphere, whose instances are balls, and the rounded box, whose instances are other
//! solids.

/// Returns the corners and the triangles of a unit sphere in `rings` bands of latitude.
pub(crate) fn sphere(rings: u16) -> (Vec<[f32; 3]>, Vec<u16>) {
    let sectors = 2 * rings;
    let mut corners = vec![];
    for i in 0..=rings {
        let (sin, cos) = (std::f32::consts::PI * f32::from(i) / f32::from(rings)).sin_cos();
        for j in 0..=sectors {
            let (s, c) = (std::f32::consts::TAU * f32::from(j) / f32::from(sectors)).sin_cos();
            corners.push([sin * s, cos, sin * c]);
        }
    }
    let mut triangles = vec![];
    for i in 0..rings {
        for j in 0..sectors {
            let a = i * (sectors + 1) + j;
            let b = a + sectors + 1;
            triangles.extend([a, b, a + 1, a + 1, b, b + 1]);
        }
    }
    (corners, triangles)
}

/// Returns the corners and the triangles of a unit sphere that is cut along the coordinate planes,
/// so that its eight pieces can be moved apart. A corner is given by its position and its piece;
/// the latter is -1 or 1 along each axis. Each piece has `bands` bands of latitude and of
/// longitude.
pub(crate) fn rounded_box(bands: u16) -> (Vec<[[f32; 3]; 2]>, Vec<u16>) {
    // Each border occurs twice: as the end of one piece and as the beginning of the next.
    let angles = |quarters: u16| -> Vec<(f32, u16)> {
        let angle = |q, k| {
            (
                std::f32::consts::FRAC_PI_2 * (f32::from(q) + f32::from(k) / f32::from(bands)),
                q,
            )
        };
        (0..quarters)
            .flat_map(|q| (0..=bands).map(move |k| angle(q, k)))
            .collect()
    };
    let (latitudes, longitudes) = (angles(2), angles(4));
    let mut corners = vec![];
    for (theta, half) in &latitudes {
        for (phi, quarter) in &longitudes {
            let (sin, cos) = theta.sin_cos();
            let (s, c) = phi.sin_cos();
            let sign = |positive: bool| if positive { 1.0 } else { -1.0 };
            let piece = [
                sign(*quarter < 2),
                sign(*half == 0),
                sign(matches!(quarter, 0 | 3)),
            ];
            corners.push([[sin * s, cos, sin * c], piece]);
        }
    }
    let (rows, columns) = (latitudes.len() as u16, longitudes.len() as u16);
    let mut triangles = vec![];
    for i in 0..rows - 1 {
        for j in 0..columns {
            let next = (j + 1) % columns;
            let (a, b) = (i * columns, (i + 1) * columns);
            triangles.extend([a + j, b + j, a + next, a + next, b + j, b + next]);
        }
    }
    // These are the faces at the poles.
    for row in [0, (rows - 1) * columns] {
        let [a, b, c, d] = [0, 1, 2, 3].map(|quarter| row + quarter * (bands + 1));
        triangles.extend([a, b, c, a, c, d]);
    }
    (corners, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The box stays closed when its pieces are moved apart: each edge of a triangle with an area
    /// belongs to two such triangles.
    #[test]
    fn a_rounded_box_has_no_holes() {
        let (corners, triangles) = rounded_box(3);
        let key = |k: u16| {
            let [unit, piece] = corners[usize::from(k)];
            [0, 1, 2].map(|axis| ((2.0 * piece[axis] + unit[axis]) * 1e3).round() as i32)
        };
        let mut edges = std::collections::BTreeMap::new();
        for corners in triangles.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|k| key(corners[k]));
            if a == b || b == c || c == a {
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
            }
        }
        assert!(edges.len() > 100);
        assert!(edges.values().all(|count| *count == 2), "{edges:?}");
    }
}
