//! The same scene in another frame: shifted, turned about the vertical, mirrored, in other units,
//! or moving.

use std::f64::consts::PI;

use a3_core::rotation;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use serde_json::{Map, Value, json};

use crate::grammar::BODIES;
use crate::kinds::{Kind, kind};

/// Keys that hold obstacles, or fix something in the world.
#[rustfmt::skip]
const FIXED: [&str; 11] = [
    "floor", "box", "capsule", "sphere", "obstacle", "wind", "drag", "drag_per_mass", "swing",
    "constraint", "pin",
];

/// Another frame: a place p becomes `length` (R M p) + `shift`, with the turn R about the vertical,
/// and the mirror M along x or none.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub name: &'static str,
    turn: f64,
    is_mirrored: bool,
    /// The old unit of length in the new one.
    pub length: f64,
    pub shift: Vector3<f64>,
    /// Velocity that all gets (m/s).
    velocity: Vector3<f64>,
    /// Whether all lists are in the opposite order.
    is_reversed: bool,
}

impl Frame {
    /// The frame of the description itself, with default values written down as keys.
    pub const SAME: Self = Self {
        name: "",
        turn: 0.0,
        is_mirrored: false,
        length: 1.0,
        shift: Vector3::new(0.0, 0.0, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        is_reversed: false,
    };

    /// Lists the frames in which a scene has to move alike.
    pub fn all() -> Vec<Self> {
        let named = |name, change: fn(&mut Self)| {
            let mut frame = Self { name, ..Self::SAME };
            change(&mut frame);
            frame
        };
        vec![
            named("shifted", |it| it.shift = Vector3::new(5.0, 0.0, 3.0)),
            named("shifted far", |it| {
                it.shift = Vector3::new(64.0, 0.0, -32.0);
            }),
            named("turned", |it| it.turn = 0.7),
            named("turned by half", |it| it.turn = PI),
            named("mirrored", |it| it.is_mirrored = true),
            named("in mm", |it| it.length = 1000.0),
            named("moving", |it| it.velocity = Vector3::new(2.0, -1.0, 0.5)),
            named("reversed", |it| it.is_reversed = true),
        ]
    }

    /// Returns the turn.
    fn turning(&self) -> Matrix3<f64> {
        if self.turn == PI {
            return Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0));
        }
        rotation(Vector3::y() * self.turn)
    }

    /// Returns the mirror.
    fn mirror(&self) -> Matrix3<f64> {
        let side = if self.is_mirrored { -1.0 } else { 1.0 };
        Matrix3::from_diagonal(&Vector3::new(side, 1.0, 1.0))
    }

    /// Returns where a place (m) is at time t (s).
    pub fn place(&self, place: Vector3<f64>, t: f64) -> Vector3<f64> {
        self.turning() * self.mirror() * place * self.length + self.shift + self.velocity * t
    }

    /// Whether the scene can be described in this frame.
    pub fn suits(&self, scene: &Value) -> bool {
        let has = |key: &str| !scene[key].is_null();
        let text = scene.to_string();
        let says = |words: &[&str]| words.iter().any(|word| text.contains(&format!("\"{word}\"")));
        // Boxes of a fluid are along the axes.
        let is_half = self.turn == 0.0 || self.turn == PI;
        if has("circle") || !is_half && has("fluid") {
            return false;
        }
        // The cells of a lattice are numbered from the left, and folds begin to one side.
        let lattices = ["jelly", "solid", "mesh", "fluid", "obstacle"];
        let is_handed =
            lattices.iter().any(|key| has(key)) || says(&["folds", "file", "orientations"]);
        if self.is_mirrored && (is_handed || self.turn != 0.0) {
            return false;
        }
        let numbered = ["springs", "constraint", "pin", "torn", "state"];
        let is_numbered = numbered.iter().any(|key| has(key));
        // The boxes of a fluid and its inflow do not turn, and nor do the numbers in them.
        if self.turn != 0.0 && has("fluid") && (is_numbered || says(&["inflow"])) {
            return false;
        }
        // A cloth hangs around the origin unless it has a place.
        let cloths = scene["cloth"].as_array();
        let has_place = |cloth: &Value| cloth.get("at").or(cloth.get("foot")).is_some();
        if self.shift != Vector3::zeros() && !cloths.is_none_or(|all| all.iter().all(has_place)) {
            return false;
        }
        // The sides of a mesh are those of the world.
        let has_sides = says(&["left", "right", "front", "back"]) && says(&["file"]);
        if self.turn != 0.0 && (has_sides || says(&["orientations"])) {
            return false;
        }
        // The pressure of the air is 101325 Pa.
        if self.length != 1.0 && says(&["fill"]) {
            return false;
        }
        if self.is_reversed {
            // Numbers of particles that are in several bodies.
            return !is_numbered;
        }
        if self.velocity == Vector3::zeros() {
            return true;
        }
        let joints = scene["joint"].as_array();
        let is_joined = joints.is_some_and(|all| all.iter().any(|it| it.get("body").is_some()));
        let is_pinned = says(&["pin", "tank", "inflow", "outflow"]);
        if has("state") && scene["state"]["positions"].is_null() {
            return false;
        }
        !is_joined && !is_pinned && !FIXED.iter().any(|key| has(key))
    }

    /// Returns the scene in this frame. Gusts are left out of both.
    pub fn of(&self, scene: &Value) -> Value {
        let mut scene = scene.clone();
        let flat = scene["fluid"][0]["dimensions"] == json!(2);
        self.complete(&mut scene);
        self.table("", scene.as_object_mut().unwrap(), flat);
        if self.is_reversed {
            reverse(&mut scene);
        }
        scene
    }

    /// Adds what is the same in each frame only if it is written down: turns of bodies, directions,
    /// places and velocities.
    fn complete(&self, scene: &mut Value) {
        if scene["gravity"].is_null() && scene["contact_gravity"].is_null() {
            scene["contact_gravity"] = json!(9.81);
        }
        let all = scene.as_object_mut().unwrap().iter_mut();
        for (key, value) in all {
            let mut tables: Vec<&mut Value> = match value {
                Value::Array(tables) => tables.iter_mut().collect(),
                table => vec![table],
            };
            let name = key.as_str();
            for table in tables.iter_mut().filter_map(|table| table.as_object_mut()) {
                let parts = table.get_mut("parts").and_then(Value::as_array_mut);
                for part in parts.into_iter().flatten() {
                    if part.get("file").is_some() && part.get("scale").is_none() {
                        part["scale"] = json!(1.0);
                    }
                }
                let has_file = table.contains_key("file");
                let mut default = |key: &str, value: Value| {
                    table.entry(key).or_insert(value);
                };
                if has_file {
                    default("scale", json!(1.0));
                }
                let zero = json!([0.0, 0.0, 0.0]);
                if ["jelly", "mesh", "solid", "body", "box", "obstacle"].contains(&name) {
                    default("rotation", zero.clone());
                }
                if ["mesh", "body", "obstacle"].contains(&name) {
                    default("at", zero.clone());
                }
                if name == "cloth" {
                    default("right", json!([1.0, 0.0, 0.0]));
                    default("down", json!([0.0, -1.0, 0.0]));
                }
                if name == "wind" {
                    table.insert("steady".into(), json!(true));
                    if self.length != 1.0 && table.contains_key("velocity") {
                        table.entry("density").or_insert(json!(1.2));
                    }
                    continue;
                }
                if self.velocity == Vector3::zeros() {
                    continue;
                }
                if name == "particles" || name == "state" {
                    if let Some(rows) = table.get("positions").and_then(Value::as_array) {
                        let still = Value::from(vec![zero.clone(); rows.len()]);
                        table.entry("velocities").or_insert(still);
                    }
                    let velocities = table.get_mut("velocities").and_then(Value::as_array_mut);
                    let all = velocities.into_iter().flatten();
                    all.for_each(|velocity| self.accelerate(velocity));
                } else if BODIES.contains(&name) {
                    self.accelerate(table.entry("velocity").or_insert(zero.clone()));
                }
            }
        }
    }

    /// Adds the velocity of the frame.
    fn accelerate(&self, velocity: &mut Value) {
        let numbers = velocity.as_array_mut().unwrap().iter_mut();
        for (v, more) in numbers.zip(&self.velocity) {
            *v = json!(v.as_f64().unwrap() + more);
        }
    }

    fn table(&self, name: &str, table: &mut Map<String, Value>, flat: bool) {
        for (key, value) in table {
            let kind = match (name, key.as_str()) {
                ("fluid", "density") if flat => Kind::Number(-2),
                ("", key) if key != "floor" && value.is_object() => Kind::Number(0),
                (name, key) => kind(name, key),
            };
            self.value(key, value, kind, flat);
        }
    }

    /// Changes a value of this kind, or all in a table under this key.
    fn value(&self, key: &str, value: &mut Value, kind: Kind, flat: bool) {
        if let Value::Object(table) = value {
            return self.table(key, table, flat);
        }
        if let Value::Array(all) = value {
            let is_vector = all.len() == 3 && all.iter().all(Value::is_number);
            if kind == Kind::Springs {
                for row in all {
                    row[3] = json!(row[3].as_f64().unwrap() * self.length);
                }
            } else if is_vector && !matches!(kind, Kind::Number(_)) {
                let old = Vector3::from_fn(|k, _| all[k].as_f64().unwrap());
                *value = json!(<[f64; 3]>::from(self.vector(old, kind)));
            } else {
                for one in all.iter_mut() {
                    self.value(key, one, kind, flat);
                }
            }
            return;
        }
        let Some(number) = value.as_f64() else { return };
        *value = match kind {
            Kind::Number(power) if power != 0 => json!(number * self.length.powi(power)),
            Kind::Height => json!(number * self.length + self.shift.y),
            _ => return,
        };
    }

    fn vector(&self, old: Vector3<f64>, kind: Kind) -> Vector3<f64> {
        let (turn, mirror) = (self.turning(), self.mirror());
        let side = mirror.determinant();
        match kind {
            Kind::Place => self.place(old, 0.0),
            Kind::Vector(power) => turn * mirror * old * self.length.powi(power),
            Kind::Axis(power) => turn * mirror * old * (side * self.length.powi(power)),
            Kind::Inside => mirror * old * self.length,
            Kind::RotationInside => mirror * old * side,
            Kind::Rotation if self.turn == 0.0 => mirror * old * side,
            Kind::Rotation => vector_of(turn * rotation(old)),
            Kind::Height | Kind::Springs | Kind::Number(_) => old,
        }
    }
}

