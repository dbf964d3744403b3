//! Numbers of cells along the axes of a grid.

/// Returns a grid with cells of the same shape, about `factor` times shorter. A grid is given by
/// its numbers of particles.
pub fn finer<const N: usize>(grid: [usize; N], factor: f64) -> [usize; N] {
    let cells = grid.map(|n| n.max(2) - 1);
    let parts = cells.into_iter().fold(0, gcd);
    cells.map(|n| n / parts * divided(parts, factor) + 1)
}

/// Returns the number of cells about `factor` times shorter in the place of `cells`, at least 1.
pub fn divided(cells: usize, factor: f64) -> usize {
    ((cells as f64 * factor).round() as usize).max(1)
}

/// Returns the greatest common divisor.
pub fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
