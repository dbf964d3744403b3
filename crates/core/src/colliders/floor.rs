//! A level floor.

/// Nothing goes below y = `height`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// In m.
    pub height: f64,
}

impl Floor {
    pub(crate) fn push_out(self, x: &mut [f64], v: &mut [f64]) {
        let n = x.len() / 3;
        for (y, v) in x[n..2 * n].iter_mut().zip(&mut v[n..2 * n]) {
            if *y < self.height {
                *y = self.height;
                *v = v.max(0.0);
            }
        }
    }
}