/// Returns the rotation vector of a rotation matrix.
fn vector_of(matrix: Matrix3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix)).scaled_axis()
}

/// Puts bodies, single particles, springs, joints and obstacles in the opposite order.
fn reverse(scene: &mut Value) {
    let count = |list: &Value| list.as_array().map_or(0, Vec::len);
    let bodies = count(&scene["body"]);
    let particles = count(&scene["particles"]["positions"]);
    let turn = |number: &mut Value, count: usize| {
        if let Some(k) = number.as_u64() {
            *number = json!((count as u64).wrapping_sub(1 + k));
        }
    };
    let table = scene.as_object_mut().unwrap();
    table.remove("trail");
    for (key, value) in table.iter_mut() {
        let is_alone = key == "particles";
        let mut tables: Vec<&mut Value> = match value {
            Value::Array(all) if all.iter().all(Value::is_object) => {
                all.reverse();
                all.iter_mut().collect()
            }
            Value::Object(_) if is_alone => vec![value],
            _ => continue,
        };
        for table in tables.iter_mut().filter_map(|table| table.as_object_mut()) {
            for (key, value) in table.iter_mut() {
                let all = value.as_array_mut();
                match (key.as_str(), all) {
                    ("pin", Some(pins)) => pins.iter_mut().for_each(|pin| {
                        if let Some(body) = pin.get_mut("body") {
                            turn(body, bodies);
                        }
                        let numbers = pin.get_mut("particles").and_then(Value::as_array_mut);
                        let numbers = numbers.into_iter().flatten().filter(|_| is_alone);
                        numbers.for_each(|number| turn(number, particles));
                    }),
                    ("bodies", Some(pair)) => pair.iter_mut().for_each(|k| turn(k, bodies)),
                    ("positions" | "velocities" | "masses", Some(rows)) => rows.reverse(),
                    ("springs", Some(rows)) => {
                        rows.reverse();
                        for row in rows {
                            turn(&mut row[0], particles);
                            turn(&mut row[1], particles);
                        }
                    }
                    ("body", None) => turn(value, bodies),
                    _ => {}
                }
            }
        }
    }
}
