//! Work on a run is integrated over each step, for all that drives it and however often it is
//! shown.

use a3_core::accuracy::{self, Frames};
use a3_core::{Cause, Control, Error, Simulation};

use super::common::{described, method};

/// Random numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let unit = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }
}

/// A mass (1 kg) on a spring of 1 m at rest, whose other end moves as a sin(w t + phase).
#[derive(Clone, Copy, Debug)]
struct Shaken {
    stiffness: f64,
    damping: f64,
    amplitude: f64,
    rate: f64,
    phase: f64,
}

impl Shaken {
    fn random(random: &mut Random) -> Self {
        let stiffness = 10f64.powf(random.between(1.0, 5.0));
        let own = f64::sqrt(stiffness);
        Self {
            stiffness,
            damping: random.between(0.0, 0.2) * own,
            amplitude: random.between(0.001, 0.05),
            rate: own * random.between(0.2, 3.0),
            phase: random.between(0.0, 6.0),
        }
    }

    fn scene(&self) -> String {
        let Self { stiffness, damping, amplitude, rate, phase } = self;
        let begin = amplitude * phase.sin();
        format!(
            "[particles]\npositions = [[0, 0, 0], [{}, 0, 0]]\nmass = 1\n\
             springs = [[0, 1, {stiffness}, 1, {damping}]]\n[[pin]]\nparticles = [0]\n\
             sine = {{ center = [0, 0, 0], amplitude = [{amplitude}, 0, 0], rate = {rate}, phase = {phase} }}\n",
            1.0 + begin
        )
    }

