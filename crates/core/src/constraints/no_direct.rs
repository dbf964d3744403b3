//! In place of `direct`, without the feature `sparse`: all rows are solved by conjugate residuals.

use std::convert::Infallible;
use std::sync::Arc;

use nalgebra::Vector3;

use super::row::Row;

/// What no factorisation asks for.
#[derive(Debug)]
pub(super) struct Pattern;

impl Pattern {
    pub fn new(_: &[[usize; 4]], _: usize) -> Self {
        Self
    }
}

/// A factorisation that there never is.
pub(super) struct Factor {
    never: Infallible,
}

impl Factor {
    pub fn new(_: &Arc<Pattern>) -> Option<Self> {
        None
    }

    pub fn is_of(&self, _: &Arc<Pattern>) -> bool {
        match self.never {}
    }

    pub fn factorise(&mut self, _: &[Row], _: &[Vector3<f64>]) -> bool {
        match self.never {}
    }

    pub fn solve(&mut self, _: &mut [Row]) {
        match self.never {}
    }
}
