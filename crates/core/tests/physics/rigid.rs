//! Rigid bodies against exact solutions and laws of conservation.

use a3_core::contact::Shape;
use a3_core::integrators::{self, METHODS};
use a3_core::rigid::{Body, MassProperties, Part, Rotation};
use a3_core::{Control, Model, Network, ParticleSystem, Scene, Simulation, Vector3};

/// Principal moments of a T-handle, with its spin about the middle one.
const INERTIA: Vector3<f64> = Vector3::new(0.02, 0.05, 0.06);

/// A body of 2 kg with these moments and eight points, and its initial state of motion.
fn body(inertia: Vector3<f64>, spin: Vector3<f64>, velocity: Vector3<f64>) -> Scene {
    let half_extents = Vector3::new(0.3, 0.2, 0.1);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let shape = Shape::Box { half_extents, axes };
    let at = Vector3::zeros();
    let body = Body::new(0, 1, inertia, vec![Part { shape, at }]).unwrap();
    let mut network = Network::new(vec![2.0; 9]).unwrap();
    network.add_body(body).unwrap();
    let mut state = vec![0.0; network.dim()];
    for axis in 0..3 {
        state[27 + axis * 9] = velocity[axis];
    }
    let mut rotation = Rotation::about(Vector3::new(0.3, -0.4, 0.2));
    rotation.momentum = network.bodies()[0].momentum(rotation.q, rotation.matrix() * spin);
    network.set_rotation(0, &rotation, &mut state);
    Scene::new("body", Model::Network(Box::new(network)), state)
}

/// Angular velocity along the principal axes (rad/s).
fn own_spin(run: &Simulation) -> Vector3<f64> {
    let network = run.model().network().unwrap();
    let rotation = network.rotation(0, run.state());
    rotation.matrix().tr_mul(&rotation.momentum).component_div(&INERTIA)
}

