//! Fluids against laws of physics: conserved quantities, exact solutions, and an experiment.

use a3_core::{Control, Linearized, Mechanics, Network, Scene, Simulation, Vector3};

use crate::common::{described, distance, ellipse, method, scene, size};
use crate::networks::Random;

/// A blob of fluid beside a wall, compressed and stirred, in two or three dimensions.
fn stirred(dimensions: u8, viscosity: f64) -> Scene {
    let (depth, side) = if dimensions == 3 { (0.4, 0.6) } else { (0.0, 1.0) };
    let text = format!(
        "[[fluid]]
        shape = 'ball'
        dimensions = {dimensions}
        size = [{side}, {side}, {side_z}]
        spacing = 0.1
        at = [0, 0, 0]
        density = 1000
        sound = 20
        viscosity = {viscosity}
        strain = [1, -2, 0.5]
        tank = {{ size = [1.2, 1, {depth}], at = [0, 0, 0] }}",
        side_z = if dimensions == 3 { depth } else { 0.0 },
    );
    let mut scene = described(&text);
    let n = scene.model.particles();
    let mut random = Random(5);
    for (k, y) in scene.state.iter_mut().enumerate() {
        let flat = dimensions == 2 && k / n % 3 == 2;
        if !flat {
            *y = if k < 3 * n { 0.93 * *y } else { *y } + random.between(-0.01, 0.01);
        }
    }
    scene
}

fn network(scene: &Scene) -> &Network {
    scene.model.network().unwrap()
}

/// The fluid alone, without its walls' pins.
fn free(scene: &Scene) -> Network {
    let mut network = network(scene).clone();
    let pins: Vec<_> = network.pins().map(|(i, _)| i).collect();
    for i in pins {
        network.unpin(i);
    }
    network
}

fn forces(network: &Network, x: &[f64], v: &[f64]) -> Vec<f64> {
    let mut f = vec![f64::NAN; x.len()];
    network.forces(0.0, x, v, &mut f);
    f
}

#[test]
fn forces_are_the_gradient_of_the_energy() {
    for dimensions in [2, 3] {
        let scene = stirred(dimensions, 0.0);
        let (network, half) = (free(&scene), scene.state.len() / 2);
        let (x, zero) = (&scene.state[..half], vec![0.0; half]);
        let f = forces(&network, x, &zero);
        let most = size(&f);
        let mut random = Random(2);
        for _ in 0..20 {
            let mut d: Vec<f64> = (0..half).map(|_| random.between(-1.0, 1.0)).collect();
            if dimensions == 2 {
                d[2 * half / 3..].fill(0.0);
            }
            let e = 1e-7;
            let energy = |e: f64| {
                let moved: Vec<f64> = x.iter().zip(&d).map(|(x, d)| x + e * d).collect();
                network.energy(&moved, &zero).elastic
            };
            let slope = (energy(e) - energy(-e)) / (2.0 * e);
            let power: f64 = f.iter().zip(&d).map(|(f, d)| f * d).sum();
            assert!(
                (slope + power).abs() < 1e-6 * most * (half as f64).sqrt(),
                "{dimensions}: {slope} {power}"
            );
        }
    }
}

#[test]
fn the_differential_matches_central_differences() {
    for (dimensions, viscosity) in [(2, 0.0), (2, 0.05), (3, 0.05)] {
        let scene = stirred(dimensions, viscosity);
        let (network, half) = (network(&scene), scene.state.len() / 2);
        let mut random = Random(7);
        let d: Vec<f64> = (0..2 * half).map(|_| random.between(-1.0, 1.0)).collect();
        let (x, v) = scene.state.split_at(half);
        let mut df = vec![f64::NAN; half];
        network.force_differential(0.0, x, v, &d[..half], &d[half..], &mut df);
        let e = 1e-7;
        let at = |e: f64| {
            let moved: Vec<f64> = scene.state.iter().zip(&d).map(|(y, d)| y + e * d).collect();
            forces(network, &moved[..half], &moved[half..])
        };
        let (above, below) = (at(e), at(-e));
        let differences = above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * e));
        let differences: Vec<f64> = differences.collect();
        let error = distance(&df, &differences) / size(&differences);
        assert!(error < 2e-5, "{dimensions}, {viscosity}: {error:e}");
    }
}

