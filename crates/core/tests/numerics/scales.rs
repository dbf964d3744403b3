//! Adaptive steps do not depend on units, masses or the origin: in another unit that is a power of
//! two of the first, the motion has the same bits.

use crate::common::{described, method, size};
use crate::mixed::Numbers;
use a3_core::integrators::METHODS;
use a3_core::{Control, Method, Scene, Simulation};

/// A net of nine particles at random places, on a rough floor, in a unit of length that is the
/// fraction `unit` of a metre, around a point (m).
fn net(seed: u64, unit: f64, around: f64) -> Scene {
    let mut random = Numbers(seed);
    let mut next = |scale: f64| scale * random.between(-1.0, 1.0);
    let positions: Vec<_> = (0..9)
        .map(|i| {
            let (row, col) = (f64::from(i / 3), f64::from(i % 3));
            [row + next(0.2) + around, 1.0 + next(0.2), col + next(0.2)].map(|x| unit * x)
        })
        .collect();
    let velocities: Vec<_> = (0..9).map(|_| [0, 1, 2].map(|_| unit * next(2.0))).collect();
    let masses: Vec<_> = (0..9).map(|_| 1.5 + next(1.0)).collect();
    let mut springs = vec![];
    for i in 0..9usize {
        for j in (0..i).filter(|j| (i / 3 - j / 3) + (i % 3).abs_diff(j % 3) < 3) {
            let rest = unit * (1.0 + next(0.2));
            springs.push(format!(
                "[{i}, {j}, {:?}, {rest:?}, {:?}]",
                60.0 + next(30.0),
                0.3 + next(0.2)
            ));
        }
    }
    described(&format!(
        "gravity = [0, {:?}, 0]\nfloor = 0\n[particles]\npositions = {positions:?}\n\
         velocities = {velocities:?}\nmasses = {masses:?}\nsprings = [{}]\n",
        -10.0 * unit,
        springs.join(", ")
    ))
}

/// A run to a tolerance until a time (s).
fn run(scene: &Scene, method: &'static Method, tolerance: f64, until: f64) -> Simulation {
    let control = Control::Tolerance(tolerance);
    let mut run = Simulation::new(scene.clone(), method, control).unwrap();
    run.advance_to(until).unwrap_or_else(|e| panic!("{}: {e}", method.name));
    run
}

/// The adaptive methods that support a scene.
fn adaptive(scene: &Scene) -> impl Iterator<Item = &'static Method> {
    let system = scene.model.system();
    METHODS.iter().filter(move |m| m.is_adaptive() && m.check(system).is_ok())
}

#[test]
fn the_unit_of_length_does_not_matter() {
    for seed in 1..=4 {
        let metres = net(seed, 1.0, 0.0);
        for method in adaptive(&metres) {
            let expected = run(&metres, method, 1e-6, 1.0);
            for unit in [2f64.powi(-20), 2f64.powi(-10), 2f64.powi(7)] {
                let found = run(&net(seed, unit, 0.0), method, 1e-6, 1.0);
                let pairs = expected.state().iter().zip(found.state());
                let apart: Vec<_> = pairs.map(|(a, b)| a - b / unit).collect();
                assert!(size(&apart) == 0.0, "{} in {unit} m: {:e}", method.name, size(&apart));
                assert_eq!(found.steps(), expected.steps(), "{}", method.name);
            }
        }
    }
}

#[test]
fn the_distance_from_the_origin_does_not_matter() {
    for seed in 1..=2 {
        let (here, away) = (net(seed, 1.0, 0.0), net(seed, 1.0, 1024.0));
        for method in adaptive(&here) {
            // Before any contact with the floor, which depends on rounding errors of positions.
            let [a, b] = [&here, &away].map(|scene| run(scene, method, 1e-6, 0.2));
            let n = a.particles();
            let apart = (0..3 * n).map(|k| {
                let moved = if k < n { 1024.0 } else { 0.0 };
                a.state()[k] + moved - b.state()[k]
            });
            let apart = size(&apart.collect::<Vec<_>>());
            assert!(apart < 1e-7, "{}: {apart:e}", method.name);
            let [fewer, more] = [a.steps().min(b.steps()), a.steps().max(b.steps())];
            assert!(more - fewer <= 1 + fewer / 100, "{}: {fewer} {more}", method.name);
        }
    }
}

#[test]
fn a_free_rotation_does_not_depend_on_the_mass() {
    let stick = |density: f64| {
        described(&format!(
            "[[body]]\nparts = [{{ capsule = [1.0, 0.1] }}]\ndensity = {density:?}\nspin = [10, 3, 0]\n"
        ))
    };
    let (light, heavy) = (stick(100.0), stick(102_400.0));
    for method in adaptive(&light) {
        let [a, b] = [&light, &heavy].map(|scene| run(scene, method, 1e-6, 5.0));
        assert_eq!(a.steps(), b.steps(), "{}", method.name);
        let n = 3 * a.particles();
        let apart: Vec<_> = (0..n).map(|k| a.state()[k] - b.state()[k]).collect();
        assert!(size(&apart) < 1e-9, "{}: {:e}", method.name, size(&apart));
    }
}

