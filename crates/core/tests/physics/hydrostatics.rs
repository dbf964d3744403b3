//! Water at rest against hydrostatics.

use a3_core::{Control, Model, Simulation};

use crate::common::{described, method};
use crate::networks::Random;

/// Water of so many particles, `wide` and `deep`, that has come to rest in a tank. In three
/// dimensions, it is as long as it is wide. It begins on a lattice whose places are stirred by a
/// share of the spacing, and its weight compresses it by 1 % at the bottom.
fn at_rest(dimensions: u8, [wide, deep]: [u32; 2], spacing: f64, stirred: f64) -> Simulation {
    let [width, depth] = [wide, deep].map(|count| f64::from(count) * spacing);
    let length = if dimensions == 3 { width } else { 0.0 };
    let sound = 10.0 * (9.81 * depth).sqrt();
    let mut scene = described(&format!(
        "gravity = [0, -9.81, 0]
        [[fluid]]
        dimensions = {dimensions}
        size = [{width:e}, {depth:e}, {length:e}]
        spacing = {spacing:e}
        at = [0, {middle:e}, 0]
        density = 1000
        sound = {sound:e}
        viscosity = {viscosity:e}
        tank = {{ size = [{width:e}, {depth:e}, {length:e}], at = [0, {middle:e}, 0] }}",
        middle = 0.5 * depth,
        viscosity = 0.03 * sound * spacing,
    ));
    if let Model::Network(network) = &mut scene.model {
        // Drag brings the water to rest sooner.
        network.set_drag(network.masses()[0] * sound / depth).unwrap();
        let n = network.masses().len();
        let mut random = Random(1);
        for k in 0..usize::from(dimensions) * n {
            if !network.is_pinned(k % n) {
                scene.state[k] += spacing * random.between(-stirred, stirred);
            }
        }
    }
    let step = Control::Step(0.7 * spacing / sound);
    let mut run = Simulation::new(scene, method("verlet"), step).unwrap();
    run.advance_to(20.0 * depth / sound).unwrap();
    run
}

/// Heights (m) and pressures (Pa) of the particles of the water.
fn profile(run: &Simulation) -> Vec<[f64; 2]> {
    let (n, y) = (run.particles(), run.state());
    let network = run.model().network().unwrap();
    let pressures = network.fluid().unwrap().pressures(&y[..3 * n]);
    let free = (0..n).filter(|i| !network.is_pinned(*i));
    free.map(|i| [y[n + i], pressures[i]]).collect()
}

/// The pressure grows with the depth by the weight of the water, to 1 %, in metres, tenths of
/// millimetres and hundreds of metres.
#[test]
fn the_pressure_of_water_grows_with_its_depth() {
    for (dimensions, counts, spacing, stirred) in [
        (2, [10, 10], 0.1, 0.0),
        (2, [10, 10], 1e-4, 0.1),
        (2, [20, 10], 10.0, 0.1),
        (2, [10, 20], 0.1, 0.0),
        (3, [10, 10], 0.1, 0.1),
    ] {
        let profile = profile(&at_rest(dimensions, counts, spacing, stirred));
        let mean = |f: &dyn Fn(&[f64; 2]) -> f64| {
            profile.iter().map(f).sum::<f64>() / profile.len() as f64
        };
        let (height, pressure) = (mean(&|p| p[0]), mean(&|p| p[1]));
        let slope = mean(&|p| (p[0] - height) * (p[1] - pressure))
            / mean(&|p| (p[0] - height) * (p[0] - height));
        // The water is denser by half of the compression at the bottom.
        let error = slope / (-1005.0 * 9.81) - 1.0;
        assert!(error.abs() < 0.01, "{dimensions}, {counts:?}: {error}");
    }
}

/// The pressure is the weight of the water above, to 1 % of that at the bottom.
#[test]
fn water_at_rest_has_hydrostatic_pressure() {
    let run = at_rest(2, [25, 25], 0.04, 0.0);
    let (profile, mass) = (profile(&run), run.model().network().unwrap().masses()[0]);
    // Means over slices of two and a half rows.
    for slice in 0..9 {
        let low = 0.1 * f64::from(slice);
        let inside = profile.iter().filter(|p| (low..low + 0.1).contains(&p[0]));
        let inside: Vec<f64> = inside.map(|p| p[1]).collect();
        let above = profile.iter().filter(|p| p[0] >= low + 0.1).count() as f64;
        let weight = 9.81 * mass * (above + 0.5 * inside.len() as f64);
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        let error = (mean - weight) / (1000.0 * 9.81);
        assert!(error.abs() < 0.01, "{low}: {error}");
    }
}
