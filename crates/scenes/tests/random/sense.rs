//! Corrections of random tables, whose numbers have to fit together.

use serde_json::{Map, Value, json};

use crate::chance::Chance;
use crate::ranges::SPOTS;

/// Edge of the cells in which bodies and obstacles begin apart (m).
const CELL: f64 = 3.0;

/// Corrects a table of a type, for a key of its owner.
pub fn mend(owner: &str, name: &str, table: &mut Map<String, Value>, chance: &mut Chance) {
    match name {
        "Cloth" if table.contains_key("right") || table.contains_key("down") => {
            let [right, down] = chance.corner();
            table.insert("right".into(), json!(right));
            table.insert("down".into(), json!(down));
        }
        "Fluid" => fluid(table, chance),
        "Turn" => {
            // The turn of a pin needs a point, and a turn by an angle needs an end.
            if owner == "Pin" {
                table.insert("about".into(), json!(chance.triple((-1.0, 1.0, false))));
            }
            if table.contains_key("angle") {
                table.insert("end".into(), json!(1.5));
            }
        }
        // The motion of a pin begins at its place.
        "Sine" if owner == "Pin" => {
            let is_odd = |key: &str| ["center", "phase"].contains(&key);
            table.retain(|key, _| !is_odd(key) || chance.once_in(8));
        }
        "Pin" => {
            table.retain(|key, _| !["at", "particles"].contains(&key.as_str()));
            let spots = SPOTS.iter().find(|(body, _)| *body == owner);
            match spots.filter(|_| chance.once_in(2)) {
                Some((_, spots)) => table.insert("at".into(), json!([chance.from(spots)])),
                None if owner == "RigidBody" => table.insert("particles".into(), json!([0])),
                None => table.insert("particles".into(), json!([chance.below(2)])),
            };
        }
        // Rods have their initial length.
        "Chain" if table.get("rigid") == Some(&json!(true)) => {
            table.remove("rest_length");
            table.remove("tension_only");
        }
        // Gas needs a closed mesh.
        "MeshCloth" if table.contains_key("pressure") || table.contains_key("fill") => {
            table.insert("file".into(), json!("solid.obj"));
        }
        "Particles" => particles(table, chance),
        "" => scene(table, chance),
        _ => {}
    }
}

/// Returns edges of up to `most` spacings each, flat in two dimensions.
fn edges(most: usize, spacing: f64, flat: bool, chance: &mut Chance) -> [f64; 3] {
    let mut size = [(); 3].map(|()| (1 + chance.below(most)) as f64 * spacing);
    if flat {
        size[2] = 0.0;
    }
    size
}

/// Makes the edges whole multiples of the spacing, within the tank.
fn fluid(table: &mut Map<String, Value>, chance: &mut Chance) {
    let spacing = table["spacing"].as_f64().unwrap();
    let flat = table.get("dimensions").is_some_and(|d| *d == 2);
    let size = edges(3, spacing, flat, chance);
    table.insert("size".into(), json!(size));
    let at = table["at"].clone();
    if let Some(Value::Object(tank)) = table.get_mut("tank") {
        let more = edges(2, spacing, flat, chance);
        let size: Vec<_> = size.iter().zip(more).map(|(a, b)| a + b).collect();
        tank.insert("size".into(), json!(size));
        tank.insert("at".into(), at);
    }
    let outflows = table.get_mut("outflow").and_then(Value::as_array_mut);
    for outflow in outflows.into_iter().flatten().filter(|_| flat) {
        outflow["size"][2] = json!(0.0);
    }
    if let Some(Value::Object(inflow)) = table.get_mut("inflow") {
        let mut size = edges(3, spacing, flat, chance);
        let (axis, mut velocity) = (chance.below(if flat { 2 } else { 3 }), [0.0; 3]);
        size[axis] = 0.0;
        velocity[axis] = [1.0, -2.0][chance.below(2)];
        inflow.insert("size".into(), json!(size));
        inflow.insert("velocity".into(), json!(velocity));
        inflow.insert("duration".into(), json!(0.3));
    }
}

