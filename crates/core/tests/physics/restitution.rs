//! Particles and bodies that rebound from simple obstacles, against closed forms and models.

use a3_core::{Control, Method, Simulation, integrators};

use crate::common::{described, method};

const G: f64 = 9.81;

/// A particle above a floor with restitution 0.8.
fn dropped(height: f64) -> String {
    format!(
        "gravity = [0, -{G}, 0]
        floor = {{ height = 0, restitution = 0.8 }}
        [particles]
        positions = [[0, {height}, 0]]
        mass = 0.3"
    )
}

fn run(text: &str, method: &'static Method, control: Control) -> Simulation {
    Simulation::new(described(text), method, control).unwrap()
}

/// Height and speed of a particle, dropped from a height, after t seconds: the exact bounces.
fn exact(mut height: f64, t: f64) -> [f64; 2] {
    let fall = (2.0 * height / G).sqrt();
    if t < fall {
        return [height - 0.5 * G * t * t, -G * t];
    }
    let mut left = t - fall;
    loop {
        height *= 0.64;
        let up = (2.0 * G * height).sqrt();
        if left < 2.0 * up / G {
            return [up * left - 0.5 * G * left * left, up - G * left];
        }
        left -= 2.0 * up / G;
    }
}

#[test]
fn a_particle_rebounds_to_the_square_of_its_restitution() {
    let apex = (2.0 / G).sqrt() * 1.8;
    for m in integrators::METHODS {
        let mut controls = vec![];
        if m.check_control(Control::Step(1e-3)).is_ok() {
            controls.push(Control::Step(1e-3));
        }
        if m.check_control(Control::Tolerance(1e-6)).is_ok() {
            controls.push(Control::Tolerance(1e-6));
        }
        for control in controls {
            for scale in [1e-3, 1.0, 100.0] {
                // Step proportional to the time of the fall.
                let control = match control {
                    Control::Step(h) => Control::Step(h * f64::sqrt(scale)),
                    tolerance @ Control::Tolerance(_) => tolerance,
                };
                let scene = described(&dropped(scale));
                if m.check(scene.model.system()).is_err() {
                    continue;
                }
                let mut run = Simulation::new(scene, m, control).unwrap();
                run.advance_to(apex * f64::sqrt(scale)).unwrap();
                let height = run.state()[1] / scale;
                assert!(
                    (height / 0.64 - 1.0).abs() < 0.01,
                    "{}, {control:?}, {scale} m: {height}",
                    m.name
                );
            }
        }
    }
}

/// Methods that are exact under constant forces are exact over five bounces, at any step.
#[test]
fn bounces_are_located() {
    for name in ["verlet", "rk4", "pefrl", "heun", "midpoint-implicit"] {
        let Some(m) = integrators::find(name) else {
            continue;
        };
        for step in [0.05, 0.0123, 1e-3] {
            let mut run = run(&dropped(1.0), m, Control::Step(step));
            for k in 1..=25 {
                let t = 0.1 * f64::from(k);
                run.advance_to(t).unwrap();
                let y = run.state();
                let [height, speed] = exact(1.0, t);
                let off = (y[1] - height).abs() + (y[4] - speed).abs();
                assert!(off < 1e-9, "{name} {step} at {t}: {off}");
            }
        }
    }
}

/// A particle that has come to rest lies still, and comes to rest no later than after the sum of
/// all bounces.
#[test]
fn bounces_come_to_rest() {
    let fall = (2.0 / G).sqrt();
    let end = fall * (1.0 + 2.0 * 0.8 / 0.2);
    for step in [0.02, 1e-3] {
        for name in ["verlet", "rk4", "implicit", "xpbd"] {
            let mut run = run(&dropped(1.0), method(name), Control::Step(step));
            run.advance_to(end * 1.1).unwrap();
            for _ in 0..50 {
                run.take_steps(1).unwrap();
                let y = run.state();
                assert!(y[1].abs() < 1e-12 && y[4].abs() < 1e-12, "{name}: {y:?}");
            }
        }
    }
}

/// On springs, bounces keep order 2.
#[test]
fn order_two_is_kept_over_bounces() {
    let text = "floor = { height = 0, restitution = 0.9 }
        [particles]
        positions = [[0, 0.7, 0], [0, 1.5, 0]]
        masses = [0.3, 1]
        springs = [[0, 1, 40, 0.8, 0]]
        velocities = [[0, -1, 0], [0.2, -1, 0]]";
    let end = |name: &str, step: f64| {
        let mut run = run(text, method(name), Control::Step(step));
        run.advance_to(1.7).unwrap();
        run.state().to_vec()
    };
    let best = end("rk4", 1e-5);
    for name in ["verlet", "rk4", "heun"] {
        let error = |step: f64| {
            // The mean over several steps, because errors vary with the place of a bounce in its
            // step.
            let errors = (0..8).map(|k| {
                let y = end(name, step / (1.0 + 0.05 * f64::from(k)));
                y.iter().zip(&best).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
            });
            errors.sum::<f64>().sqrt()
        };
        let order = (error(4e-3) / error(5e-4)).log2() / 3.0;
        assert!(order > 1.8, "{name}: {order}");
    }
}

