//! Rigid bodies that fall, bounce, slide, roll and rest move alike in all units of length, mass and
//! time.

use a3_core::integrators;
use a3_scenes::Setup;

use crate::alike::Known;
use crate::chance::Chance;
use crate::frames::Frame;
use crate::told;

/// Methods by which scenes run: explicit, splitting, implicit, and with a tolerance.
const METHODS: [&str; 5] = ["rk4", "verlet", "implicit", "dopri5", "bdf"];

/// Default number of scenes, each run by one method. `A3_SCENES` sets another, and `A3_FIRST` the
/// first; all scenes then run by all methods.
const SCENES: usize = 10;

/// Units of length, mass and time (m, kg, s) in those of the scene, one over each other.
const UNITS: [[f64; 3]; 5] = [
    [1000.0, 1.0, 1.0],
    [1.0, 1000.0, 1.0],
    [1.0, 1.0, 1000.0],
    [39.37, 0.07, 3.6],
    [39.37, 0.07, 1.0],
];

/// Creates a scene in these units.
fn scene(seed: u64, [m, kg, s]: [f64; 3]) -> String {
    let chance = &mut Chance(seed);
    let gravity = -9.81 * m / (s * s);
    let mut text = vec![format!("gravity = [0, {gravity:e}, 0]\n")];
    let skin = |chance: &mut Chance| {
        let friction = chance.within((0.05, 0.8, false)) * f64::from(chance.below(2) as u32);
        let restitution = chance.within((0.2, 1.0, false)) * f64::from(chance.below(2) as u32);
        format!("friction = {friction:e}\nrestitution = {restitution:e}\n")
    };
    let thick = if chance.once_in(2) {
        format!("thickness = {:e}\n", 0.004 * m)
    } else {
        String::new()
    };
    let ground = skin(chance);
    text.push(if chance.once_in(2) {
        format!(
            "[[box]]\ncenter = [0, {:e}, 0]\nsize = [{:e}, {m:e}, {:e}]\n{ground}{thick}",
            -0.5 * m,
            8.0 * m,
            9.0 * m
        )
    } else {
        format!("[floor]\nheight = 0\n{ground}{thick}")
    });
    let mut foot = [-0.4, 0.001, 0.3];
    for _ in 0..=chance.below(3) {
        let [a, b, c] = chance.triple((0.1, 0.3, false));
        let (part, height) = match chance.below(4) {
            0 => (format!("ball = {:e}", a * m), a),
            1 => (
                format!("capsule = [{:e}, {:e}]", b * m, 0.5 * a * m),
                0.5 * (a + b),
            ),
            2 => (format!("file = \"solid.obj\", scale = {:e}", a * m), a),
            _ => (
                format!("box = [{:e}, {:e}, {:e}]", a * m, b * m, c * m),
                0.5 * b,
            ),
        };
        foot[1] += height;
        let velocity = chance.triple((-1.0, 1.0, false)).map(|v| v * m / s);
        let spin = chance.triple((-3.0, 3.0, false)).map(|v| v / s);
        let at = foot.map(|x| x * m);
        foot[1] += height + chance.within((0.005, 0.05, true));
        text.push(format!(
            "[[body]]\nparts = [{{ {part} }}]\nat = {at:?}\nmass = {:e}\nvelocity = {velocity:?}\n",
            kg * chance.within((0.1, 10.0, true))
        ));
        if chance.once_in(2) {
            text.push(format!("spin = {spin:?}\n"));
        }
        text.push(skin(chance));
    }
    text.concat()
}

fn build(seed: u64, units: [f64; 3]) -> Setup {
    let text = scene(seed, units);
    let mut setup = crate::build(&text)
        .unwrap()
        .unwrap_or_else(|| panic!("{text}"));
    setup.defaults.step_scale = units[2];
    setup
}

#[test]
fn bodies_move_alike_in_all_units() {
    let (count, first) = (told("A3_SCENES", SCENES), told("A3_FIRST", 0));
    let mut faults = vec![];
    for seed in first..first + count {
        let own = build(seed as u64, [1.0; 3]);
        for (k, method) in METHODS.iter().enumerate() {
            if count == SCENES && seed % METHODS.len() != k {
                continue;
            }
            let method = integrators::find(method).unwrap();
            let mut known = Known::new(&own, method).unwrap();
            for units in UNITS {
                // The first step of a method with a tolerance is at most 0.01 s.
                if units[2] != 1.0 && method.default_control.tolerance().is_some() {
                    continue;
                }
                let frame = Frame::in_units(units[0], units[2]);
                if let Err(why) = known.compare(&frame, &build(seed as u64, units)) {
                    faults.push(format!("scene {seed}, {}, {units:?}: {why}", method.name));
                }
            }
        }
    }
    assert!(
        faults.is_empty(),
        "{} faults:\n{}",
        faults.len(),
        faults.join("\n")
    );
}
