//! Factorisations of random matrices of blocks.

use super::*;
use crate::random::SplitMix;

/// Draws a random number from 0 to n - 1.
fn below(n: usize, random: &mut SplitMix) -> usize {
    random.between(0.0, n as f64) as usize
}

/// Draws a random diagonally dominant matrix with blocks at some pairs, by rows.
fn matrix<const B: usize>(n: usize, pairs: &[[u32; 2]], random: &mut SplitMix) -> Vec<Vec<f64>> {
    let dim = B * n;
    let mut a = vec![vec![0.0; dim]; dim];
    for &[i, j] in pairs {
        for r in 0..B {
            for c in 0..B {
                let (row, column) = (B * i as usize + r, B * j as usize + c);
                let number = random.between(-1.0, 1.0);
                a[row][column] += number;
                a[column][row] += number;
                a[row][row] += number.abs();
                a[column][column] += number.abs();
            }
        }
    }
    for (k, row) in a.iter_mut().enumerate() {
        row[k] += 0.01;
    }
    a
}

/// Copies a matrix into a factor.
fn filled<const B: usize, const P: usize>(
    pattern: &Pattern,
    pairs: &[[u32; 2]],
    a: &[Vec<f64>],
) -> Factor<B, P> {
    let mut factor = Factor::<B, P>::new(pattern).unwrap();
    factor.clear();
    let number = |i: usize, j: usize, r: usize, c: usize| a[B * i + r][B * j + c];
    for i in 0..pattern.len() {
        let block = factor.diagonal_mut(pattern, i);
        for (c, column) in block.iter_mut().enumerate() {
            for (r, part) in column[..B].iter_mut().enumerate() {
                *part = number(i, i, r, c);
            }
        }
    }
    for &[i, j] in pairs {
        let place = pattern.place(i, j);
        let (row, column) = if place.transposed { (j, i) } else { (i, j) };
        let block = factor.block_mut(place);
        for (c, part) in block.iter_mut().enumerate() {
            for (r, part) in part[..B].iter_mut().enumerate() {
                *part = number(row as usize, column as usize, r, c);
            }
        }
    }
    factor
}

/// Returns the largest residual of the solution for a random right-hand side; `None` if a matrix is
/// not positive definite.
fn residual<const B: usize, const P: usize>(
    n: usize,
    pairs: &[[u32; 2]],
    shift: f64,
    random: &mut SplitMix,
) -> Option<f64> {
    let mut a = matrix::<B>(n, pairs, random);
    for (k, row) in a.iter_mut().enumerate() {
        row[k] -= shift;
    }
    let pattern = Pattern::new(n, pairs.iter().copied(), usize::MAX).unwrap();
    let mut factor = filled::<B, P>(&pattern, pairs, &a);
    if !factor.factorise(&pattern) {
        return None;
    }
    let b: Vec<f64> = (0..B * n).map(|_| random.between(-1.0, 1.0)).collect();
    for i in 0..n {
        factor.unknowns_mut(&pattern, i)[..B].copy_from_slice(&b[B * i..B * (i + 1)]);
    }
    factor.solve(&pattern);
    let mut x = vec![];
    for i in 0..n {
        x.extend_from_slice(&factor.unknowns_mut(&pattern, i)[..B]);
    }
    let product = |row: &Vec<f64>| row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
    let errors = a.iter().zip(&b).map(|(row, b)| (product(row) - b).abs());
    Some(errors.fold(0.0, f64::max))
}

fn grid(side: u32) -> Vec<[u32; 2]> {
    let mut pairs = vec![];
    for i in 0..side * side {
        for (down, right) in [(0, 1), (1, 0), (1, 1), (0, 2), (2, 0)] {
            if i % side + right < side && i / side + down < side {
                pairs.push([i, i + down * side + right]);
            }
        }
        if i % side > 0 && i / side + 1 < side {
            pairs.push([i + side - 1, i]);
        }
    }
    pairs
}