#[test]
fn points_that_a_body_carries_do_not_count() {
    // A particle swings on a spring beside a brick at rest with eight points, or with 64 at the
    // same places: bodies at rest do not reduce the relative error of the particle.
    let beside = |parts: usize| {
        described(&format!(
            "gravity = [0, 0, 0]\n[particles]\npositions = [[0, 0, 0], [1.2, 0.1, 0]]\n\
             masses = [1, 1]\nsprings = [[0, 1, 100, 1, 0]]\npin = [{{ particles = [0] }}]\n\
             [[body]]\nparts = [{}]\ndensity = 100\nat = [3, 0, 0]\n",
            vec!["{ box = [1.0, 0.6, 0.2] }"; parts].join(", ")
        ))
    };
    let (few, many) = (beside(1), beside(8));
    for method in adaptive(&few) {
        let [a, b] = [&few, &many].map(|scene| run(scene, method, 1e-5, 2.0));
        assert_eq!((a.particles(), b.particles()), (11, 67));
        assert_eq!(a.steps(), b.steps(), "{}", method.name);
        assert_eq!(a.position(1), b.position(1), "{}", method.name);
    }
}

#[test]
fn the_energy_of_a_spinning_brick_stays() {
    let brick = described(
        "[[body]]\nparts = [{ box = [1.0, 0.6, 0.2] }]\ndensity = 100\nspin = [0.01, 0.02, 20]\n",
    );
    let drift = |name: &str, tolerance: f64| {
        let energy = |run: &Simulation| run.energy().unwrap().total();
        let mut run =
            Simulation::new(brick.clone(), method(name), Control::Tolerance(tolerance)).unwrap();
        let (begin, mut worst) = (energy(&run), 0.0f64);
        for second in 1..=60 {
            run.advance_to(f64::from(second)).unwrap();
            worst = worst.max((energy(&run) / begin - 1.0).abs());
        }
        worst
    };
    for name in ["bdf", "dopri5", "dop853"] {
        let drifts = [1e-4, 1e-6, 1e-8].map(|tolerance| drift(name, tolerance));
        println!("{name}: {drifts:?}");
        assert!(drifts[0] < 1e-3 && drifts[2] < 0.2 * drifts[0], "{name}: {drifts:?}");
    }
}

#[test]
fn a_light_particle_on_a_stiff_spring_is_not_refused() {
    // Along x, 1 m + 0.1 m cos(1e5 t); gravity acts perpendicular to it.
    let scene = described(
        "gravity = [0, -9.81, 0]\n[particles]\npositions = [[0, 0, 0], [1.1, 0, 0]]\n\
         masses = [1, 1e-9]\nsprings = [[0, 1, 10, 1, 0]]\npin = [{ particles = [0] }]\n",
    );
    for method in adaptive(&scene) {
        let until = 2e-3;
        let found = run(&scene, method, 1e-7, until).position(1).x;
        let exact = 1.0 + 0.1 * (1e5f64 * until).cos();
        assert!((found - exact).abs() < 1e-3, "{}: {found} {exact}", method.name);
    }
}

#[test]
fn scenes_have_a_size_of_their_own() {
    let radius = |text: &str| described(text).extent().1;
    let one = |rest: &str| {
        format!("gravity = [0, 0, 0]\n{rest}\n[particles]\npositions = [[5, 2, 0]]\nmasses = [1]\n")
    };
    for (text, expected) in [
        ("[particles]\npositions = [[5, 0, 0], [5.002, 0, 0]]\nmasses = [1, 1]\n".into(), 1e-3),
        ("[particles]\npositions = [[5, 0, 0], [5, 0, 0]]\nmasses = [1, 1]\nsprings = [[0, 1, 10, 0.4, 0]]\n".into(), 0.2),
        ("[[body]]\nparts = [{ ball = 0.03 }]\ndensity = 100\nat = [7, 7, 7]\n".into(), 0.03),
        (one("floor = 1.75"), 0.25),
        (one("[[sphere]]\nradius = 0.5\ncenter = [5, 1, 0]\n[[sphere]]\nradius = 0.5\ncenter = [5, 12, 0]"), 1.0),
        (one("") + "velocities = [[0, 0.03, 0.04]]\n", 0.05),
        (one("").replace("[0, 0, 0]", "[0, -8e-3, 0]"), 4e-3),
        (one(""), 1.0),
        ("[circle]\nstart = [0.03, 0.04, 0]\n".into(), 0.05),
    ] {
        let found: f64 = radius(&text);
        assert!((found / expected - 1.0).abs() < 1e-9, "{text}: {found} m");
    }
}