/// Pressure and viscosity conserve momentum and angular momentum, and viscosity dissipates energy.
#[test]
fn forces_between_particles_conserve_momentum() {
    for dimensions in [2, 3] {
        let scene = stirred(dimensions, 0.05);
        let (network, n) = (free(&scene), scene.model.particles());
        let (x, v) = scene.state.split_at(3 * n);
        let f = forces(&network, x, v);
        let most: f64 = f.iter().map(|f| f.abs()).sum();
        for axis in 0..3 {
            let sum: f64 = f[axis * n..(axis + 1) * n].iter().sum();
            assert!(sum.abs() < 1e-12 * most, "{sum:e} of {most:e}");
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let torque = |i: usize| x[b * n + i] * f[c * n + i] - x[c * n + i] * f[b * n + i];
            let torque: f64 = (0..n).map(torque).sum();
            assert!(torque.abs() < 1e-12 * most, "{torque:e} of {most:e}");
        }
        let pressure = forces(&network, x, &vec![0.0; 3 * n]);
        let viscous = f.iter().zip(&pressure).map(|(f, p)| f - p);
        let power: f64 = viscous.zip(v).map(|(f, v)| f * v).sum();
        assert!(power < 0.0, "{power}");
    }
}

/// The semi-axis of the drop obeys b' = A b, A' = A^2 (a^2 - b^2) / (a^2 + b^2), a b = 1 (Monaghan,
/// *Simulating free surface flows with SPH*, 1994). Verlet's method keeps the energy.
#[test]
fn a_drop_becomes_the_ellipse_of_its_equation() {
    let scene = ellipse();
    let spacing = network(&scene).fluid().unwrap().law().spacing;
    let mut run = Simulation::new(scene, method("verlet"), Control::Step(2e-3)).unwrap();
    let before = run.energy().unwrap().total();
    let (mut rate, mut b): (f64, f64) = (1.0, 1.0);
    let mut drift: f64 = 0.0;
    let start = run.state().to_vec();
    let height = |y: &[f64]| {
        let n = y.len() / 6;
        y[n..2 * n].iter().copied().fold(0.0, f64::max) + 0.5 * spacing
    };
    let radius = height(&start);
    for _ in 0..8 {
        for _ in 0..1000 {
            let a = 1.0 / b;
            let slope = rate * rate * (a * a - b * b) / (a * a + b * b);
            (rate, b) = (rate + 1e-4 * slope, b + 1e-4 * rate * b);
        }
        run.take_steps(50).unwrap();
        drift = drift.max((run.energy().unwrap().total() - before).abs());
        let (now, expected) = (height(run.state()) / radius, b);
        let error = (now / expected - 1.0).abs();
        assert!(error < 0.02, "{now} instead of {expected}");
    }
    assert!(b > 1.9);
    assert!(drift < 1e-4 * before, "{:e}", drift / before);
}

/// Times T = t (2 g / a)^1/2 at which the front of a column of the width a and the height 2 a is at
/// Z a: Martin, Moyce, *An experimental study of the collapse of liquid columns on a rigid
/// horizontal plane*, 1952, table 2, a = 2.25 in.
const MARTIN_MOYCE: [[f64; 2]; 11] = [
    [0.84, 1.22],
    [1.19, 1.44],
    [1.43, 1.67],
    [1.63, 1.89],
    [1.83, 2.11],
    [1.98, 2.33],
    [2.20, 2.56],
    [2.32, 2.78],
    [2.51, 3.00],
    [2.65, 3.22],
    [2.83, 3.44],
];

#[test]
fn the_front_of_a_dam_break_is_where_it_was_measured() {
    let scene = scene("dam-break");
    let free: Vec<usize> =
        (0..scene.model.particles()).filter(|i| !network(&scene).is_pinned(*i)).collect();
    let mut run = Simulation::new(scene, method("verlet"), Control::Step(5e-4)).unwrap();
    for [time, expected] in MARTIN_MOYCE {
        run.advance_to(time / (2.0_f64 * 9.81).sqrt()).unwrap();
        let front = free.iter().map(|i| run.state()[*i]).fold(0.0, f64::max) + 0.5 * 0.0625;
        let error = (front / expected - 1.0).abs();
        assert!(error < 0.1, "T = {time}: {front} instead of {expected}");
    }
}

/// A fluid that is compressed everywhere flows smoothly: methods have their orders.
#[test]
fn methods_have_their_orders_on_a_smooth_flow() {
    let mut scene = ellipse();
    let half = scene.state.len() / 2;
    // Compressed to four fifths of its width, it expands, but has not separated anywhere yet.
    for x in &mut scene.state[..half] {
        *x *= 0.75;
    }
    let end = 4e-3;
    let run = |name: &str, control| {
        let mut run = Simulation::new(scene.clone(), method(name), control).unwrap();
        run.advance_to(end).unwrap();
        run.state()[..half].to_vec()
    };
    let exact = run("dop853", Control::Tolerance(1e-12));
    for (name, order) in
        [("euler", 1.0), ("heun", 2.0), ("rk4", 4.0), ("verlet", 2.0), ("pefrl", 4.0)]
    {
        let error = |steps: f64| distance(&run(name, Control::Step(end / steps)), &exact);
        let slope = (error(8.0) / error(16.0)).log2();
        assert!((slope - order).abs() < 0.35, "{name}: {slope}");
    }
}

