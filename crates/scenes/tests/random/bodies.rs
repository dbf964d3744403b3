//! Random rigid bodies that fall on ground and on one another, bounce, slide, roll, rest and stack.

use serde_json::{Value, json};

use crate::chance::Chance;

/// Gap below a body at first (m).
const GAPS: [f64; 4] = [0.0, 1e-3, 5e-3, 5e-2];

/// Adds friction and restitution to a body or an obstacle, or neither.
fn roughen(table: &mut Value, chance: &mut Chance) {
    if chance.once_in(2) {
        table["friction"] = json!(chance.within((0.05, 0.8, false)));
    }
    if chance.once_in(2) {
        table["restitution"] = json!(chance.within((0.2, 1.0, false)));
    }
}

/// Creates a scene, whose units of length, mass and time are these parts of m, kg and s.
pub fn scene(seed: u64, [m, kg, s]: [f64; 3]) -> Value {
    let chance = &mut Chance(seed);
    let mut scene = json!({ "gravity": [0.0, -9.81 * m / (s * s), 0.0] });
    let is_floor = chance.once_in(2);
    let mut ground = if is_floor {
        json!({ "height": 0.0 })
    } else {
        json!({ "center": [0.0, -0.5 * m, 0.0], "size": [8.0 * m, m, 9.0 * m] })
    };
    roughen(&mut ground, chance);
    if chance.once_in(2) {
        ground["thickness"] = json!(0.004 * m);
    }
    if is_floor {
        scene["floor"] = ground;
    } else {
        scene["box"] = json!([ground]);
    }
    let mut foot = [-0.4, 0.0, 0.3];
    let mut all = vec![];
    for _ in 0..=chance.below(3) {
        let [a, b, c] = chance.triple((0.1, 0.3, false));
        let (part, [below, above]) = match chance.below(4) {
            0 => (json!({ "ball": a * m }), [a, a]),
            1 => {
                let height = 0.5 * (a + b);
                (json!({ "capsule": [b * m, 0.5 * a * m] }), [height, height])
            }
            2 => (json!({ "file": "solid.obj", "scale": a * m }), [a, a]),
            _ => {
                let height = 0.5 * b;
                (json!({ "box": [a * m, b * m, c * m] }), [height, height])
            }
        };
        foot[1] += below + chance.from(&GAPS);
        let mut body = json!({
            "parts": [part],
            "at": foot.map(|x| x * m),
            "mass": kg * chance.within((0.1, 10.0, true)),
        });
        foot[1] += above;
        if !chance.once_in(3) {
            body["velocity"] = json!(chance.triple((-1.0, 1.0, false)).map(|v| v * m / s));
        }
        if chance.once_in(2) {
            body["spin"] = json!(chance.triple((-3.0, 3.0, false)).map(|v| v / s));
        }
        roughen(&mut body, chance);
        all.push(body);
    }
    scene["body"] = json!(all);
    scene
}
