//! What is recorded of the last seconds, in rows: samples of a run, values of what is picked, and
//! states of all runs.

use std::collections::VecDeque;

/// What was recorded at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<T> {
    /// Simulated time (s).
    pub time: f64,
    pub values: T,
}

/// Rows in the order of their times.
pub type Rows<T> = VecDeque<Row<T>>;

/// Drops the rows after a time (s), because time may go back.
pub fn forget_after<T>(rows: &mut Rows<T>, time: f64) {
    let others = rows.partition_point(|row| row.time <= time);
    rows.truncate(others);
}

/// Returns the row nearest to a time (s).
pub fn nearest<T>(rows: &Rows<T>, time: f64) -> Option<&Row<T>> {
    let k = rows.partition_point(|row| row.time < time);
    let near = [k.checked_sub(1), Some(k)].into_iter().flatten();
    let near = near.filter_map(|k| rows.get(k));
    near.min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))
}
