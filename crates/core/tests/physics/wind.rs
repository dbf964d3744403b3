//! Air that streams past triangles: its force is as computed by hand, does not depend on the
//! winding order, and only takes energy.

use crate::common::{described, distance, integrate, method, scene_with_grid};
use a3_core::elements::{Air, Wind};
use a3_core::{
    Control, Mechanics, Model, Network, Scene, Simulation, Spring, SpringKind, SpringLaw, Vector3,
    integrators,
};
use approx::assert_relative_eq;

const DENSITY: f64 = 1.2;
const DRAG: f64 = 1.3;
const LIFT: f64 = 0.7;

/// Still air with these coefficients of drag and lift.
fn calm(drag: f64, lift: f64) -> Wind {
    let air = Air::new(DENSITY, drag, lift).unwrap();
    Wind::on_triangles(1, Vector3::zeros(), air)
}

/// Forces (N) of still air on the corners of a triangle that move at these velocities (m/s).
fn forces(
    wind: &Wind,
    corners: [Vector3<f64>; 3],
    velocities: [Vector3<f64>; 3],
    numbers: [usize; 3],
) -> [Vector3<f64>; 3] {
    let mut network = Network::new(vec![1.0; 3]).unwrap();
    network.set_triangles([numbers]).unwrap();
    network.set_wind(Some(*wind));
    let columns =
        |of: [Vector3<f64>; 3]| -> Vec<f64> { (0..9).map(|k| of[k % 3][k / 3]).collect() };
    let mut f = vec![f64::NAN; 9];
    network.forces(0.3, &columns(corners), &columns(velocities), &mut f);
    [0, 1, 2].map(|i| Vector3::new(f[i], f[3 + i], f[6 + i]))
}

/// Corners (m) of a triangle of 3 m2 in the plane z = 0.
const CORNERS: [Vector3<f64>; 3] =
    [Vector3::new(-1.0, -0.5, 0.0), Vector3::new(2.0, -0.5, 0.0), Vector3::new(0.0, 1.5, 0.0)];
const AREA: f64 = 3.0;

/// Total force (N) on the triangle of air that streams at u (m/s).
fn total(wind: &Wind, u: Vector3<f64>) -> Vector3<f64> {
    forces(wind, CORNERS, [-u; 3], [0, 1, 2]).iter().sum()
}

#[test]
fn a_plate_face_on_has_the_drag_of_its_area_and_no_lift() {
    let each = forces(&calm(DRAG, LIFT), CORNERS, [Vector3::z() * 5.0; 3], [0, 1, 2]);
    let expected = -Vector3::z() * (0.5 * DENSITY * DRAG * AREA * 25.0);
    for force in each {
        assert_relative_eq!(force, expected / 3.0, max_relative = 1e-15);
    }
}

#[test]
fn a_plate_edge_on_and_one_that_drifts_along_feel_nothing() {
    assert_eq!(total(&calm(DRAG, LIFT), Vector3::new(3.0, -4.0, 0.0)), Vector3::zeros());
    assert_eq!(total(&calm(DRAG, LIFT), Vector3::zeros()), Vector3::zeros());
    // A triangle without area feels no force either.
    let line = [0.0, 1.0, 3.0].map(|s| Vector3::new(s, 2.0 * s, -s));
    let moving = [Vector3::new(1.0, 2.0, 3.0); 3];
    let none = [Vector3::zeros(); 3];
    assert_eq!(forces(&calm(DRAG, LIFT), line, moving, [0, 1, 2]), none);
    assert_eq!(forces(&calm(DRAG, LIFT), [line[1]; 3], moving, [0, 1, 2]), none);
    assert_eq!(forces(&calm(DRAG, LIFT), CORNERS, moving, [0, 1, 1]), none);
}

/// Air from below at 45 degrees exerts `C_d` cos 45 along its direction, and `C_l` cos 45 sin 45
/// perpendicular to it, towards the plate's normal.
#[test]
fn at_45_degrees_drag_and_lift_are_those_of_the_formula() {
    let along = Vector3::new(1.0, 0.0, 1.0).normalize();
    let across = Vector3::new(-1.0, 0.0, 1.0).normalize();
    let pressure = 0.5 * DENSITY * 16.0 * AREA;
    let cos = 0.5f64.sqrt();
    let force = total(&calm(DRAG, LIFT), 4.0 * along);
    assert_relative_eq!(force.dot(&along), pressure * DRAG * cos, max_relative = 1e-14);
    assert_relative_eq!(force.dot(&across), pressure * LIFT * 0.5, max_relative = 1e-14);
    // The same holds for air from the other side.
    let force = total(&calm(DRAG, LIFT), 4.0 * across);
    assert_relative_eq!(force.dot(&across), pressure * DRAG * cos, max_relative = 1e-14);
    assert_relative_eq!(force.dot(&along), pressure * LIFT * 0.5, max_relative = 1e-14);
}