    /// Work of the pin until then (s), by the classical Runge-Kutta method on the distance of the
    /// mass from its place at rest, its velocity and the work.
    fn work(&self, until: f64) -> f64 {
        let f = |t: f64, [u, v, _]: [f64; 3]| {
            let (sine, cosine) = (self.rate * t + self.phase).sin_cos();
            let (p, speed) = (self.amplitude * sine, self.amplitude * self.rate * cosine);
            let pull = self.stiffness * (u - p) + self.damping * (v - speed);
            [v, -pull, -pull * speed]
        };
        let fastest = self.rate.max(self.stiffness.sqrt());
        let count = (until * fastest * 200.0).ceil();
        let h = until / count;
        let mut y = [self.amplitude * self.phase.sin(), 0.0, 0.0];
        for k in 0..count as usize {
            let t = k as f64 * h;
            let add = |a: [f64; 3], s: f64| [0, 1, 2].map(|i| y[i] + s * a[i]);
            let a = f(t, y);
            let b = f(t + 0.5 * h, add(a, 0.5 * h));
            let c = f(t + 0.5 * h, add(b, 0.5 * h));
            let d = f(t + h, add(c, h));
            y = [0, 1, 2].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y[2]
    }
}

/// A number of the balance of a run (J).
fn balance(run: &Simulation, key: &str) -> f64 {
    let balance = serde_json::to_value(run.moment().run.balance).unwrap();
    balance[key].as_f64().unwrap()
}

#[test]
fn work_of_pins_is_that_of_the_exact_motion() {
    let mut random = Random(36);
    for _ in 0..20 {
        let shaken = Shaken::random(&mut random);
        let own = shaken.stiffness.sqrt().max(shaken.rate);
        let until = 60.0 / own;
        for (name, control, within) in [
            ("rk4", Control::Step(0.1 / own), 1e-3),
            ("pefrl", Control::Step(0.1 / own), 1e-3),
            ("dop853", Control::Tolerance(1e-8), 1e-2),
            ("dopri5", Control::Tolerance(1e-6), 1e-2),
            ("verlet", Control::Step(0.02 / own), 2e-2),
            ("implicit-midpoint", Control::Step(0.02 / own), 2e-2),
        ] {
            let Some(method) = a3_core::integrators::find(name) else { panic!("no method {name}") };
            if method.positions_only() && shaken.damping > 0.0 {
                continue;
            }
            let scene = described(&shaken.scene());
            let mut run = Simulation::new(scene, method, control).unwrap();
            // Work is known at the ends of steps.
            while run.time() < until {
                run.take_steps(1).unwrap();
            }
            let (work, turnover) = (balance(&run, "work"), balance(&run, "turnover"));
            let off = (work - shaken.work(run.time())).abs() / turnover;
            assert!(off < within, "{name} on {shaken:?}: {off}");
            assert_eq!(run.gained(), None, "{name} on {shaken:?}");
        }
    }
}

#[test]
fn how_often_one_looks_changes_no_work() {
    let shaken = Shaken::random(&mut Random(7));
    for (name, control) in [("verlet", Control::Step(0.001)), ("dopri5", Control::Tolerance(1e-5))]
    {
        let [once, often] = [1, 97].map(|frames| {
            let scene = described(&shaken.scene());
            let mut run = Simulation::new(scene, method(name), control).unwrap();
            for k in 1..=frames {
                run.advance_to(0.5 * f64::from(k) / f64::from(frames)).unwrap();
            }
            ["work", "turnover", "gain"].map(|key| balance(&run, key).to_bits())
        });
        assert_eq!(once, often, "{name}");
    }
}

/// A shaker at 60 Hz, which has the same phase at each of sixty checks a second.
#[test]
fn a_shaker_is_not_accused() {
    let shaker = "[particles]\npositions = [[0, 0, 0], [1, 0, 0]]\nmass = 1\n\
        springs = [[0, 1, 142122.3, 1, 4]]\n[[pin]]\nparticles = [0]\n\
        sine = { amplitude = [0.001, 0, 0], rate = 376.99111843, phase = 1.5707963 }\n";
    for (name, control) in [
        ("rk4", Control::Step(1.0 / 6000.0)),
        ("dop853", Control::Tolerance(1e-8)),
        ("verlet", Control::Step(1.0 / 6000.0)),
        ("implicit", Control::Step(1.0 / 6000.0)),
    ] {
        let mut run = Simulation::new(described(shaker), method(name), control).unwrap();
        run.advance_to(2.0).unwrap();
        run.conclude().unwrap();
        assert_eq!(run.gained(), None, "{name}");
    }
    // A step beyond the limit is still detected.
    let mut run = Simulation::new(described(shaker), method("rk4"), Control::Step(0.0078)).unwrap();
    let end = run.advance_to(2.0).and_then(|()| run.conclude());
    assert!(end.is_err() || run.gained().is_some());
}

/// What drives a scene is not accused because there are many particles: a motor, or a pin that
/// jerks, beside a basin, and water that begins to flow in. A step that is too long still is.
#[test]
fn many_particles_hide_no_work() {
    let basin = "[[fluid]]\ndimensions = 2\nsize = [1, 0.5, 0]\nspacing = 0.05\nat = [0.5, 0.25, 0]\n\
        density = 1000\nsound = 40\ntank = { size = [1, 1, 0], at = [0.5, 0.5, 0] }\n";
    let motor = "[[body]]\nparts = [{ box = [0.1, 0.5, 1] }]\ndensity = 1000\nat = [0.5, 2, 0]\n\
        [[joint]]\nbody = 0\nhinge = { at = [0.5, 2, 0], axis = [0, 0, 1], torque = 10000, speed = 6 }\n";
    let pin = "[particles]\npositions = [[0, 3, 0], [0, 3.5, 0]]\nmass = 1\n\
        springs = [[0, 1, 5000, 0.5, 1]]\n[[pin]]\nparticles = [0]\n\
        shift = { by = [0.1, 0, 0], start = 0.105, end = 0.11 }\n";
    let jet = "[[fluid]]\ndimensions = 2\nsize = [1, 1, 0]\nspacing = 0.05\nat = [0.5, 0.5, 0]\n\
        density = 1000\nsound = 30\n\
        inflow = { size = [0, 0.5, 0], at = [0, 0.5, 0], velocity = [1, 0, 0], duration = 1 }\n";
    let scenes = [motor.to_owned() + basin, pin.to_owned() + basin, jet.to_owned()];
    for (k, text) in scenes.iter().enumerate() {
        for (name, control) in [
            ("verlet", Control::Step(5e-4)),
            ("rk4", Control::Step(1e-3)),
            ("dopri5", Control::Tolerance(1e-5)),
        ] {
            let mut run = Simulation::new(described(text), method(name), control).unwrap();
            let end = run.advance_to(0.25).and_then(|()| run.conclude());
            end.unwrap_or_else(|why| panic!("scene {k} by {name}: {why}"));
            assert_eq!(run.gained(), None, "scene {k} by {name}");
        }
    }
    let mut run = Simulation::new(described(&scenes[1]), method("euler"), Control::Step(5e-3));
    let run = run.as_mut().unwrap();
    let end = run.advance_to(1.0).and_then(|()| run.conclude());
    assert!(end.is_err() || run.gained().is_some());
}

/// A pin that begins to move, after an adaptive method took a long step at rest, works from then
/// on.
#[test]
fn a_pin_that_begins_to_move_is_not_accused() {
    let text = "gravity = [0, -9.81, 0]\n[particles]\npositions = [[0, 0, 0], [0, -1.00981, 0]]\n\
        masses = [1, 0.1]\nsprings = [[0, 1, 100, 1, 0]]\n[[pin]]\nparticles = [0]\n\
        turn = { about = [1, 0, 0], axis = [0, 0, 1], rate = 2, start = 0.5 }\n";
    for name in ["dopri5", "rkf45", "verner65", "dprkn86", "bdf"] {
        let control = Control::Tolerance(1e-5);
        let mut run = Simulation::new(described(text), method(name), control).unwrap();
        let end = run.advance_to(1.5).and_then(|()| run.conclude());
        end.unwrap_or_else(|why| panic!("{name}: {why}"));
        assert_eq!(run.gained(), None, "{name}");
    }
}

#[test]
fn a_sheet_that_is_blown_away_is_not_accused() {
    for wind in [
        "[wind]\non = true\nforce_per_mass = [30, 0, 5]\n",
        "[wind]\non = true\nvelocity = [20, 3, 0]\nair_density = 1.2\n",
    ] {
        let sheet = format!(
            "[[cloth]]\ngrid = [16, 16]\nwidth = 1\nmass = 0.001\nstiffness = [40, 20, 1]\n{wind}"
        );
        let Ok(description) = a3_scenes::Description::parse(&sheet) else {
            continue;
        };
        let scene = description.build(None, &mut |_| unreachable!()).unwrap().scene;
        for (name, control) in [
            ("rk4", Control::Step(0.002)),
            ("verlet", Control::Step(0.002)),
            ("dopri5", Control::Tolerance(1e-4)),
            ("implicit", Control::Step(0.01)),
        ] {
            let mut run = Simulation::new(scene.clone(), method(name), control).unwrap();
            let end = run.advance_to(3.0).and_then(|()| run.conclude());
            if let Err(Error::BlowUp(lost)) = end {
                panic!("{name}: {lost}");
            }
            assert_eq!(run.gained(), None, "{name}");
        }
    }
}

/// Energy that a step which is too long creates between two tears does not count as that of the
/// tears.
#[test]
fn tears_forgive_their_own_change_only() {
    let tear = include_str!("../../../../docs/scenes/tear.toml");
    let run = |h: f64| {
        let mut run = Simulation::new(described(tear), method("rk4"), Control::Step(h)).unwrap();
        let end = run.advance_to(4.0).and_then(|()| run.conclude());
        end.is_err() || run.gained().is_some()
    };
    assert!(run(0.005));
    assert!(!run(0.002));
}

/// Springs that stretch a thousandfold within 0.06 s, in a scene of 5 mm.
#[test]
fn a_run_shorter_than_a_look_is_looked_at() {
    let short = "gravity = [0, -9.81, 0]\n[[chain]]\nparticles = 6\nfrom = [0, 0, 0]\n\
        to = [0.005, 0, 0]\nmass = 1e-6\nstiffness = 0.2\npin = [{ at = [\"first\"] }]\n";
    let mut run = Simulation::new(described(short), method("v"), Control::Step(0.0028)).unwrap();
    let end = run.advance_to(0.06).and_then(|()| run.conclude());
    let Err(Error::BlowUp(lost)) = end else {
        panic!("it went on");
    };
    assert!(matches!(lost.cause, Cause::Gained { .. } | Cause::Away { .. }), "{lost}");
    assert_eq!(run.conclude(), Err(lost.into()));
    // A chart sees it too.
    let mut run = Simulation::new(described(short), method("v"), Control::Step(0.0028)).unwrap();
    let end = accuracy::run(&mut run, &Frames::new(0.06), &|| true, None);
    assert!(end.unwrap().flatten().is_some());
}

/// A capsule of a million kilometres turns past a jelly: hundreds of planes are needed to find that
/// they stay apart, and count as work. A capsule of a metre needs no more than an evaluation
/// includes.
#[test]
fn searches_for_impacts_that_take_long_are_work() {
    let work = |length: &str| {
        let scene = described(&format!(
            "self_collision = true
            [[jelly]]
            grid = [3, 3, 3]
            size = [0.4, 0.5, 0.3]
            mass = 0.15
            stiffness = [5, 5, 50]
            at = [0.1, -0.5, 0]
            [[capsule]]
            from = [-1.5, -0.3, 2]
            to = [-0.6, -0.8, {length}]
            radius = 0.15
            turn = {{ axis = [-0.5, 0.7, 0.5], rate = -17 }}"
        ));
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.001)).unwrap();
        run.advance_to(0.4).unwrap();
        run.work()
    };
    let [long, short] = ["-1e9", "1"].map(work);
    assert_eq!(short.algebra, 0.0);
    assert!(long.total() > 2.0 * long.evaluations as f64, "{long:?}");
}
