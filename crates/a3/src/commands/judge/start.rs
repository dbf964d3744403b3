//! The first state of a file against the start of the scene.

use a3_core::Scene;

use super::rows::{Rows, distance, farthest};

/// Largest distance of a particle that is in its place, over the size of the scene.
const TOLERANCE: f64 = 1e-9;
/// Units in which programs give lengths, and how many of them are a metre.
const UNITS: [(&str, f64); 3] = [("mm", 1000.0), ("cm", 100.0), ("inches", 1.0 / 0.0254)];
/// Largest number of particles whose order is compared.
const MAX_SORTED: usize = 20_000;

/// Difference of a first state from the start of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The first row is not at time 0 (s).
    Later(f64),
    /// The positions are those of the scene in another order.
    Order,
    /// The positions are those of the scene in another unit.
    Unit(&'static str),
    /// The axes y and z are exchanged, at all times.
    Axes,
    /// Number of particles that are elsewhere, and the farthest of them with its distance (m).
    Positions(usize, (usize, f64)),
    /// The particle whose velocity differs most, and the difference (m/s).
    Velocities(usize, f64),
}

/// Compares the first row with the start of the scene. `None` if they agree.
pub fn difference(scene: &Scene, rows: &Rows) -> Option<Difference> {
    if rows.begin() > 0.0 {
        return Some(Difference::Later(rows.begin()));
    }
    let n = scene.model.particles();
    let (start, own) = (&scene.state[..3 * n], rows.positions(0));
    let near = TOLERANCE * scene.extent().1 + 2.0 * rows.rounding(0);
    let far = farthest(start, own);
    if far.1 > near {
        return Some(if is_order(start, own, near) {
            Difference::Order
        } else if let Some(unit) = unit(start, own, near) {
            Difference::Unit(unit)
        } else {
            let away = |i: &usize| {
                let squares = (0..3).map(|axis| (start[axis * n + i] - own[axis * n + i]).powi(2));
                squares.sum::<f64>().sqrt() > near
            };
            Difference::Positions((0..n).filter(away).count(), far)
        });
    }
    let has_velocities = scene.model.network().is_some();
    let velocities = rows.velocities(0).filter(|_| has_velocities)?;
    let given = &scene.state[3 * n..6 * n];
    let (i, far) = farthest(given, velocities);
    let largest = given
        .iter()
        .chain(velocities)
        .fold(1.0, |most: f64, v| most.max(v.abs()));
    (far > 1e-6 * largest + 2.0 * rows.rounding(0)).then_some(Difference::Velocities(i, far))
}

/// Returns whether the positions are those of the scene in another order.
fn is_order(start: &[f64], own: &[f64], near: f64) -> bool {
    let n = start.len() / 3;
    if n > MAX_SORTED {
        return false;
    }
    let unit = near.max(f64::MIN_POSITIVE);
    let sorted = |x: &[f64]| {
        // No key is -0.
        let key = |value: f64| (value / (4.0 * unit)).round() + 0.0;
        let mut all: Vec<_> = (0..n)
            .map(|i| [key(x[i]), key(x[n + i]), key(x[2 * n + i])])
            .collect();
        all.sort_by(|a, b| {
            let [x, y, z] = std::array::from_fn(|axis| a[axis].total_cmp(&b[axis]));
            x.then(y).then(z)
        });
        all
    };
    let pairs = sorted(start).into_iter().zip(sorted(own));
    pairs
        .flat_map(|(a, b)| a.into_iter().zip(b))
        .all(|(a, b)| (a - b).abs() <= 1.0)
}

/// Returns the unit in which positions are those of the scene.
fn unit(start: &[f64], own: &[f64], near: f64) -> Option<&'static str> {
    let in_unit = |(_, per_metre): &(&str, f64)| {
        let scaled: Vec<_> = own.iter().map(|x| x / per_metre).collect();
        distance(start, &scaled) <= near
    };
    let largest = start.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let found = UNITS
        .into_iter()
        .find(|unit| largest > 0.0 && in_unit(unit));
    found.map(|(name, _)| name)
}

/// Returns the positions whose axis z, which is up, becomes y; `sign` tells where y points.
pub fn with_y_up(x: &[f64], sign: f64) -> Vec<f64> {
    let n = x.len() / 3;
    let depth = x[n..2 * n].iter().map(|y| sign * y);
    x[..n]
        .iter()
        .chain(&x[2 * n..])
        .copied()
        .chain(depth)
        .collect()
}
