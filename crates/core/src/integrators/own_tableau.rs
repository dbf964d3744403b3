//! Tableaux of own explicit Runge-Kutta methods: their checks, and their orders by the conditions
//! of rooted trees (Butcher, *Coefficients for the study of Runge-Kutta integration processes*,
//! 1963; Hairer, Norsett, Wanner, *Solving Ordinary Differential Equations I*, 1993, II.2).
//!
//! The method has order p if each rooted tree of up to p nodes, t = [t1, ..., tm], has
//!
//! ```text
//! sum b_i u_i(t) = 1 / g(t),
//! u_i(t) = product over k of sum a_ij u_j(tk),    g(t) = |t| product over k of g(tk).
//! ```

use super::embedded::Tableau;
use crate::error::Error;

/// Largest order that is looked for: there are 719 trees of ten nodes.
const MAX_ORDER: usize = 10;
/// Error of a condition up to which it counts as met: published tables have 10 digits or more.
const TOLERANCE: f64 = 1e-9;

/// Rooted tree, as far as a method sees it.
struct RootedTree {
    /// Number of its nodes.
    nodes: usize,
    /// `sum a_ij u_j` for each stage i.
    above: Vec<f64>,
    /// 1 / g.
    share: f64,
}

/// Returns the tableau of these weights, which lives as long as the program, and its order. For
/// each stage, `within` has the weights of the powers of theta, from the first on, in the
/// polynomial within a step.
///
/// # Errors
/// The tableau has a wrong shape, is implicit, has numbers that are not finite, or weights that do
/// not sum to 1, both results are the same, or the polynomial does not end at the result.
pub(super) fn tableau_of(
    a: &[Vec<f64>],
    b: &[f64],
    estimate: Option<&[f64]>,
    within: &[Vec<f64>],
) -> Result<(Tableau, u32), Error> {
    let rows = explicit_rows(a, b, estimate)?;
    let order = known_order("b", &rows, b)?;
    let (mut errors, mut least) = (vec![], order);
    if let Some(other) = estimate {
        let mut ended = rows.clone();
        if other.len() == b.len() + 1 {
            ended.push(b.to_vec());
        }
        if other.len() != ended.len() {
            return wrong(format!(
                "b_hat has as many weights as b, {}, or one more, not {}",
                b.len(),
                other.len()
            ));
        }
        least = order.min(known_order("b_hat", &ended, other)?);
        let own = b.iter().copied().chain([0.0]);
        let difference: Vec<_> = own.zip(other).map(|(own, other)| own - other).collect();
        if difference.iter().all(|it| *it == 0.0) {
            return wrong("b_hat is b: their difference estimates no error".into());
        }
        errors.push(leaked(difference));
    }
    let stages = rows.into_iter().skip(1);
    let stages: Vec<_> = stages.map(|row| (row.iter().sum(), leaked(row))).collect();
    let tableau = Tableau {
        stages: stages.leak(),
        weights: leaked(b.to_vec()),
        errors: errors.leak(),
        exponent: f64::from(least) + 1.0,
        extra: &[],
        dense: &[],
        powers: powers_of(within, b)?,
    };
    Ok((tableau, order))
}

/// Returns the weights of all stages for each power of theta; none if there is no polynomial.
fn powers_of(within: &[Vec<f64>], b: &[f64]) -> Result<&'static [&'static [f64]], Error> {
    let powers = within.first().map_or(0, Vec::len);
    if within.is_empty() {
        return Ok(&[]);
    }
    if ![b.len(), b.len() + 1].contains(&within.len()) || within.iter().any(|p| p.len() != powers) {
        return wrong(format!(
            "P has as many rows as b has weights, {}, or one more, all of one length",
            b.len()
        ));
    }
    for (i, (row, weight)) in within.iter().zip(b.iter().chain([&0.0])).enumerate() {
        let sum: f64 = row.iter().sum();
        // NaN is no sum.
        if (sum - weight).abs().is_nan() || (sum - weight).abs() > TOLERANCE {
            return wrong(format!(
                "row {i} of P sums to {sum}, where {weight} is expected: the weight in b, or 0 beyond it"
            ));
        }
    }
    let columns = (0..powers).map(|j| leaked(within.iter().map(|row| row[j]).collect()));
    Ok(columns.collect::<Vec<_>>().leak())
}

fn leaked(numbers: Vec<f64>) -> &'static [f64] {
    numbers.leak()
}

fn wrong<T>(why: String) -> Result<T, Error> {
    Err(Error::Invalid(why))
}

