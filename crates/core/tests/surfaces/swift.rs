//! Small, thin and fast obstacles, and cloths that hit them within a step, at random.
//!
//! A cloth is thrown. Until it hits something, nothing strains it, and it flies along a parabola,
//! so adaptive steps become long. Whether it hits an obstacle is known from a run with steps so
//! short that no course deviates from a line by more than a hundredth of the layer in them.

use a3_core::{Control, Method, Simulation, Vector3};

use crate::common::{described, method};
use crate::pairs::Random;

/// Number of scenes; this environment variable sets another one.
const TRIES: usize = 40;
const MORE: &str = "A3_TRIES";

/// Length of a run (s), and fine step (s).
const UNTIL: f64 = 0.7;
const FINE: f64 = 2e-4;

/// Random numbers.
struct Chance(Random);

impl Chance {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    /// A random number with a uniform logarithm.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn vector(&mut self, size: f64) -> Vector3<f64> {
        self.0.vector() * size
    }
}

fn text(v: Vector3<f64>) -> String {
    format!("[{}, {}, {}]", v.x, v.y, v.z)
}

/// Cloth, and the place of its centre in free flight, on a parabola.
struct Flight {
    toml: String,
    velocity: Vector3<f64>,
    gravity: f64,
}

impl Flight {
    fn new(random: &mut Chance) -> Self {
        let gravity = random.between(2.0, 12.0);
        let velocity = Vector3::new(0.0, random.between(0.0, 5.0), 0.0) + random.vector(2.0);
        let thickness = random.scale(1e-3, 1e-2);
        let toml = format!(
            "self_collision = true
            gravity = [0, -{gravity}, 0]
            [[cloth]]
            grid = [4, 4]
            width = 0.3
            density = 0.2
            stiffness = [40, 20, 2]
            at = [0, 0, -0.15]
            down = [0, 0, 1]
            thickness = {thickness}
            velocity = {}
            ",
            text(velocity)
        );
        Self { toml, velocity, gravity }
    }

    fn center(&self, t: f64) -> Vector3<f64> {
        self.velocity * t - Vector3::y() * (0.5 * self.gravity * t * t)
    }
}

/// Obstacle that is at the place of the cloth at some time.
fn obstacle(flight: &Flight, random: &mut Chance) -> String {
    let time = random.between(0.15, 0.6);
    let offset = Vector3::new(random.between(-0.1, 0.1), 0.0, random.between(-0.1, 0.1));
    let meets = flight.center(time) + offset;
    let thin = random.scale(2e-3, 3e-2);
    let kind = (random.0.unit() * 3.0) as usize;
    let motion = (random.0.unit() * 4.0) as usize;
    let speed = random.vector(8.0);
    let (center, path) = match motion {
        1 => {
            let rate = random.between(1.0, 12.0);
            let amplitude = random.vector(0.6);
            let phase = random.between(0.0, std::f64::consts::TAU);
            let away = amplitude * (rate * time + phase).sin();
            (
                meets - away,
                format!(
                    "sine = {{ amplitude = {}, rate = {rate}, phase = {phase} }}",
                    text(amplitude)
                ),
            )
        }
        2 => {
            let end = random.between(time + 0.02, 0.8);
            (meets - speed * time, format!("shift = {{ by = {}, end = {end} }}", text(speed * end)))
        }
        // It is still, or rotates.
        _ => (meets, String::new()),
    };
    let long = random.vector(0.2);
    let (center, turn) = if motion == 3 {
        // A blade whose end passes by.
        let rate = random.between(-15.0, 15.0);
        let axis = random.vector(1.0).normalize();
        let arm = random.vector(0.4);
        let arm = arm - axis * axis.dot(&arm);
        let turn = format!("turn = {{ axis = {}, rate = {rate} }}", text(axis));
        (meets + arm * 0.9, turn)
    } else {
        (center, String::new())
    };
    let shape = match kind {
        0 if motion != 3 => format!("[[sphere]]\ncenter = {}\nradius = {thin}", text(center)),
        0 | 1 => format!(
            "[[capsule]]\nfrom = {}\nto = {}\nradius = {thin}",
            text(center - long),
            text(center + long)
        ),
        _ => format!(
            "[[box]]\ncenter = {}\nsize = [{}, {thin}, {}]\nrotation = {}",
            text(center),
            0.4 * random.0.unit() + 0.02,
            0.4 * random.0.unit() + 0.02,
            text(random.vector(1.5))
        ),
    };
    format!("{shape}\n{path}\n{turn}\nthickness = 0.003\n")
}

/// Distance (m) of the middle of the cloth, at the end, from its place in free flight.
fn thrown(toml: &str, flight: &Flight, method: &'static Method, control: Control) -> Option<f64> {
    let mut run = Simulation::new(described(toml), method, control).ok()?;
    let start: Vector3<f64> = (0..16).map(|i| run.position(i)).sum::<Vector3<f64>>() / 16.0;
    run.advance_to(UNTIL).ok()?;
    let end: Vector3<f64> = (0..16).map(|i| run.position(i)).sum::<Vector3<f64>>() / 16.0;
    Some((end - start - (flight.center(UNTIL))).norm())
}

#[test]
fn nothing_passes_through_a_cloth_within_a_step() {
    let tries = std::env::var(MORE).map_or(TRIES, |n| n.parse().unwrap());
    let mut random = Chance(Random(7));
    let (mut met, mut missed) = (0, vec![]);
    for _ in 0..tries {
        let flight = Flight::new(&mut random);
        let toml = flight.toml.clone() + &obstacle(&flight, &mut random);
        let fine = thrown(&toml, &flight, method("verlet"), Control::Step(FINE));
        let tolerance = random.scale(1e-6, 1e-2);
        let Some(fine) = fine.filter(|fine| *fine > 0.02) else {
            continue;
        };
        met += 1;
        let adaptive =
            ["dopri5", "dop853", "bdf"].map(|name| (name, Control::Tolerance(tolerance)));
        let fixed = ["verlet", "rk4"].map(|name| (name, Control::Step(1.0 / 300.0)));
        for (name, control) in adaptive.into_iter().chain(fixed) {
            let found = thrown(&toml, &flight, method(name), control);
            if found.is_some_and(|found| found < 0.1 * fine) {
                missed.push(format!("{name} at {control}: {found:?} m instead of {fine}\n{toml}"));
            }
        }
    }
    println!("{tries} tried, {met} met, {} missed", missed.len());
    assert!(3 * met > tries && missed.is_empty(), "{}", missed.join("\n"));
}
