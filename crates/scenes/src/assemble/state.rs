//! States: all x, all y, all z of the positions, and then of the velocities.

use a3_core::Vector3;
use a3_core::rigid::ROTATION;

use crate::description::State;
use crate::fault::Fault;

/// Creates the state of particles from their positions (m) and velocities (m/s).
pub(super) fn of(positions: &[Vector3<f64>], velocities: &[Vector3<f64>]) -> Vec<f64> {
    [positions, velocities]
        .into_iter()
        .flat_map(|rows| (0..3).flat_map(move |axis| rows.iter().map(move |row| row[axis])))
        .collect()
}

/// Sets a state to the given one: without positions, those of the bodies stay. A first-order system
/// has positions only.
pub(super) fn write(given: &State, particles: usize, state: &mut [f64]) -> Result<(), Fault> {
    let parts = [
        ("state.positions", &given.positions),
        ("state.velocities", &given.velocities),
    ];
    let positions = 3 * particles;
    let (halves, rotations) = state.split_at_mut(state.len().min(2 * positions));
    write_rotations(given, rotations)?;
    halves[positions..].fill(0.0);
    for ((key, rows), out) in parts.into_iter().zip(halves.chunks_exact_mut(positions)) {
        if rows.is_empty() {
            continue;
        }
        if rows.len() != particles {
            let why = format!("there are {}, but {particles} particles", rows.len());
            return Err(Fault::new(key, why));
        }
        for (i, row) in rows.iter().enumerate() {
            for axis in 0..3 {
                out[axis * particles + i] = row[axis];
            }
        }
    }
    Ok(())
}

/// Sets the rotations of rigid bodies to the given ones, if there are any.
fn write_rotations(given: &State, state: &mut [f64]) -> Result<(), Fault> {
    let bodies = state.len() / ROTATION;
    let (turned, momenta) = (&given.orientations, &given.angular_momenta);
    for (key, count) in [
        ("state.orientations", turned.len()),
        ("state.angular_momenta", momenta.len()),
    ] {
        if count != 0 && count != bodies {
            let why = format!("there are {count}, but {bodies} rigid bodies");
            return Err(Fault::new(key, why));
        }
    }
    for (k, numbers) in state.chunks_exact_mut(ROTATION).enumerate() {
        if let Some(q) = turned.get(k) {
            let squared: f64 = q.iter().map(|q| q * q).sum();
            if squared == 0.0 {
                let why = format!("that of body {k}, counted from 0, has no length");
                return Err(Fault::new("state.orientations", why));
            }
            numbers[..4].copy_from_slice(q);
        }
        if let Some(momentum) = momenta.get(k) {
            numbers[4..].copy_from_slice(momentum);
        }
    }
    Ok(())
}