/// Jacobi's elliptic functions sn, cn and dn of u with modulus k, and the quarter period K, by the
/// arithmetic-geometric mean (Abramowitz, Stegun, 16.4).
fn jacobi(u: f64, k: f64) -> ([f64; 3], f64) {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    let mut ratios = vec![];
    while (a - b).abs() > 1e-15 * a {
        ratios.push(0.5 * (a - b) / (0.5 * (a + b)));
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let mut phase = a * u * f64::from(1 << ratios.len());
    for ratio in ratios.iter().rev() {
        phase = 0.5 * (phase + (ratio * phase.sin()).asin());
    }
    let (sn, cn) = phase.sin_cos();
    ([sn, cn, (1.0 - k * k * sn * sn).sqrt()], std::f64::consts::FRAC_PI_2 / a)
}

/// Exact angular velocity of a free body along its axes at time t, which is (small, 0, large) at
/// first, and the time of half a period, in which it flips (Landau, Lifshitz, *Mechanics*, 37).
fn exact(start: Vector3<f64>, t: f64) -> (Vector3<f64>, f64) {
    let i = INERTIA;
    let energy = start.component_mul(&start).dot(&i);
    let squared = start.component_mul(&i).norm_squared();
    let (low, high) = (energy * i.z - squared, squared - energy * i.x);
    let rate = ((i.z - i.y) * high / i.product()).sqrt();
    let k = ((i.y - i.x) * low / ((i.z - i.y) * high)).sqrt();
    let ([sn, cn, dn], quarter) = jacobi(rate * t, k);
    let spin = Vector3::new(
        (low / (i.x * (i.z - i.x))).sqrt() * cn,
        (low / (i.y * (i.z - i.y))).sqrt() * sn,
        (high / (i.z * (i.z - i.x))).sqrt() * dn,
    );
    (spin, 2.0 * quarter / rate)
}

/// Spin that comes close to the unstable motion about the middle axis: k is 0.9998.
const START: Vector3<f64> = Vector3::new(4.999, 0.0, 5.0);

fn run(method: &str, control: Control, start: Vector3<f64>, end: f64) -> Simulation {
    let method = integrators::find(method).unwrap();
    let mut run = Simulation::new(body(INERTIA, start, Vector3::zeros()), method, control).unwrap();
    run.advance_to(end).unwrap();
    run
}

#[test]
fn a_handle_flips_as_elliptic_functions_say() {
    let (_, flip) = exact(START, 0.0);
    let end = 10.0 * flip;
    let found = own_spin(&run("dop853", Control::Tolerance(2e-14), START, end));
    let (spin, _) = exact(START, end);
    assert!((found - spin).norm() < 1e-9 * spin.norm(), "{found} {spin} {flip}");
    // It did flip: the spin about the middle axis is reversed half a period after its largest.
    let [a, b] = [0.5, 1.5].map(|at| exact(START, at * flip).0.y);
    assert!(a > 4.0 && (a + b).abs() < 1e-9, "{a} {b}");
}

#[test]
fn orders_hold_for_rotations() {
    let start = Vector3::new(2.0, 0.0, 3.0);
    let end = 1.0;
    let (spin, _) = exact(start, end);
    for (name, order) in [
        ("euler", 1.0),
        ("midpoint", 2.0),
        ("rk4", 4.0),
        ("verlet", 2.0),
        ("pefrl", 4.0),
        ("symplectic", 1.0),
        ("trapezoid", 2.0),
        ("implicit-midpoint", 2.0),
        ("tr-bdf2", 2.0),
    ] {
        let error = |steps: f64| {
            let found = own_spin(&run(name, Control::Step(end / steps), start, end));
            (found - spin).norm()
        };
        let errors = [error(80.0), error(160.0)];
        if errors[1] < 1e-11 {
            // Free rotation is a drift alone, of order 6.
            assert!(["verlet", "pefrl", "symplectic"].contains(&name), "{name}");
            continue;
        }
        let slope = (errors[0] / errors[1]).log2();
        assert!((slope - order).abs() < 0.1, "{name}: {slope} {errors:?}");
    }
}

#[test]
fn angular_momentum_keeps_its_bits() {
    for method in
        METHODS.iter().filter(|m| !m.positions_only() && !m.needs_springs() && !m.plain_only())
    {
        let scene = body(INERTIA, START, Vector3::new(1.0, 2.0, 3.0));
        let rotation = |run: &Simulation| {
            let network = run.model().network().unwrap();
            network.rotation(0, run.state())
        };
        let control = method.control(1e-3);
        let mut run = Simulation::new(scene, method, control).unwrap();
        let before = rotation(&run).momentum;
        run.advance_to(0.2).unwrap();
        let after = rotation(&run).momentum;
        let off = (after - before).norm() / before.norm();
        assert!(off <= 1e-13, "{}: {off}", method.name);
    }
}

#[test]
fn methods_for_positions_alone_refuse_bodies() {
    for method in METHODS {
        let scene = body(INERTIA, START, Vector3::zeros());
        let made = Simulation::new(scene, method, method.default_control);
        let serves = !method.positions_only() && !method.needs_springs() && !method.plain_only();
        assert_eq!(made.is_ok(), serves, "{}", method.name);
        if let Err(error) = made {
            assert!(format!("{error}").contains("rigid bodies"), "{error}");
        }
    }
}

#[test]
fn masses_are_exact() {
    // A box as a mesh, far from the origin, against the formula; and a capsule against its limits.
    let half = Vector3::new(0.3, 0.2, 0.1);
    let cuboid = Shape::turned_box(half, Vector3::new(0.3, 0.5, -0.2)).unwrap();
    let by_formula = MassProperties::of(&cuboid, 700.0).unwrap();
    let simplices = cuboid.simplices();
    let far = Vector3::new(10.0, -20.0, 5.0);
    let points = simplices.points.iter().map(|p| p + far).collect();
    let mesh = a3_core::contact::ClosedMesh::new(points, simplices.triangles).unwrap();
    let of_mesh = MassProperties::of(&Shape::Mesh(mesh.into()), 700.0).unwrap();
    assert!((by_formula.mass - 700.0 * 0.6 * 0.4 * 0.2).abs() < 1e-12 * by_formula.mass);
    assert!((of_mesh.mass - by_formula.mass).abs() < 1e-12 * by_formula.mass);
    assert!((of_mesh.center - far).norm() < 1e-12);
    assert!((of_mesh.inertia - by_formula.inertia).norm() < 1e-12 * by_formula.inertia.norm());
    let mut moments = by_formula.principal().0.as_slice().to_vec();
    moments.sort_by(f64::total_cmp);
    let m = by_formula.mass / 3.0;
    for (found, exact) in moments.iter().zip([0.04 + 0.01, 0.09 + 0.01, 0.09 + 0.04]) {
        assert!((found - m * exact).abs() < 1e-12, "{moments:?}");
    }
    let ends = [Vector3::new(0.0, -0.5, 0.0), Vector3::new(0.0, 0.5, 0.0)];
    let radius = 0.2;
    let capsule = MassProperties::of(&Shape::Capsule { ends, radius }, 1.0).unwrap();
    // By slices perpendicular to the axis.
    let (mut mass, mut across, mut along) = (0.0, 0.0, 0.0);
    let slices = 200_000;
    for k in 0..slices {
        let h = 1.4 / f64::from(slices);
        let y = -0.7 + (f64::from(k) + 0.5) * h;
        let past = (y.abs() - 0.5_f64).max(0.0);
        let squared: f64 = radius * radius - past * past;
        let slice = std::f64::consts::PI * squared * h;
        mass += slice;
        along += slice * squared / 2.0;
        across += slice * (squared / 4.0 + y * y);
    }
    assert!((capsule.mass - mass).abs() < 1e-8);
    assert!((capsule.inertia[(1, 1)] - along).abs() < 1e-8);
    assert!((capsule.inertia[(0, 0)] - across).abs() < 1e-8);
}

#[test]
fn bodies_that_cannot_be_are_refused() {
    let part = Part { shape: Shape::Sphere { radius: 0.1 }, at: Vector3::zeros() };
    let refused = |inertia| Body::new(0, 1, inertia, vec![part.clone()]).unwrap_err();
    let error = format!("{}", refused(Vector3::new(1.0, 1.0, 2.1)));
    assert!(error.contains("sum of the other two"), "{error}");
    refused(Vector3::new(0.0, 1.0, 1.0));
    refused(Vector3::new(f64::NAN, 1.0, 1.0));
}
