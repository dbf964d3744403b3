//! Hermite interpolation: polynomials through values and derivatives at several times (Stoer,
//! Bulirsch, *Introduction to Numerical Analysis*, 2002, 2.1.5).

/// Returns the weights of the values and derivatives at the nodes in the value of their
/// interpolation polynomial at `at`: of node 0 the value, the first derivative, ..., then of node 1
/// and so on.
///
/// With `count` data at each of m nodes the polynomial has the degree m `count` - 1.
pub(super) fn weights(nodes: &[f64], count: usize, at: f64) -> Vec<f64> {
    // Each node is repeated as often as it has data.
    let z: Vec<_> = (0..nodes.len() * count).map(|k| nodes[k / count]).collect();
    let weight = |datum: usize| {
        let (node, derivative) = (datum / count, datum % count);
        let value = |k: usize, order: usize| {
            let is_it = k / count == node && order == derivative;
            f64::from(u8::from(is_it)) / (1..=order).product::<usize>() as f64
        };
        // Divided differences of data that are all 0, except this one, which is 1.
        let mut differences: Vec<_> = (0..z.len()).map(|k| value(k, 0)).collect();
        let mut sum = differences[0];
        let mut product = 1.0;
        for order in 1..z.len() {
            for k in 0..z.len() - order {
                let width = z[k + order] - z[k];
                differences[k] = if width == 0.0 {
                    value(k, order)
                } else {
                    (differences[k + 1] - differences[k]) / width
                };
            }
            product *= at - z[order - 1];
            sum += product * differences[0];
        }
        sum
    };
    (0..z.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial of the highest degree that the data determine is reproduced exactly.
    #[test]
    fn polynomials_are_reproduced() {
        let nodes = [-1.0, 0.25, 1.5];
        for count in 1..=3 {
            let degree = 3 * count as i32 - 1;
            let value = |t: f64| (0..=degree).map(|p| (t - 0.3).powi(p)).sum::<f64>();
            let slope = |t: f64| {
                let terms = (1..=degree).map(|p| f64::from(p) * (t - 0.3).powi(p - 1));
                terms.sum::<f64>()
            };
            let bend = |t: f64| {
                let terms = (2..=degree).map(|p| f64::from(p * (p - 1)) * (t - 0.3).powi(p - 2));
                terms.sum::<f64>()
            };
            for at in [-1.0, -0.4, 0.9, 1.5] {
                let data = nodes.iter().flat_map(|&t| {
                    let all = [value(t), slope(t), bend(t)];
                    all.into_iter().take(count)
                });
                let found: f64 =
                    weights(&nodes, count, at).iter().zip(data).map(|(w, d)| w * d).sum();
                assert!(
                    (found - value(at)).abs() < 1e-12 * value(at).abs().max(1.0),
                    "{count} {at}"
                );
            }
        }
    }
}