/// Makes all lists as long as that of the particles, with springs between them.
fn particles(table: &mut Map<String, Value>, chance: &mut Chance) {
    let count = table["positions"].as_array().unwrap().len();
    for (key, value) in table.iter_mut() {
        match (key.as_str(), value) {
            ("velocities" | "masses", Value::Array(rows)) => {
                let first = rows[0].clone();
                rows.resize(count, first);
            }
            ("springs", Value::Array(rows)) => rows.iter_mut().for_each(|row| {
                let i = chance.below(count);
                (row[0], row[1]) = (json!(i), json!((i + 1) % count));
            }),
            _ => {}
        }
    }
}

/// Removes the attachments to rigid bodies from the pins of other bodies, if there are none. What
/// is attached is never let go.
fn release(table: &mut Map<String, Value>) {
    let none = !table.contains_key("body");
    for (key, bodies) in table.iter_mut() {
        let bodies = match bodies {
            Value::Array(bodies) => bodies.iter_mut().collect(),
            other => vec![other],
        };
        let pins = bodies.into_iter().filter_map(|body| body.get_mut("pin"));
        for pin in pins.flat_map(|pins| pins.as_array_mut().unwrap()) {
            let pin = pin.as_object_mut().unwrap();
            if none || key == "body" {
                pin.remove("body");
            }
            if pin.contains_key("body") {
                pin.remove("until");
            }
        }
    }
}

/// Moves most bodies apart, and gives all fluids the same liquid.
fn scene(table: &mut Map<String, Value>, chance: &mut Chance) {
    release(table);
    if let Some(Value::Array(fluids)) = table.get_mut("fluid") {
        fluids.truncate(1);
        if chance.once_in(3) {
            let mut other = fluids[0].clone();
            for x in other["at"].as_array_mut().unwrap() {
                *x = json!(x.as_f64().unwrap() + 2.0);
            }
            other.as_object_mut().unwrap().remove("tank");
            fluids.push(other);
        }
    }
    // A limit of strain below the stretch at which springs break makes no sense.
    let tear = table.get("tear").and_then(Value::as_f64);
    for key in ["cloth", "jelly", "mesh"] {
        let bodies = table.get_mut(key).and_then(Value::as_array_mut);
        for body in bodies.into_iter().flatten() {
            if let (Some(tear), Some(limit)) = (tear, body.get_mut("strain_limit")) {
                *limit = json!(1.2 * tear);
            }
        }
    }
    let mut cell = 0;
    let places = "at foot from to positions center point";
    for (key, bodies) in table.iter_mut() {
        let bodies: Vec<&mut Value> = match bodies {
            Value::Array(bodies) if bodies.iter().all(Value::is_object) => {
                bodies.iter_mut().collect()
            }
            body if key == "particles" => vec![body],
            _ => continue,
        };
        for body in bodies {
            // Some bodies are in the same cell.
            cell += usize::from(!chance.once_in(8));
            let offset = [cell % 3, (cell / 3) % 3, cell / 9].map(|k| CELL * k as f64);
            let body = body.as_object_mut().unwrap();
            let has_default = ["cloth", "mesh", "body", "obstacle"].contains(&&**key);
            if has_default && !body.contains_key("foot") {
                body.entry("at").or_insert(json!([0.0, 0.0, 0.0]));
            }
            for place in places.split(' ') {
                if let Some(value) = body.get_mut(place) {
                    shift(value, offset);
                }
            }
            if let Some(tank) = body.get_mut("tank") {
                shift(&mut tank["at"], offset);
            }
        }
    }
}

/// Adds an offset to a place, or to each of several.
fn shift(place: &mut Value, offset: [f64; 3]) {
    let Value::Array(numbers) = place else {
        return;
    };
    if numbers.iter().all(Value::is_array) {
        for row in numbers {
            shift(row, offset);
        }
        return;
    }
    for (x, by) in numbers.iter_mut().zip(offset) {
        *x = json!(x.as_f64().unwrap() + by);
    }
}
