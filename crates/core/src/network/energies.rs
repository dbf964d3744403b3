//! The energy in a state of a network, and the forces that change it.

use super::element::Element;
use super::evaluation::at;
use super::parts::Network;
use crate::contact::Obstacle;
use crate::energy::Energy;
use crate::path::Path;
use crate::random::SplitMix;

/// Returns the energy in the state (x, v) at time t (s).
pub(super) fn energy_at(network: &Network, t: f64, x: &[f64], v: &[f64]) -> Energy {
    let of_axis = |v: &[f64]| -> f64 {
        let of_one = |(v, m): (&f64, &f64)| 0.5 * m * v * v;
        v.iter().zip(network.masses()).map(of_one).sum()
    };
    let mut energy = Energy {
        kinetic: v.chunks_exact(network.particles()).map(of_axis).sum(),
        ..Energy::default()
    };
    for element in network.elements() {
        energy += element.force().energy(&at(network, t, x, v));
    }
    energy
}

/// Returns the energy of the state y at time t (s), that of rotations included.
pub(super) fn energy_of(network: &Network, t: f64, y: &[f64]) -> Energy {
    let (x, v) = network.halves(y);
    let mut energy = energy_at(network, t, x, v);
    for (k, body) in network.bodies().iter().enumerate() {
        energy.kinetic += body.energy(&network.rotation(k, y));
    }
    energy
}

/// Returns the energy (J) that errors of all positions, of up to `error` (m), add in the state y at
/// time t (s): elastic energy, and that of the motion that corrects errors of constraints.
pub(crate) fn energy_of_errors(network: &Network, t: f64, y: &[f64], error: f64) -> f64 {
    let (mut off, mut random) = (y.to_vec(), SplitMix(1));
    for x in &mut off[..3 * network.particles()] {
        *x += random.between(-error, error);
    }
    let elastic = energy_of(network, t, &off).elastic - energy_of(network, t, y).elastic;
    let mass = network.masses().iter().sum::<f64>();
    let rate = if network.is_constrained() {
        network.constraints.baumgarte_frequency()
    } else {
        0.0
    };
    let correction = 0.5 * mass * (error * rate).powi(2);
    let all = elastic.max(0.0) + correction;
    if all.is_finite() { all } else { 0.0 }
}

/// Adds the forces of wind (N) in the state (x, v) at time t (s) to f.
pub(crate) fn add_wind(network: &Network, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
    for element in network.elements() {
        if element.force().is_wind() {
            element.force().add_forces(&at(network, t, x, v), f);
        }
    }
}

/// Returns whether motors drive bodies.
pub(crate) fn has_motors(network: &Network) -> bool {
    !network.bodies.motors().is_empty()
}

/// Returns whether the forces conserve energy: there is no damping, no wind, no motor and no
/// prescribed motion, and no spring is shortened or breaks. Contact with obstacles is left out.
pub(crate) fn is_conservative(network: &Network) -> bool {
    let loses = |element: &Element| {
        let force = element.force();
        force.is_driven() || force.reads_velocity()
    };
    let mut paths = network.all_pins().map(|pin| pin.path);
    !network.elements().iter().any(loses)
        && paths.all(|path| matches!(path, Path::Still(_)))
        && network.obstacles().iter().all(Obstacle::is_still)
        && network.strain_limits().is_empty()
        && !has_motors(network)
}
