//! Sparse Cholesky factorisations A = L LT of symmetric matrices of blocks. The order of
//! elimination and the pattern of L are found once; after that, any matrix of that pattern is
//! factorised column by column, each from the columns to its left that share a row with it (George,
//! Liu, *Computer Solution of Large Sparse Positive Definite Systems*, 1981). Results have the same
//! bits on every processor: multiplications and additions are fused, and sums have a fixed order.

mod factor;
mod pattern;

pub(crate) use factor::{Block, Factor};
pub(crate) use pattern::{BlockPlace, Pattern, neighbours, order};

#[cfg(test)]
mod tests;
