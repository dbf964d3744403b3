//! States: all x, all y, all z of the positions, and then of the velocities.

use a3_core::Vector3;

use crate::description::State;
use crate::fault::Fault;

/// The state of particles at these positions (m), with these velocities (m/s).
pub(super) fn of(positions: &[Vector3<f64>], velocities: &[Vector3<f64>]) -> Vec<f64> {
    [positions, velocities]
        .into_iter()
        .flat_map(|rows| (0..3).flat_map(move |axis| rows.iter().map(move |row| row[axis])))
        .collect()
}

/// Sets a state to the one that is given. A first-order system has positions only.
pub(super) fn write(given: &State, particles: usize, state: &mut [f64]) -> Result<(), Fault> {
    let parts = [
        ("state.positions", &given.positions),
        ("state.velocities", &given.velocities),
    ];
    state[3 * particles..].fill(0.0);
    for ((key, rows), out) in parts.into_iter().zip(state.chunks_exact_mut(3 * particles)) {
        if key == "state.velocities" && rows.is_empty() {
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
