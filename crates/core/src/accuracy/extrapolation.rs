//! Extrapolation of runs to zero step (Richardson; Hairer, Norsett, Wanner, *Solving Ordinary
//! Differential Equations I*, 1993, II.9).

use super::snapshot::Snapshot;

/// Order of the methods that are extrapolated.
const ORDER: i32 = 4;
/// Largest number of powers of the step that are extrapolated away.
const MAX_POWERS: usize = 3;

/// Returns the next row of the extrapolation: the run with half of the step, and its combinations
/// with the row before. Each combination removes one more power of the step from the error.
pub(super) fn extrapolate(row: Vec<Vec<Snapshot>>, halved: Vec<Snapshot>) -> Vec<Vec<Snapshot>> {
    let mut next = vec![halved];
    for (power, coarse) in row.into_iter().take(MAX_POWERS).enumerate() {
        let share = 1.0 / (f64::powi(2.0, ORDER + power as i32) - 1.0);
        let pairs = coarse.iter().zip(&next[power]);
        let column = pairs.map(|(coarse, fine)| Snapshot::extrapolate(coarse, fine, share));
        next.push(column.collect());
    }
    next
}
