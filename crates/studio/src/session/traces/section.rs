//! Poincaré sections: the rows of a series at which a variable passes a value upwards, or a period
//! ends, by cubic interpolation.

use std::f64::consts::TAU;

use super::variable::{Kind, Row, Variable};

/// Number of halvings that find a crossing within an interval: as many as a double has bits.
const HALVINGS: u32 = 53;

/// When a point of a section is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Trigger {
    /// Never.
    #[default]
    Off,
    /// Whenever a variable passes a value upwards; an angle, also any number of turns from it.
    Rises(Variable, f64),
    /// Once in each period (s), at its multiples.
    Period(f64),
}

impl Trigger {
    /// Returns the trigger for things of a kind: none if they lack its variable.
    pub fn of(self, kind: Kind) -> Self {
        match self {
            Self::Rises(variable, _) if !variable.is_of(kind) => Self::Off,
            trigger => trigger,
        }
    }

    /// Returns the row at which the trigger acts in the interval from row k to the next, if it
    /// does. The polynomial through all rows interpolates.
    pub fn within(self, rows: &[Row], k: usize) -> Option<Row> {
        let [a, b] = [rows.get(k)?, rows.get(k + 1)?];
        let at = |time: f64| interpolate(rows, time);
        match self {
            Self::Off => None,
            Self::Period(period) => {
                let time = (b.time / period).floor() * period;
                (time > a.time).then(|| at(time))
            }
            Self::Rises(variable, value) => {
                let value = if variable == Variable::Angle {
                    value + TAU * ((variable.of(b) - value) / TAU).floor()
                } else {
                    value
                };
                if !(variable.of(a) < value && variable.of(b) >= value) {
                    return None;
                }
                let [mut low, mut high] = [a.time, b.time];
                for _ in 0..HALVINGS {
                    let middle = f64::midpoint(low, high);
                    if variable.of(&at(middle)) < value {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                Some(at(high))
            }
        }
    }
}

/// Returns the row at a time (s) on the polynomial through rows (Lagrange).
pub fn interpolate(rows: &[Row], time: f64) -> Row {
    let mut values = [0.0; _];
    for (k, row) in rows.iter().enumerate() {
        let others = rows.iter().enumerate().filter(|(j, _)| *j != k);
        let weight: f64 = others
            .map(|(_, other)| (time - other.time) / (row.time - other.time))
            .product();
        for (sum, value) in values.iter_mut().zip(row.values) {
            *sum += weight * value;
        }
    }
    Row { time, values }
}
