//! Backward differences `D_1`, `D_2`, ... of the states at the ends of equal steps, and their
//! change with the step on the same polynomial.

/// Largest number of differences.
pub(super) const MAX_ORDER: usize = 5;

/// Changes `k` to the differences of states `ratio` times as far apart, on the same polynomial.
pub(super) fn rescale(k: &mut [Vec<f64>], ratio: f64) {
    let order = k.len();
    // The polynomial through the ends is y0 + sum s (s + 1) ... (s + j - 1) / j! D_j: the new
    // differences are sums of the old ones, with a product of two triangular matrices as weights.
    let of_ratio = |i: usize, j: usize, ratio: f64| -> f64 {
        (1..=i)
            .map(|m| (m as f64 - 1.0 - ratio * j as f64) / m as f64)
            .product()
    };
    let mut old = [0.0; MAX_ORDER];
    let mut weights = [[0.0; MAX_ORDER]; MAX_ORDER];
    for (i, row) in weights[..order].iter_mut().enumerate() {
        for (j, weight) in row[..order].iter_mut().enumerate() {
            *weight = (1..=order)
                .map(|m| of_ratio(j + 1, m, ratio) * of_ratio(m, i + 1, 1.0))
                .sum();
        }
    }
    for number in 0..k.first().map_or(0, Vec::len) {
        for (old, d) in old.iter_mut().zip(&*k) {
            *old = d[number];
        }
        for (d, weights) in k.iter_mut().zip(&weights[..order]) {
            let terms = weights[..order].iter().zip(&old);
            d[number] = terms.map(|(weight, old)| weight * old).sum();
        }
    }
}
