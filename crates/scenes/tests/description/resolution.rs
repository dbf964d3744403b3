//! Scenes on finer and coarser grids.

use a3_core::{Mechanics, Scene};
use a3_scenes::{Description, FluidShape, regridded};

const CLOTH: &str = "[[cloth]]\ngrid = [11, 16]\nwidth = 1.5\ndensity = 0.2\nstiffness = [100, 50, 10]\ndamping_ratio = 0.05\n";

fn build(description: &Description) -> Scene {
    let setup = description.build(None, &mut |_| Err(String::new()));
    setup.unwrap().scene
}

/// Asserts that the particles are where they were at the start.
fn assert_same_places(own: &Scene, other: &Scene, places: &[Vec<(usize, f64)>]) {
    let [n, m] = [own, other].map(|scene| scene.model.particles());
    for (i, axis) in (0..n).flat_map(|i| [0, 1, 2].map(|axis| (i, axis))) {
        let there = places[i].iter().map(|(k, weight)| weight * other.state[axis * m + k]);
        let (here, there) = (own.state[axis * n + i], there.sum::<f64>());
        assert!((here - there).abs() < 1e-12, "{i} {axis}");
    }
}

#[test]
fn a_finer_cloth_has_the_same_size_and_mass() {
    let own = Description::parse(&format!("drag = 0.01\n{CLOTH}")).unwrap();
    for (factor, grid) in [(2.0, [21, 31]), (0.5, [7, 10]), (0.2, [3, 4])] {
        let other = regridded(&own, factor, 176).unwrap();
        let (a, b) = (build(&own), build(&other.description));
        let cloth = &other.description.cloth[0];
        assert_eq!(cloth.grid, grid);
        let mass = |scene: &Scene| scene.model.network().unwrap().masses().iter().sum::<f64>();
        assert!((mass(&a) - mass(&b)).abs() < 1e-12);
        // Drag on the whole cloth.
        let drag = |scene: &Scene, description: &Description| {
            description.drag.unwrap() * scene.model.particles() as f64
        };
        assert!((drag(&a, &own) / drag(&b, &other.description) - 1.0).abs() < 1e-12);
        assert_same_places(&a, &b, &other.places);
    }
}

#[test]
fn a_finer_fluid_fills_the_same_box_and_tank() {
    let fluid = "[[fluid]]\nsize = [0.4, 0.6, 0]\nspacing = 0.05\nat = [0.1, 0.1, 0]\ndimensions = 2\n\
                 density = 1000\nsound = 20\n";
    let tank = "tank = { size = [0.8, 0.8, 0], at = [0.2, 0.2, 0] }\n";
    let ball = fluid.replace("0.6, 0]", "0.4, 0]\nshape = \"ball\"");
    let cube = "[[fluid]]\nsize = [0.4, 0.3, 0.2]\nspacing = 0.05\nat = [0, 0, 0]\ndensity = 900\nsound = 9\n\
                tank = { size = [0.6, 0.4, 0.2], at = [0.1, 0.05, 0] }\n";
    for text in [fluid, &format!("{fluid}{tank}"), &ball, cube] {
        let own = Description::parse(text).unwrap();
        let a = build(&own);
        let n = a.model.particles();
        for factor in [2.0, 0.5] {
            let other = regridded(&own, factor, n).unwrap();
            let b = build(&other.description);
            let m = b.model.particles();
            assert!((factor > 1.0) == (m > n), "{n} {m}");
            let free = |scene: &Scene| -> f64 {
                let network = scene.model.network().unwrap();
                let masses = network.masses().iter().zip(network.inverse_masses());
                masses.filter(|(_, w)| **w > 0.0).map(|(m, _)| m).sum()
            };
            if own.fluid[0].shape == FluidShape::Box {
                assert!((free(&a) / free(&b) - 1.0).abs() < 1e-12);
            }
            assert_same_places(&a, &b, &other.places);
        }
    }
}

#[test]
fn numbers_of_particles_keep_the_grid() {
    for more in ["torn = [[0, 1]]\n", "[[pin]]\nparticles = [0]\n"] {
        let [first, last] = if more.starts_with('[') { [CLOTH, more] } else { [more, CLOTH] };
        let text = format!("{first}{last}");
        let scene = Description::parse(&text).unwrap();
        assert!(regridded(&scene, 2.0, 176).is_err(), "{more}");
    }
    let afloat = "[[body]]\nparts = [{ ball = 0.1 }]\nmass = 1\nat = [0, 1, 0]\n[[fluid]]\nsize = [0.4, 0.4, 0.4]\n\
                  spacing = 0.1\nat = [0, 0, 0]\ndensity = 1000\nsound = 20\n";
    let scene = Description::parse(afloat).unwrap();
    assert!(regridded(&scene, 2.0, 100).unwrap_err().contains("bodies"));
}
