//! Rebounds that die out, and friction in them, against states of a model that shares no code with
//! these runs: a Runge-Kutta method of order 8 in steps of 2 ms, which end at each event, in
//! Python.

use crate::common::{described, method};
use a3_core::accuracy::{Demand, Frames, Metric, Reference, choose_among};
use a3_core::{Control, Simulation};

/// Scene, the time (s) at which it is compared, and the positions there (m).
struct Case {
    scene: &'static str,
    until: f64,
    end: [[f64; 3]; 2],
}

/// Two masses on a spring that rebound dozens of times, in ever shorter flights, until friction
/// holds one of them; the same with damping and hardly a loss; and one on a pinned spring.
const CASES: [Case; 3] = [
    Case {
        scene: "gravity = [0, -9.81, 0]
            floor = { height = 0, friction = 0.3, restitution = 0.7 }
            [particles]
            positions = [[0, 0.1, 0], [0.186, 0.335, 0]]
            velocities = [[0.294, 0, 0], [0.902, -0.975, 0]]
            masses = [0.2, 0.3]
            springs = [[0, 1, 81, 0.291, 0]]",
        until: 1.0,
        end: [[0.065_898_641_799_19, 0.0, 0.0], [0.351_762_598_850_57, 0.023_675_317_409_09, 0.0]],
    },
    Case {
        scene: "gravity = [0, -9.81, 0]
            floor = { height = 0, friction = 0.1, restitution = 0.95 }
            [particles]
            positions = [[0, 0.1, 0], [0.2, 0.25, 0]]
            velocities = [[0.3, 0, 0], [-0.4, -0.5, 0]]
            masses = [0.4, 0.2]
            springs = [[0, 1, 70, 0.25, 0.3]]",
        until: 1.5,
        end: [
            [-0.044_737_369_782_53, 0.018_002_367_571_07, 0.0],
            [0.206_821_424_355_55, 0.079_085_829_969_23, 0.0],
        ],
    },
    Case {
        scene: "gravity = [0, -9.81, 0]
            floor = { height = 0, friction = 0.2, restitution = 0.5 }
            [particles]
            positions = [[0, 0.23, 0], [-0.05, 0.7, 0]]
            velocities = [[0.15, 0, 0], [0, 0, 0]]
            masses = [0.27, 1]
            springs = [[0, 1, 5.5, 0.58, 0]]
            pin = [{ particles = [1] }]",
        until: 1.0,
        end: [[0.023_731_726_827_47, 0.0, 0.0], [-0.05, 0.7, 0.0]],
    },
];

impl Case {
    /// Returns the largest error of a coordinate (m) of positions, n x 3.
    fn error(&self, x: &[f64]) -> f64 {
        let n = self.end.len();
        let errors = (0..3 * n).map(|k| (x[k] - self.end[k % n][k / n]).abs());
        errors.fold(0.0, f64::max)
    }

    /// Returns the error of a run (m).
    fn error_of(&self, name: &str, control: Control) -> f64 {
        let mut run = Simulation::new(described(self.scene), method(name), control).unwrap();
        run.advance_to(self.until).unwrap();
        self.error(&run.state()[..6])
    }
}

#[test]
fn no_rebound_is_too_short_to_be_located() {
    for case in &CASES {
        for name in ["dop853", "verner65", "dopri5", "rkf45"] {
            for (tolerance, most) in [(1e-6, 2e-5), (1e-9, 1e-8), (1e-12, 2e-11)] {
                let error = case.error_of(name, Control::Tolerance(tolerance));
                assert!(error < most, "{name} {tolerance}: {error:e}\n{}", case.scene);
            }
        }
    }
}

