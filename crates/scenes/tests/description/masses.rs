//! Masses: a body that is given by its density weighs density times area or volume.

use std::f64::consts::PI;

use super::*;

/// Lengths of the units (m) in which the same body is described.
const UNITS: [f64; 3] = [1e-3, 1.0, 1e3];

fn masses(text: &str) -> Vec<f64> {
    network(&build(text).unwrap()).masses().to_vec()
}

/// Asserts the mass of all particles of a scene together (kg).
fn assert_weight(text: &str, expected: f64) {
    let weight: f64 = masses(text).iter().sum();
    let off = (weight / expected - 1.0).abs();
    assert!(off < 1e-12, "{weight} instead of {expected}:\n{text}");
}

/// Cloths of any grid, given by their width or by the distance of their particles, in any unit: all
/// particles have equal shares of the mass.
#[test]
fn a_cloth_weighs_its_density_times_its_area() {
    for unit in UNITS {
        for [rows, cols] in [[2, 2], [9, 9], [20, 20], [2, 130], [130, 2], [7, 31]] {
            let body = format!("[[cloth]]\ngrid = [{rows}, {cols}]\nstiffness = [40, 20, 5]\n");
            let (down, along) = (f64::from(rows - 1), f64::from(cols - 1));
            let width = 1.3 * unit;
            let text = format!("{body}width = {width}\ndensity = 0.2\n");
            assert_weight(&text, 0.2 * width * width * down / along);
            let text = format!("{body}spacing = {width}\ndensity = 0.2\n");
            assert_weight(&text, 0.2 * width * width * down * along);
            let masses = masses(&text);
            assert!(masses.iter().all(|m| *m == masses[0]));
            // A cloth that is given by the mass of its particles weighs as much as these.
            let text = format!("{body}width = {width}\nmass = 0.5\n");
            assert_weight(&text, 0.5 * f64::from(rows * cols));
        }
    }
}

/// Another grid samples the same cloth. Its default steps are shorter in proportion to its shortest
/// period.
#[test]
fn another_grid_weighs_as_much() {
    for name in ["cloth", "flag"] {
        let weight = |grid| {
            let setup = scene(name, grid);
            let masses = network(&setup.scene).masses();
            (masses.iter().sum::<f64>(), masses[0], setup.defaults)
        };
        let (own, mass, _) = weight(None);
        let [rows, cols] = if name == "cloth" { [39, 39] } else { [21, 31] };
        let (fine, lighter, defaults) = weight(Some([rows, cols]));
        assert!((fine / own - 1.0).abs() < 1e-12, "{name}: {fine} and {own}");
        let scale = (lighter / mass).sqrt();
        assert!(scale < 0.6 && (defaults.step_scale - scale).abs() < 1e-12);
    }
    // With the same width in two rows, the area falls to a nineteenth and the number of particles
    // to a tenth.
    let flat = scene("cloth", Some([2, 20])).defaults.step_scale;
    assert!((flat - (10.0_f64 / 19.0).sqrt()).abs() < 1e-12, "{flat}");
    assert!(scene("mit", Some([40, 30])).defaults.step_scale == 1.0);
}

#[test]
fn a_jelly_and_a_solid_weigh_their_density_times_their_volume() {
    for unit in UNITS {
        let size = [1.2, 0.2, 0.3].map(|edge| edge * unit);
        let weight = 1100.0 * size.iter().product::<f64>();
        for grid in [[2, 2, 2], [3, 2, 4], [9, 5, 6]] {
            for matter in
                ["[[jelly]]\nstiffness = [9, 9, 9]", "[[solid]]\nyoung = 1e5\npoisson = 0.3"]
            {
                let place = format!("grid = {grid:?}\nsize = {size:?}\nat = [1, 2, 3]");
                assert_weight(&format!("{matter}\n{place}\ndensity = 1100\n"), weight);
            }
        }
    }
}

/// A square from a file, and a sphere of many triangles, whose area is nearly that of a sphere.
#[test]
fn a_mesh_weighs_its_density_times_its_area() {
    for unit in UNITS {
        let text = |file: &str| {
            format!(
                "[[mesh]]\nfile = '{file}'\nscale = {unit}\ndensity = 0.3\nstiffness = [40, 10]\n\
                 at = [5, 6, 7]\nrotation = [1, 2, 3]\n"
            )
        };
        assert_weight(&text("square.obj"), 0.3 * unit * unit);
        let setup = read(&text("ball.obj")).build(None, &mut |_| Ok(ball())).unwrap();
        let weight: f64 = network(&setup.scene).masses().iter().sum();
        let sphere = 0.3 * 4.0 * PI * unit * unit;
        assert!(weight < sphere && weight > 0.99 * sphere, "{weight}");
    }
}

