//! In place of `sparse`, without the feature of that name: no matrix has a sparse factorisation.

use std::convert::Infallible;

use super::tangent::Tangent;

/// A factorisation that there never is.
pub(crate) struct Cholesky {
    never: Infallible,
    pub operations: f64,
    pub size: f64,
}

impl Cholesky {
    pub fn new(_: &Tangent) -> Option<Self> {
        None
    }

    pub fn factorise(&mut self, _: &Tangent) -> bool {
        match self.never {}
    }

    pub fn solve(&mut self, _: &[f64], _: &mut [f64]) {
        match self.never {}
    }
}