#[test]
fn which_side_is_the_front_does_not_matter() {
    let air = Air::new(DENSITY, DRAG, LIFT).unwrap();
    let wind = Wind::on_triangles(5, Vector3::new(2.0, -1.0, 3.0), air);
    let corners =
        [Vector3::new(0.1, 0.2, 0.9), Vector3::new(1.3, -0.4, 0.2), Vector3::new(-0.6, 0.8, -0.3)];
    let velocities = [Vector3::x(), Vector3::y() * 2.0, Vector3::z() * -1.5];
    let front = forces(&wind, corners, velocities, [0, 1, 2]);
    assert!(front[0].norm() > 0.1);
    for numbers in [[0, 2, 1], [2, 1, 0], [1, 2, 0]] {
        let back = forces(&wind, corners, velocities, numbers);
        for (front, back) in front.iter().zip(back) {
            assert_relative_eq!(*front, back, max_relative = 1e-15 * 4.0);
        }
    }
}

/// Gusts on a triangle are those of a wind on particles, as velocities, at the centroid of the
/// triangle.
#[test]
fn gusts_are_felt_where_the_triangle_is() {
    let mean = Vector3::new(2.0, -1.0, 3.0);
    let gusty = Wind::on_triangles(5, mean, Air::new(DENSITY, DRAG, LIFT).unwrap());
    let middle = CORNERS.iter().sum::<Vector3<f64>>() / 3.0;
    let u = Wind::new(5, mean).at(0.3, middle.into());
    assert!((u - mean).norm() > 0.1);
    let found: Vector3<f64> =
        forces(&gusty, CORNERS, [Vector3::zeros(); 3], [0, 1, 2]).iter().sum();
    assert_relative_eq!(found, total(&calm(DRAG, LIFT), u), max_relative = 1e-14);
}

/// Cloth with triangles, on which this wind can be turned on.
fn flying(wind: &Wind) -> Scene {
    let mut scene = scene_with_grid("cloth", 9, 11);
    let grid = scene.grid().unwrap();
    let Model::Network(network) = &mut scene.model else { panic!("masses and springs") };
    network.set_triangles(grid.triangles()).unwrap();
    scene.wind = Some(*wind);
    scene
}

#[test]
fn still_air_slows_what_moves_and_never_drives_it() {
    let mut scene = flying(&calm(DRAG, 0.0));
    let grid = scene.grid().unwrap();
    let Model::Network(network) = &mut scene.model else { panic!("masses and springs") };
    let n = grid.particles();
    let mut free = Network::new(network.masses().to_vec()).unwrap();
    free.add(network.sheets().next().unwrap().clone()).unwrap();
    free.set_triangles(grid.triangles()).unwrap();
    **network = free;
    for (k, v) in scene.state[3 * n..].iter_mut().enumerate() {
        *v = 3.0 * (1.7 * k as f64).sin() + f64::from(u8::from(k < n));
    }
    let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.0005)).unwrap();
    let mut energies = vec![];
    for windy in [true, false] {
        run.reset();
        run.set_wind(windy);
        let mut before = run.energy().unwrap().total();
        for _ in 0..2000 {
            run.take_steps(1).unwrap();
            let energy = run.energy().unwrap().total();
            assert!(!windy || energy < before, "at {}", run.time());
            before = energy;
        }
        energies.push(before);
    }
    assert!(energies[0] < 0.7 * energies[1], "{energies:?}");
}

#[test]
fn every_method_flies_in_gusts_alike_and_again_to_the_bit() {
    let air = Air::new(DENSITY, DRAG, LIFT).unwrap();
    let scene = flying(&Wind::on_triangles(2, Vector3::new(1.0, 0.0, 6.0), air));
    let fly = |name: &str| {
        let mut run = Simulation::new(scene.clone(), method(name), Control::Step(0.001)).unwrap();
        run.set_wind(true);
        run.advance_to(1.0).unwrap();
        run
    };
    let exact = fly("rk4");
    let mut calm = Simulation::new(scene.clone(), method("rk4"), Control::Step(0.001)).unwrap();
    calm.advance_to(1.0).unwrap();
    let apart = |a: &Simulation| (a.positions() - exact.positions()).abs().max();
    assert!(apart(&calm) > 0.3, "{}", apart(&calm));
    for name in ["verlet", "pefrl", "heun", "tr-bdf2", "implicit-midpoint"] {
        assert!(apart(&fly(name)) < 1e-3, "{name}: {:e}", apart(&fly(name)));
    }
    for name in ["implicit", "euler", "symplectic"] {
        assert!(apart(&fly(name)) < 0.1, "{name}: {:e}", apart(&fly(name)));
    }
    assert!(fly("verlet").state() == fly("verlet").state());
}