/// The forces on enough particles for many threads are bitwise equal for any number of threads.
#[test]
fn any_number_of_threads_finds_the_same_forces() {
    let scene = described(
        "[[fluid]]
        size = [1.2, 1.2, 1.2]
        spacing = 0.1
        at = [0, 0, 0]
        density = 1000
        sound = 20
        viscosity = 0.01
        strain = [1, -2, 1]",
    );
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let control = Control::Step(1e-3);
            let mut run = Simulation::new(scene.clone(), method("rk4"), control).unwrap();
            run.take_steps(30).unwrap();
            run.state().to_vec()
        })
    };
    let one = run(1);
    for threads in [2, 3, 8] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// Free particles of a run.
fn flowing(run: &Simulation) -> Vec<usize> {
    let network = run.model().network().unwrap();
    (0..run.particles()).filter(|i| !network.is_pinned(*i)).collect()
}

/// A jet in free fall, in metres, millimetres and hundreds of metres: at any time, as much has
/// flowed in as the speed and the opening say, to half of a layer, and each layer is on the
/// parabola of a projectile from the opening.
#[test]
fn a_jet_falls_like_a_projectile() {
    for scale in [1.0, 1e-3, 100.0_f64] {
        let pace = scale.sqrt();
        let [spacing, width, speed, sound, until] =
            [0.04 * scale, 0.2 * scale, 2.0 * pace, 40.0 * pace, 0.5 * pace];
        let scene = described(&format!(
            "gravity = [0, -10, 0]
            [[fluid]]
            dimensions = 2
            size = [0, 0, 0]
            spacing = {spacing:e}
            at = [0, 0, 0]
            density = 1000
            sound = {sound:e}
            inflow = {{ size = [0, {width:e}, 0], at = [0, 0, 0], velocity = [{speed:e}, 0, 0], duration = {until:e} }}"
        ));
        let step = Control::Step(5e-4 * pace);
        let mut run = Simulation::new(scene, method("verlet"), step).unwrap();
        for k in 1..=5 {
            let t = 0.2 * f64::from(k) * until;
            run.advance_to(t).unwrap();
            let free = flowing(&run);
            let area = free.len() as f64 * spacing * spacing;
            let expected = speed * width * t;
            assert!((area - expected).abs() < 0.51 * spacing * width, "{area} {expected}");
            // The first layer has flown all the time since its release.
            let first = free.iter().filter(|i| run.scene().state[**i] > -0.6 * spacing);
            let places: Vec<_> = first.map(|i| run.position(*i)).collect();
            let mean = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
            let flown = t - 0.5 * spacing / speed;
            let exact = Vector3::new(speed * flown, -5.0 * flown * flown, 0.0);
            assert_eq!(places.len(), 5);
            assert!((mean - exact).norm() < 0.01 * exact.norm(), "{mean:?} {exact:?}");
        }
        assert_eq!(flowing(&run).len(), 125);
        assert!(run.gained().is_none());
    }
}

/// Water rises in a tank as much flows in through its floor, over its width.
#[test]
fn a_tank_fills() {
    let scene = described(
        "gravity = [0, -10, 0]
        [[fluid]]
        dimensions = 2
        size = [0.8, 0.2, 0]
        spacing = 0.04
        at = [0.4, 0.1, 0]
        density = 1000
        sound = 20
        viscosity = 0.04
        tank = { size = [0.8, 0.6, 0], at = [0.4, 0.3, 0] }
        inflow = { size = [0.16, 0, 0], at = [0.4, 0, 0], velocity = [0, 0.5, 0], duration = 1.28 }",
    );
    let mut run = Simulation::new(scene, method("verlet"), Control::Step(5e-4)).unwrap();
    let level = |run: &Simulation| {
        let heights = flowing(run).into_iter().map(|i| run.position(i).y);
        2.0 * heights.sum::<f64>() / flowing(run).len() as f64
    };
    let before = level(&run);
    run.advance_to(2.5).unwrap();
    let rise = level(&run) - before;
    // The water is compressed by g h / 2 c2 = 0.4 % of its height.
    assert!((rise - 0.128).abs() < 0.035 * 0.128, "{rise}");
}