/// Sphere of radius 1 in rings of triangles.
fn ball() -> Mesh {
    let [rings, around] = [30_u32, 60];
    let mut mesh = Mesh::default();
    for (i, j) in (0..=rings).flat_map(|i| (0..around).map(move |j| (i, j))) {
        let polar = PI * f64::from(i) / f64::from(rings);
        let turn = 2.0 * PI * f64::from(j) / f64::from(around);
        let radius = if i % rings == 0 { 0.0 } else { polar.sin() };
        let place = [radius * turn.cos(), polar.cos(), radius * turn.sin()];
        mesh.positions.push(place);
        let at = |i: u32, j: u32| i * around + j % around;
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        // At a pole, the ring is one point.
        let upper = (i > 0 && i < rings).then_some([a, b, c]);
        let lower = (i + 1 < rings).then_some([a, c, d]);
        mesh.triangles.extend([upper, lower].into_iter().flatten());
    }
    mesh
}

/// Each part has the mass of its formula in any place, and so have two parts together. The centre
/// has the mass of the body, and its points have none.
#[test]
fn a_rigid_body_weighs_its_density_times_its_volume() {
    for unit in UNITS {
        let cube = unit.powi(3);
        let [a, b, c] = [0.5, 0.2, 0.3].map(|edge| edge * unit);
        let (r, l) = (0.2 * unit, 0.7 * unit);
        let (cuboid, round) = (0.03 * cube, 4.0 / 3.0 * PI * 0.008 * cube);
        let [cuboid_part, ball_part] =
            [format!("{{ box = [{a}, {b}, {c}] }}"), format!("{{ ball = {r}, at = [{l}, 0, 0] }}")];
        let capsule = format!("{{ capsule = [{l}, {r}], rotation = [1, 0, 2] }}");
        for (parts, volume) in [
            (format!("{cuboid_part}, {ball_part}"), cuboid + round),
            (cuboid_part, cuboid),
            (ball_part, round),
            (capsule, PI * (0.7 * 0.04 + 4.0 / 3.0 * 0.008) * cube),
        ] {
            let text = format!("[[body]]\nparts = [{parts}]\ndensity = 700\nat = [1, 2, 3]\n");
            assert_weight(&text, 700.0 * volume);
            // Drag over mass is the rate at which the body slows down.
            let scene = build(&format!("drag_per_mass = 0.4\n{text}")).unwrap();
            let rate = network(&scene).drag().unwrap() / (700.0 * volume);
            assert!((rate / 0.4 - 1.0).abs() < 1e-12, "{rate}");
        }
    }
}

/// A box of fluid weighs its density times its volume. The particles of a ball are the lattice
/// points in it, so its mass converges to that of a ball as the spacing shrinks.
#[test]
fn a_fluid_weighs_its_density_times_its_volume() {
    for unit in UNITS {
        let fluid = |dimensions: i32, edges: [f64; 3], spacing: f64, shape: &str| {
            let [x, y, z] = edges.map(|edge| edge * unit);
            format!(
                "[[fluid]]\ndimensions = {dimensions}\nsize = [{x}, {y}, {z}]\nspacing = {}\n\
                 shape = '{shape}'\ndensity = 800\nsound = 10\nat = [0, 0, 0]\n",
                spacing * unit
            )
        };
        let (square, cube) = (unit * unit, unit.powi(3));
        let flat = fluid(2, [1.0, 2.0, 0.0], 0.1, "box");
        assert_weight(&flat, 800.0 * 2.0 * square);
        let deep = fluid(3, [1.0, 0.5, 0.8], 0.1, "box");
        assert_weight(&deep, 800.0 * 0.4 * cube);
        for (text, volume) in [
            (fluid(2, [2.0, 2.0, 0.0], 0.04, "ball"), PI * square),
            (fluid(3, [1.0, 1.0, 1.0], 0.05, "ball"), PI / 6.0 * cube),
        ] {
            let weight: f64 = masses(&text).iter().sum();
            assert!((weight / (800.0 * volume) - 1.0).abs() < 0.01, "{weight}");
        }
    }
}
