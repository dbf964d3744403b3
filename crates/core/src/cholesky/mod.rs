//! Sparse Cholesky factorisations A = L LT of symmetric matrices of blocks. The order of
//! elimination and the pattern of L are found once; after that, any matrix of that pattern is
//! factorised column by column, each from those to its left that meet it (George, Liu, *Computer
//! Solution of Large Sparse Positive Definite Systems*, 1981). The same bits on every processor:
//! multiplications and additions are fused, and the sums have one order.

mod factor;
mod order;
mod pattern;

pub(crate) use factor::{Block, Factor};
pub(crate) use pattern::{Pattern, Place};

#[cfg(test)]
mod tests;