/// Returns the rows of A below its diagonal.
fn explicit_rows(
    a: &[Vec<f64>],
    b: &[f64],
    estimate: Option<&[f64]>,
) -> Result<Vec<Vec<f64>>, Error> {
    if a.len() != b.len() || b.is_empty() {
        let (rows, weights) = (a.len(), b.len());
        return wrong(format!(
            "a tableau has a row of A for each weight of b, not {rows} for {weights}"
        ));
    }
    let numbers = a.iter().flatten().chain(b).chain(estimate.unwrap_or(&[]));
    if let Some(number) = numbers.into_iter().find(|number| !number.is_finite()) {
        return wrong(format!("a tableau has finite numbers, not {number}"));
    }
    let mut rows = a.to_vec();
    for (i, row) in rows.iter_mut().enumerate() {
        if let Some(j) = (i..row.len()).find(|j| row[*j] != 0.0) {
            return wrong(format!(
                "stage {i} of the tableau depends on stage {j}: A of an explicit method is 0 from its diagonal on"
            ));
        }
        row.resize(i, 0.0);
    }
    Ok(rows)
}

/// Returns the order of a method, which is at least 1.
fn known_order(what: &str, rows: &[Vec<f64>], weights: &[f64]) -> Result<u32, Error> {
    match order_of(rows, weights) {
        0 => wrong(format!(
            "the weights {what} of a tableau sum to 1, not to {}",
            weights.iter().sum::<f64>()
        )),
        order => Ok(order),
    }
}

/// Returns the order of the method with these stages: of each one, its weights of those before it.
/// 0 if the weights b do not sum to 1.
fn order_of(stages: &[Vec<f64>], b: &[f64]) -> u32 {
    let mut trees: Vec<RootedTree> = vec![];
    for nodes in 1..=MAX_ORDER {
        let known = trees.len();
        let root = (vec![1.0; b.len()], 1.0 / nodes as f64);
        let mut found = vec![];
        grow(&trees, nodes - 1, known, root, &mut found);
        for (u, share) in found {
            let sum: f64 = b.iter().zip(&u).map(|(b, u)| b * u).sum();
            if (sum - share).abs() > TOLERANCE {
                return nodes as u32 - 1;
            }
            let sums = |row: &Vec<f64>| row.iter().zip(&u).map(|(a, u)| a * u).sum();
            let above = stages.iter().map(sums).collect();
            trees.push(RootedTree { nodes, above, share });
        }
    }
    MAX_ORDER as u32
}

/// Adds to `found` the trees that complete a root with `left` further nodes: those of subtrees
/// among the first `known` trees, listed from the last to the first, so that each set is found
/// once.
fn grow(
    trees: &[RootedTree],
    left: usize,
    known: usize,
    (u, share): (Vec<f64>, f64),
    found: &mut Vec<(Vec<f64>, f64)>,
) {
    if left == 0 {
        return found.push((u, share));
    }
    for (k, tree) in trees[..known].iter().enumerate() {
        if tree.nodes <= left {
            let u = u.iter().zip(&tree.above).map(|(u, above)| u * above);
            let grown = (u.collect(), share * tree.share);
            grow(trees, left - tree.nodes, k + 1, grown, found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::method::Create;
    use super::super::table::METHODS;
    use super::*;

    /// Euler's method, the midpoint rule, the classical method, wrong weights, and the pairs of the
    /// table of methods.
    #[test]
    fn known_methods_have_their_orders() {
        let classical = [vec![], vec![0.5], vec![0.0, 0.5], vec![0.0, 0.0, 1.0]];
        let weights = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
        assert_eq!(order_of(&classical[..1], &[1.0]), 1);
        assert_eq!(order_of(&classical[..2], &[0.0, 1.0]), 2);
        assert_eq!(order_of(&classical, &weights), 4);
        assert_eq!(order_of(&classical, &[0.25; 4]), 2);
        assert_eq!(order_of(&classical, &[0.3; 4]), 0);
        let mut pairs = 0;
        for method in METHODS {
            let Create::Embedded(Tableau { stages, weights, .. }) = method.create else {
                continue;
            };
            let rows = stages.iter().map(|(_, row)| row.to_vec());
            let rows: Vec<_> = std::iter::once(vec![]).chain(rows).collect();
            assert_eq!(order_of(&rows, weights), method.order, "{}", method.name);
            pairs += 1;
        }
        assert!(pairs > 2);
    }
}
