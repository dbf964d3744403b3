//! Boxes turned inside out.

use a3_core::elements::{Hyperelastic, Material};
use a3_core::{Control, Model, Path, Scene, Simulation, Vector3};

use crate::box_of::{Bar, MODELS, rubber};
use crate::common::method;

/// Determinants of the deformation gradients of a cube that is pinned at one face, with all other
/// particles mirrored at first.
fn volumes_after(model: Hyperelastic, name: &str, step: f64) -> Vec<f64> {
    let mut bar = Bar::new([2, 2, 2], [0.2; 3], Material { damping: 0.005, ..rubber(model) });
    let x = bar.moved(|p| Vector3::new(-p.x, p.y, p.z));
    for i in 0..bar.rest.len() {
        if bar.rest[i].x == 0.0 {
            bar.network.pin(i, Path::Still(bar.rest[i])).unwrap();
        }
    }
    bar.network.set_drag(0.5).unwrap();
    let state = [x, vec![0.0; 3 * bar.rest.len()]].concat();
    let scene = Scene::new("mirror", Model::Network(Box::new(bar.network)), state);
    let mut run = Simulation::new(scene, method(name), Control::Step(step)).unwrap();
    run.advance_to(3.0).unwrap();
    let volume = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|i| run.position(i as usize));
        (b - a).cross(&(c - a)).dot(&(d - a)) / (6.0 * 0.001 / 6.0)
    };
    bar.tetrahedra.iter().map(volume).collect()
}

/// A neo-Hookean cube turns back; with Saint Venant and Kirchhoff's energy, it is at rest inside
/// out.
#[test]
fn only_a_neo_hookean_cube_turns_back() {
    for (name, step) in [("rk4", 5e-4), ("implicit", 0.02), ("tr-bdf2", 0.005)] {
        for model in MODELS {
            let volumes = volumes_after(model, name, step);
            let expected = match model {
                Hyperelastic::NeoHookean => 1.0,
                Hyperelastic::StVenantKirchhoff => -1.0,
            };
            for volume in volumes {
                let error = (volume - expected).abs();
                assert!(error < 0.05, "{name} {model:?}: {volume} for {expected}");
            }
        }
    }
}
