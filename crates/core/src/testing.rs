//! Networks for the unit tests. These cannot use the built-in scenes, which belong to a crate that
//! depends on this one.

use crate::random::SplitMix;
use crate::{Grid, Mechanics, Model, Network, Path, Scene, Sheet, Vector3};

/// Creates a hanging cloth in motion, its particles slightly displaced, its upper corners pinned.
/// `damping_time` is the damping of each spring over its stiffness (s).
pub(crate) fn cloth(grid: Grid, damping_time: f64) -> Scene {
    const SPACING: f64 = 0.2;
    let (n, cols) = (grid.particles(), grid.cols());
    let mut random = SplitMix(11);
    let mut state = vec![0.0; 6 * n];
    for k in 0..n {
        state[k] = SPACING * (k % cols) as f64;
        state[n + k] = -SPACING * (k / cols) as f64;
    }
    for (k, y) in state.iter_mut().enumerate() {
        let size = if k < 3 * n { 0.1 * SPACING } else { 1.0 };
        *y += size * random.between(-1.0, 1.0);
    }
    let mut network = Network::new(vec![0.02; n]).unwrap();
    let sheet = Sheet::new(grid, SPACING, [50.0, 25.0, 12.5], damping_time).unwrap();
    network.add(sheet).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(0.006).unwrap();
    for corner in [0, cols - 1] {
        let [x, y, z] = [0, n, 2 * n].map(|axis| state[axis + corner]);
        network.pin(corner, Path::Still(Vector3::new(x, y, z))).unwrap();
        for axis in 3..6 {
            state[axis * n + corner] = 0.0;
        }
    }
    Scene::new("cloth", Model::Network(Box::new(network)), state)
}

/// Returns the largest relative error of the momenta after a step of implicit Euler from y to `end`
/// in h (s): of M (v1 - v) = h F(t + h, x1, v1).
pub(crate) fn residual(network: &Network, h: f64, y: &[f64], end: &[f64]) -> f64 {
    let n = network.particles();
    let (x, v) = end.split_at(3 * n);
    let mut f = vec![0.0; 3 * n];
    network.forces(h, x, v, &mut f);
    let (mut worst, mut most): (f64, f64) = (0.0, 0.0);
    for (k, f) in f.iter().enumerate().filter(|(k, _)| !network.is_pinned(k % n)) {
        let gained = network.masses()[k % n] * (v[k] - y[3 * n + k]);
        worst = worst.max((gained - h * f).abs());
        most = most.max(gained.abs());
    }
    worst / most
}
