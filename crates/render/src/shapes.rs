//! The sphere that every ball is an instance of.

/// Corners and triangles of a unit sphere in `rings` bands of latitude.
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
