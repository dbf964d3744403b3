//! Keys of a scene that refer to its particles by number, and its state.

use std::collections::BTreeSet;

use a3_core::Network;
use a3_scenes::Setup;
use serde_json::{Value, json};

use crate::chance::Chance;
use crate::grammar::{Grammar, NUMBERED};

/// Adds some of these keys to a scene that was built without them. Returns the keys.
pub fn add(
    grammar: &Grammar,
    scene: &mut Value,
    setup: &Setup,
    chance: &mut Chance,
) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for key in NUMBERED {
        // Few scenes have bodies that could be joined.
        if !chance.once_in(if key == "joint" { 3 } else { 10 }) {
            continue;
        }
        let (mut value, keys) = grammar.table(key, chance);
        let is_made = match key {
            "springs" => springs(&mut value, setup, chance),
            "constraint" => constraints(&mut value, setup, chance),
            "joint" => joints(&mut value, setup, chance),
            "pin" => pins(&mut value, setup, chance),
            "torn" => torn(&mut value, setup, chance),
            "trail" => {
                value = json!(chance.below(setup.scene.model.particles()));
                true
            }
            _ => state(&mut value, setup, chance),
        };
        if is_made {
            scene[key] = value;
            all.insert(format!(".{key}"));
            all.extend(keys);
        }
    }
    all
}

fn rows(value: &mut Value) -> impl Iterator<Item = &mut Value> {
    value.as_array_mut().unwrap().iter_mut()
}

/// Chooses two different particles, if there are two.
fn two(setup: &Setup, chance: &mut Chance) -> Option<[usize; 2]> {
    let n = setup.scene.model.particles();
    let i = chance.below(n);
    (n > 1).then(|| [i, (i + 1 + chance.below(n - 1)) % n])
}

/// Returns the position of a particle (m).
fn place(setup: &Setup, i: usize) -> [f64; 3] {
    let (n, y) = (setup.scene.model.particles(), &setup.scene.state);
    [y[i], y[n + i], y[2 * n + i]]
}

fn springs(value: &mut Value, setup: &Setup, chance: &mut Chance) -> bool {
    for row in rows(value) {
        let Some([i, j]) = two(setup, chance) else {
            return false;
        };
        (row[0], row[1]) = (json!(i), json!(j));
    }
    true
}

/// Adds constraints that the initial positions meet.
fn constraints(value: &mut Value, setup: &Setup, chance: &mut Chance) -> bool {
    for row in rows(value) {
        let row = row.as_object_mut().unwrap();
        let Some([i, j]) = two(setup, chance) else {
            return false;
        };
        let (at, other) = (place(setup, i), place(setup, j));
        if let Some(key) = ["rod", "rope"].iter().find(|key| row.contains_key(**key)) {
            row.insert((*key).into(), json!([i, j]));
            let squared: f64 = at.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
            if row.contains_key("length") {
                row.insert("length".into(), json!(squared.sqrt()));
            }
            continue;
        }
        row.insert("particle".into(), json!(i));
        let radius = chance.within((0.1, 2.0, true));
        let [normal, out] = chance.corner();
        let center = [0, 1, 2].map(|k| at[k] + radius * out[k]);
        let circle = json!({ "center": center, "normal": normal, "radius": radius });
        for (key, made) in [
            ("point", json!(at)),
            ("line", json!({ "point": at, "direction": normal })),
            ("circle", circle),
            ("sphere", json!({ "center": center, "radius": radius })),
        ] {
            if row.contains_key(key) {
                row.insert(key.into(), made);
            }
        }
    }
    true
}

/// Joins bodies that exist, between limits about their places at the start.
fn joints(value: &mut Value, setup: &Setup, chance: &mut Chance) -> bool {
    let network = setup.scene.model.network();
    let count = network.map_or(0, |network| network.bodies().len());
    for row in rows(value) {
        let row = row.as_object_mut().unwrap();
        if count == 0 {
            return false;
        }
        let k = chance.below(count);
        if row.contains_key("body") {
            row.insert("body".into(), json!(k));
        } else if count == 1 {
            return false;
        } else {
            let other = (k + 1 + chance.below(count - 1)) % count;
            row.insert("bodies".into(), json!([k, other]));
        }
        for (key, part) in row {
            match (key.as_str(), part) {
                ("fixed", part) => *part = json!(true),
                (_, Value::Object(part)) => {
                    if let Some(Value::Array(limits)) = part.get_mut("limits") {
                        limits[0] = json!(-limits[0].as_f64().unwrap());
                    }
                }
                _ => {}
            }
        }
    }
    true
}

fn pins(value: &mut Value, setup: &Setup, chance: &mut Chance) -> bool {
    let network = setup.scene.model.network();
    for row in rows(value) {
        let i = chance.below(setup.scene.model.particles());
        // Points of rigid bodies cannot be pinned.
        if network.is_none_or(|network| network.is_carried(i)) {
            return false;
        }
        let is_body = network.is_some_and(|network| network.body_of(i).is_some());
        if is_body || network.is_none_or(|network| network.bodies().is_empty()) {
            row.as_object_mut().unwrap().remove("body");
        }
        row.as_object_mut().unwrap().remove("at");
        row["particles"] = json!([i]);
    }
    true
}

/// Adds torn springs, from those of the scene.
fn torn(value: &mut Value, setup: &Setup, chance: &mut Chance) -> bool {
    let network = setup.scene.model.network();
    let all: Vec<_> = network.into_iter().flat_map(Network::all_springs).collect();
    if all.is_empty() {
        return false;
    }
    for row in rows(value) {
        let spring = chance.from(&all);
        *row = json!([spring.i, spring.j]);
    }
    true
}

/// Adds a state near the initial one.
fn state(value: &mut Value, setup: &Setup, chance: &mut Chance) -> bool {
    let network = setup.scene.model.network();
    let bodies = network.map_or(0, |network| network.bodies().len());
    let n = setup.scene.model.particles();
    let far = chance.from(&[0.0, 1e-3, 0.1]);
    for (key, rows) in value.as_object_mut().unwrap() {
        let of_particles = ["positions", "velocities"].contains(&key.as_str());
        let mut row = |i: usize| match key.as_str() {
            "positions" => {
                let (by, place) = (chance.triple((-far, far, false)), place(setup, i));
                json!([place[0] + by[0], place[1] + by[1], place[2] + by[2]])
            }
            "velocities" => json!(chance.triple((-1.0, 1.0, false))),
            "orientations" => {
                let [x, y, z] = chance.direction();
                json!([0.6, 0.8 * x, 0.8 * y, 0.8 * z])
            }
            _ => json!(chance.triple((-0.1, 0.1, false))),
        };
        let all = 0..if of_particles { n } else { bodies };
        *rows = all.map(&mut row).collect();
    }
    true
}