/// A box that hits a particle throws it: v' = V + e (V - v), and friction changes the velocity by
/// mu times that.
#[test]
fn a_moving_box_throws_a_particle() {
    let text = "[[box]]
        center = [-1, 0, 0]
        size = [1, 4, 4]
        restitution = 0.5
        friction = 0.1
        shift = { by = [3, 0, 0], end = 1 }
        [particles]
        positions = [[0, 0, 0]]
        velocities = [[-0.5, 2, 0]]
        mass = 0.2";
    let mut run = run(text, method("rk4"), Control::Step(1e-2));
    let found = |run: &Simulation| {
        let y = run.state();
        [y[3], y[4]]
    };
    let before = found(&run);
    while found(&run) == before {
        run.take_steps(1).unwrap();
    }
    let [x, y] = found(&run);
    // The speed of the box at the touch follows from that of the particle.
    let of_box = (x + 0.5 * -0.5) / 1.5;
    let change = x + 0.5;
    assert!(of_box > 0.5, "{of_box}");
    assert!((y - (2.0 - 0.1 * change)).abs() < 1e-12, "{y} {change}");
    // The box touched the particle on the way, and is apart from it now.
    run.take_steps(1).unwrap();
    assert_eq!(found(&run), [x, y]);
}

/// Velocity (m/s) of the centre of the only body at the end of a run.
fn velocity_after(scene: &str, (name, control): (&str, Control), until: f64) -> [f64; 3] {
    let mut run = Simulation::new(described(scene), method(name), control).unwrap();
    run.advance_to(until).unwrap();
    let n = run.particles();
    std::array::from_fn(|axis| run.state()[(3 + axis) * n])
}

/// A corner of a thin box strikes a rough floor at an angle. Across the normal the box is far more
/// mobile in one direction than in the other, and friction turns the slide. The right velocity is
/// that of Newton's law of restitution and of Coulomb's law, opposite to the slide after the
/// impact, by a solver of nonlinear equations (`SciPy`'s `fsolve`).
#[test]
fn friction_is_opposite_to_the_slide_after_an_oblique_impact() {
    let scene = "gravity = [0, 0, 0]
        contact_gravity = 9.81
        floor = { height = 0, friction = 0.8, restitution = 0.8 }
        [[body]]
        parts = [{ box = [0.03297888409383632, 0.9297760087545308, 0.03645240857304532] }]
        mass = 2.1972109507280573
        at = [0, 1, 0]
        rotation = [1.3285348751252595, 0.28906235474867675, 0.33975492268034124]
        velocity = [-2.1103591447580863, -3.9453925227593447, -2.07982039626075]
        spin = [0.5476859026083369, -0.17300596024287174, -5.810549819518905]";
    let right = [-1.439_453_67, -1.847_860_86, -0.541_751_85];
    for (name, control) in [
        ("rk4", Control::Step(2e-4)),
        ("verlet", Control::Step(2e-4)),
        ("dop853", Control::Tolerance(1e-8)),
    ] {
        let found = velocity_after(scene, (name, control), 0.2271);
        for (found, right) in found.iter().zip(right) {
            assert!((found - right).abs() < 1e-4, "{name}: {found} {right}");
        }
    }
}

/// Corners of a box that spins strike a wall three times, the last of them on an arc that leads out
/// again within 7 ms. The right velocity is that of a model of the free rotation with events, by
/// `SciPy`.
#[test]
fn no_impact_on_an_arc_is_missed() {
    let scene = "gravity = [0, 0, 0]
        contact_gravity = 9.81
        [[box]]
        center = [0, 0, 0]
        size = [0.05, 1, 1]
        restitution = 0.6
        [[body]]
        parts = [{ box = [0.2, 0.1, 0.1] }]
        mass = 1
        at = [-2, 0, 0]
        velocity = [4, 0, 0]
        spin = [1, 2, 3]";
    for (name, control) in [
        ("rk4", Control::Step(1e-3)),
        ("dopri5", Control::Tolerance(1e-3)),
        ("verner65", Control::Tolerance(1e-5)),
        ("dop853", Control::Tolerance(1e-6)),
        ("bdf", Control::Tolerance(1e-6)),
    ] {
        let [found, ..] = velocity_after(scene, (name, control), 1.0);
        assert!((found + 1.2577).abs() < 3e-3, "{name}: {found}");
    }
}