#[test]
fn random_matrices_are_solved() {
    let mut random = SplitMix(11);
    for k in 0..60 {
        // Some have a row that is linked to all others, and is ordered last.
        let hub = k % 6 == 5;
        let n = if hub { 60 } else { 1 + below(40, &mut random) };
        let links = below(3 * n, &mut random);
        let mut pairs: Vec<[u32; 2]> = vec![];
        if hub {
            pairs.extend((1..n as u32).map(|i| [0, i]));
        }
        for _ in 0..links {
            let mut end = || below(n, &mut random) as u32;
            let [i, j] = [end(), end()];
            if i != j && !pairs.contains(&[i, j]) && !pairs.contains(&[j, i]) {
                pairs.push([i, j]);
            }
        }
        let numbers = residual::<1, 1>(n, &pairs, 0.0, &mut random).unwrap();
        let blocks = residual::<3, 4>(n, &pairs, 0.0, &mut random).unwrap();
        assert!(numbers < 1e-10 && blocks < 1e-10, "{k}: {numbers:e} {blocks:e}");
    }
}

#[test]
fn vectors_of_any_length_give_the_same_bits() {
    let (mut random, pairs) = (SplitMix(9), grid(8));
    let a = matrix::<3>(64, &pairs, &mut random);
    let pattern = Pattern::new(64, pairs.iter().copied(), usize::MAX).unwrap();
    let mut by_vectors = filled::<3, 4>(&pattern, &pairs, &a);
    let mut by_numbers = filled::<3, 4>(&pattern, &pairs, &a);
    assert!(by_vectors.factorise(&pattern) && by_numbers.factorise_by_numbers(&pattern));
    assert!(by_vectors.blocks == by_numbers.blocks && by_vectors.diagonal == by_numbers.diagonal);
}

#[test]
fn what_is_not_positive_definite_is_noticed() {
    let mut random = SplitMix(5);
    let pairs = grid(6);
    for shift in [0.0, 100.0, f64::NAN] {
        let solved = residual::<3, 4>(36, &pairs, shift, &mut random);
        assert_eq!(solved.is_some(), shift == 0.0);
    }
    // Also if only the last number fails.
    assert!(residual::<1, 1>(1, &[], 1.0, &mut random).is_none());
}

/// Returns the number of products by an exact minimum degree order, pair by pair.
fn least_degree(n: usize, pairs: &[[u32; 2]]) -> f64 {
    let mut meets = vec![std::collections::BTreeSet::new(); n];
    for &[i, j] in pairs {
        meets[i as usize].insert(j);
        meets[j as usize].insert(i);
    }
    let (mut left, mut products): (Vec<usize>, f64) = ((0..n).collect(), 0.0);
    while let Some(place) = (0..left.len()).min_by_key(|k| meets[left[*k]].len()) {
        let i = left.swap_remove(place);
        let others = std::mem::take(&mut meets[i]);
        let m = others.len() as f64;
        products += 0.5 * m * (m + 3.0);
        for j in &others {
            meets[*j as usize].remove(&(i as u32));
            meets[*j as usize].extend(others.iter().filter(|k| *k != j));
        }
    }
    products
}

#[test]
fn factors_are_about_as_sparse_as_by_exact_minimum_degree() {
    let chain: Vec<_> = (1..200).map(|i| [i - 1, i]).collect();
    let star: Vec<_> = (1..200).map(|i| [i, 0]).collect();
    for tree in [chain, star] {
        assert_eq!(Pattern::new(200, tree.into_iter(), 199).unwrap().size(), 199);
    }
    let mut random = SplitMix(3);
    let mut thicket = |n: u32| -> Vec<[u32; 2]> {
        let link = |i: u32, random: &mut SplitMix| [i, below(i as usize, random) as u32];
        (0..2 * n).map(|k| link(1 + k % (n - 1), &mut random)).collect()
    };
    let sides = if cfg!(miri) { [4, 5] } else { [20, 30] };
    let nets = sides.map(|side| (side * side, grid(side)));
    for (n, pairs) in nets.into_iter().chain([(150, thicket(150)), (60, thicket(60))]) {
        let exact = least_degree(n as usize, &pairs);
        let pattern = Pattern::new(n as usize, pairs.iter().copied(), usize::MAX).unwrap();
        let found = pattern.products();
        println!("{n}: {found} products, {exact} by exact degrees");
        assert!(found < 1.15 * exact);
        // A factor that is too large is refused before its pattern is computed, by its exact size.
        let limited = |most| Pattern::new(n as usize, pairs.iter().copied(), most);
        assert!(limited(pattern.size()).is_some() && limited(pattern.size() - 1).is_none());
    }
}