/// Methods keep their order in air. The springs are undamped, so that only the force of the air
/// depends on velocities in a kick.
#[test]
fn methods_keep_their_order_in_the_air() {
    let mut network = Network::new(vec![1.0; 3]).unwrap();
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let law = SpringLaw::new(20.0, 2.5, 0.0).unwrap();
        network.add_spring(Spring { kind: SpringKind::Structural, i, j, law }).unwrap();
    }
    network.set_triangles([[0, 1, 2]]).unwrap();
    let air = Air::new(DENSITY, DRAG, LIFT).unwrap();
    let wind = Wind::on_triangles(2, Vector3::new(0.3, 0.2, 3.0), air);
    network.set_wind(Some(wind));
    assert_eq!(network.forces_in_use(), ["springs", "wind"]);
    let state: Vec<f64> =
        (0..18).map(|k| CORNERS.get(k % 3).filter(|_| k < 9).map_or(0.1, |c| c[k / 3])).collect();
    let exact = integrate(&network, method("dop853"), &state, 1.0 / 512.0, 512);
    for m in integrators::METHODS.iter().filter(|m| m.order <= 4) {
        let error = |steps: u64| {
            let y = integrate(&network, m, &state, 1.0 / steps as f64, steps);
            distance(&y, &exact)
        };
        let steps = if m.order == 4 { 100 } else { 800 };
        let order = (error(steps) / error(2 * steps)).log2();
        let slack = (order - f64::from(m.order)).abs();
        assert!(slack < 0.1, "{}: {order}", m.name);
    }
}

/// Wind that ends the sweeps of a sheet and stops again leaves no trace.
#[test]
fn wind_that_comes_and_goes_leaves_nothing_behind() {
    let air = Air::new(DENSITY, DRAG, LIFT).unwrap();
    let scene = flying(&Wind::on_triangles(2, Vector3::new(1.0, 0.0, 6.0), air));
    for m in ["rk4", "verlet", "symplectic"] {
        let mut run = Simulation::new(scene.clone(), method(m), Control::Step(0.005)).unwrap();
        run.take_steps(20).unwrap();
        let calm = run.state().to_vec();
        run.set_wind(true);
        run.take_steps(20).unwrap();
        run.set_wind(false);
        run.reset();
        run.take_steps(20).unwrap();
        assert!(run.state() == calm, "{m}");
    }
}

#[test]
fn air_and_triangles_that_make_no_sense_are_refused() {
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(Air::new(wrong, 1.0, 1.0).is_err());
        assert!(Air::new(1.0, wrong, 1.0).is_err());
        assert!(Air::new(1.0, 1.0, wrong).is_err());
    }
    let mut network = Network::new(vec![1.0; 3]).unwrap();
    network.set_triangles([[0, 1, 2]]).unwrap();
    let error = network.set_triangles([[0, 1, 2], [0, 3, 1]]).unwrap_err();
    assert!(error.to_string().contains("no particle 3"));
    assert_eq!(network.triangles(), [[0, 1, 2]]);
}

#[test]
fn without_triangles_there_is_nothing_to_blow_on() {
    let scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
    let mut network = scene.model.network().unwrap().clone();
    let n = network.particles();
    let (x, v) = scene.state.split_at(3 * n);
    let (mut calm_f, mut f) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
    network.forces(0.0, x, v, &mut calm_f);
    network.set_triangles([]).unwrap();
    network.set_wind(Some(calm(DRAG, LIFT)));
    network.forces(0.0, x, v, &mut f);
    assert!(f.iter().zip(&calm_f).all(|(a, b)| (a - b).abs() < 1e-12));
}

/// A wind that pushes particles pushes a rigid body once, whatever its shape, and without a torque.
#[test]
fn a_rigid_body_is_pushed_once() {
    for shape in ["ball = 0.2", "box = [0.4, 0.2, 0.2]", "capsule = [0.4, 0.1]"] {
        for (key, x) in [("force", 0.5), ("force_per_mass", 1.0)] {
            let scene = described(&format!(
                "[wind]\non = true\nsteady = true\n{key} = [1, 0, 0]\n[[body]]\nparts = [{{ {shape} }}]\nmass = 2\n\
                 [[body]]\nparts = [{{ ball = 0.1 }}]\nmass = 2\nat = [0, 3, 0]"
            ));
            let verlet = method("verlet");
            let mut run = Simulation::new(scene, verlet, Control::Step(0.01)).unwrap();
            let n = run.particles();
            let before: Vec<_> = (0..n).map(|i| run.position(i)).collect();
            run.advance_to(1.0).unwrap();
            for (i, before) in before.iter().enumerate() {
                let moved = run.position(i) - before;
                let exact = Vector3::new(0.5 * x, 0.0, 0.0);
                assert!((moved - exact).norm() < 1e-9, "{shape}, {key}: {i} by {moved}");
            }
            assert!(run.gained().is_none());
        }
    }
}