/// What a reference says of its own uncertainty is true, and so is what a choice promises.
#[test]
fn references_of_rebounds_know_their_errors() {
    for case in &CASES {
        let scene = described(case.scene);
        let go_on = || true;
        let frames = Frames::new(case.until);
        let reference = Reference::finest(&scene, frames, &go_on).unwrap().unwrap();
        let floor = reference.floor.position;
        let [x, _] = reference.motion(&scene.model, case.until);
        let error = case.error(&x);
        assert!(floor < 1e-10, "{floor:e}\n{}", case.scene);
        assert!(error < floor + 1e-13, "{error:e} {floor:e}\n{}", case.scene);
        let methods = ["dop853", "verner65", "rkf45"].map(method);
        let demand = Demand { metric: Metric::Position, error: 1e-6, timed: false };
        let found = choose_among(&methods, &scene, &reference, demand, &go_on, |_| {});
        let found = found.unwrap().unwrap();
        assert!(!found.is_empty());
        for choice in found {
            let error = case.error_of(choice.method.name, choice.control);
            assert!(error <= 3f64.sqrt() * demand.error, "{} {error:e}", choice.method.name);
        }
    }
}

/// Friction depends on the direction of a velocity, which Nyström pairs do not know.
#[test]
fn nystrom_pairs_refuse_friction() {
    let smooth = CASES[0].scene.replace("friction = 0.3, ", "");
    for name in ["dprkn86", "dprkn1210"] {
        let refuses = |text: &str| method(name).check(described(text).model.system()).is_err();
        assert!(refuses(CASES[0].scene) && !refuses(&smooth), "{name}");
    }
}

/// Two sliders that a force drives to their ends, two bars that fall onto the ends of their hinges,
/// and two masses that fall until their ropes tighten. Each rebounds in ever shorter flights, and
/// one of the two is at rest before the other.
#[test]
fn two_things_come_to_rest_at_their_ends() {
    let slider = |k: usize, restitution: f64, force: f64| {
        format!(
            "[[body]]\nparts = [{{ ball = 0.1 }}]\nmass = 1.5\nat = [{}, 0, 0]\n[[joint]]\nbody = {k}\n\
             slider = {{ axis = [0, 1, 0], limits = [-1, 0.3], restitution = {restitution}, force = {force} }}\n",
            2 * k
        )
    };
    let sliders = [slider(0, 0.41, 5.7), slider(1, 0.49, 7.5)].concat();
    let hinge = |k: usize, restitution: f64, limit: f64| {
        format!(
            "[[body]]\nparts = [{{ box = [0.6, 0.1, 0.1] }}]\nmass = 1\nat = [{}, 0, 0]\n[[joint]]\nbody = {k}\n\
             hinge = {{ at = [{}, 0, 0], axis = [0, 0, 1], limits = [{limit}, 1], restitution = {restitution} }}\n",
            2.0 * k as f64 + 0.3,
            2 * k
        )
    };
    let hinges =
        ["gravity = [0, -9.81, 0]\n", &hinge(0, 0.5, -0.3), &hinge(1, 0.37, -0.3)].concat();
    let rope = |i: usize, restitution: f64| {
        format!(
            "[[constraint]]\nrope = [{i}, {}]\nlength = 0.6\nrestitution = {restitution}\n",
            i + 1
        )
    };
    let ropes = format!(
        "gravity = [0, -9.81, 0]\n[particles]\npositions = [[0, 0, 0], [0, -0.1, 0], [1, 0, 0], [1, -0.3, 0]]\n\
         mass = 1\npin = [{{ particles = [0, 2] }}]\n{}{}",
        rope(0, 0.5),
        rope(2, 0.15)
    );
    let runs = [
        ("rk4", 0.01),
        ("verlet", 0.005),
        ("trapezoid", 0.005),
        ("dopri5", 1e-5),
        ("dop853", 1e-6),
        ("verner65", 1e-5),
        ("bdf", 1e-4),
    ];
    for (name, value) in runs {
        for scene in [&sliders, &hinges, &ropes] {
            let method = method(name);
            let mut run = Simulation::new(described(scene), method, method.control(value)).unwrap();
            run.advance_to(4.0).unwrap();
            let speeds = run.velocities();
            let fastest = speeds.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            assert!(fastest < 1e-6, "{name} moves at {fastest:e} m/s in\n{scene}");
            let evaluations = run.work().evaluations;
            assert!(evaluations < 60_000, "{name} takes {evaluations} evaluations in\n{scene}");
        }
    }
}
