//! Invariances of all built-in scenes, those of the documentation, and random ones.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use a3_core::integrators;
use a3_scenes::{Description, Mesh, SCENES, Setup};
use serde_json::Value;

use crate::alike::Known;
use crate::chance::Chance;
use crate::frames::Frame;
use crate::grammar::Grammar;
use crate::{MOST_PARTICLES, bodies, numbered, told};

/// Methods by which scenes run: explicit, splitting, and implicit.
const METHODS: [&str; 3] = ["rk4", "verlet", "implicit"];

/// Default number of random scenes. `A3_SCENES` sets another, and `A3_FIRST` the first; all scenes
/// then run in each frame by all methods, and otherwise by one.
const RANDOM: usize = 100;

/// Default number of scenes of random rigid bodies.
const BODIES: usize = 60;

/// Largest coordinate (m) and speed (m/s) in a random scene.
const FARTHEST: f64 = 1e5;

/// Scenes and frames that are left out, with the reason.
#[rustfmt::skip]
const LEFT_OUT: &[(&str, &[&str], &str)] = &[
    ("dominoes", &["mirrored"], ORDER),
    ("doll", &["reversed"], ORDER),
    ("stack", &["turned by half", "mirrored", "reversed"], ORDER),
    ("tangled", &["reversed"], "surfaces come apart in the order of the bodies"),
    ("turning", &["turned by half"], "impacts depend on the order of the sides of a box"),
    ("bodies 24", &["reversed"], ORDER),
    ("bodies 30", &["reversed"], ORDER),
    ("bodies 46", &["reversed"], ORDER),
    ("bodies 49", &["reversed"], ORDER),
    ("random 10", &["in mm"], "a spring without compression ends a step at its rest length"),
    ("random 106", &["shifted", "shifted far", "turned"], "surfaces begin in the same place"),
    ("windmill", &["mirrored"], "the sides of a box are cut along one of their diagonals"),
];
const ORDER: &str = "impacts of many bodies depend on their order";

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/scenes");

/// Scene with its name.
type Named = (String, Value);

fn build(scene: &Value) -> Result<Setup, String> {
    let text = toml::to_string(scene).map_err(|why| why.to_string())?;
    let mut mesh = |name: &str| {
        let file = Path::new(DOCS).join(name);
        if file.exists() {
            return Mesh::from_obj(&std::fs::read(file).unwrap());
        }
        crate::mesh(name)
    };
    let built = Description::parse(&text).and_then(|d| d.build(None, &mut mesh));
    built.map_err(|why| why.to_string())
}

/// Lists the built-in scenes and those of the documentation.
fn known() -> Vec<Named> {
    let read = |name: &str, text: &str| (name.to_owned(), toml::from_str(text).unwrap());
    let files = std::fs::read_dir(DOCS).unwrap().map(|file| file.unwrap().path());
    let scenes = files.filter(|it| it.extension().is_some_and(|e| e == "toml"));
    let mut files: Vec<_> = scenes.collect();
    files.sort();
    let files = files.iter().map(|file| {
        let text = std::fs::read_to_string(file).unwrap();
        read(file.file_stem().unwrap().to_str().unwrap(), &text)
    });
    let own = SCENES.iter().map(|scene| read(scene.name, scene.text));
    own.chain(files).collect()
}

/// Creates random scene k, if it makes sense and is small.
fn random(k: usize, grammar: &Grammar) -> Option<Named> {
    let mut chance = Chance(k as u64);
    let (mut scene, _) = grammar.table("", &mut chance);
    let setup = build(&scene).ok()?;
    if setup.scene.model.particles() > MOST_PARTICLES {
        return None;
    }
    numbered::add(grammar, &mut scene, &setup, &mut chance);
    let is_tangled = scene["untangle"] == true || is_contradicted(&scene);
    let setup = build(&scene).ok()?;
    // Other units and places would be out of range.
    let is_far = setup.scene.state.iter().any(|y| y.abs() > FARTHEST);
    (!is_tangled && !is_far).then(|| (format!("random {k}"), scene))
}

/// Returns whether joints hold a body that a pin moves: what comes of that depends on the frame.
fn is_contradicted(scene: &Value) -> bool {
    let bodies = scene["body"].as_array();
    let is_pinned = bodies.is_some_and(|all| all.iter().any(|body| body.get("pin").is_some()));
    is_pinned && !scene["joint"].is_null()
}

/// Returns whether a scene is left out in a frame.
fn is_left_out(name: &str, frame: &Frame) -> bool {
    let mut all = LEFT_OUT.iter();
    all.any(|(scene, frames, _)| *scene == name && frames.contains(&frame.name))
}

/// Lists what is wrong with the invariances of scene k.
fn faults(k: usize, (name, scene): &Named) -> Vec<String> {
    let Ok(own) = build(&Frame::SAME.of(scene)) else {
        return vec![];
    };
    // Lattices of random bodies are not mirrored with them, nor are the diagonals along which the
    // sides of boxes are cut.
    let is_handed = name.starts_with("random")
        || name.starts_with("bodies") && scene["body"].to_string().contains("\"box\"");
    let has_mirror = |frame: &Frame| frame.name != "mirrored" || !is_handed;
    let suits =
        |frame: &Frame| frame.suits(scene) && has_mirror(frame) && !is_left_out(name, frame);
    let frames = Frame::all().into_iter().filter(suits);
    let built = frames.map(|frame| (build(&frame.of(scene)), frame));
    let frames: Vec<_> = built.collect();
    let mut faults = vec![];
    for (built, frame) in &frames {
        if let Err(why) = built
            && !why.contains("it must be a number from")
        {
            faults.push(format!("{name}, {}: it is refused: {why}", frame.name));
        }
    }
    let is_whole = std::env::var("A3_SCENES").is_ok();
    for (number, method) in METHODS.iter().enumerate() {
        let method = integrators::find(method).unwrap();
        // Strips begin at their rest lengths, where implicit methods see one of two stiffnesses.
        let is_undecided = method.is_implicit() && name.starts_with("random");
        if is_undecided && scene.to_string().contains("\"buckling\"") {
            continue;
        }
        let Some(mut known) = Known::new(&own, method) else {
            continue;
        };
        for (place, (built, frame)) in frames.iter().enumerate() {
            let is_due = is_whole || (k + place) % METHODS.len() == number;
            let Some(other) = built.as_ref().ok().filter(|_| is_due) else {
                continue;
            };
            if let Err(why) = known.compare(frame, other) {
                faults.push(format!("{name}, {}, {}: {why}", frame.name, method.name));
            }
        }
        if let Err(why) = known.cut() {
            faults.push(format!("{name}, {}: {why}", method.name));
        }
    }
    faults
}

/// Finds the faults of all scenes on all processors, and prints them.
fn check(count: usize, scene: impl Fn(usize) -> Option<Named> + Sync) {
    let (next, found) = (AtomicUsize::new(0), Mutex::new(vec![]));
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    if k >= count {
                        break;
                    }
                    let Some(scene) = scene(k) else { continue };
                    let all = faults(k, &scene);
                    if !all.is_empty() {
                        let text = toml::to_string(&scene.1).unwrap();
                        println!("{}\n{text}", all.join("\n"));
                    }
                    found.lock().unwrap().extend(all);
                }
            });
        }
    });
    let mut found = found.into_inner().unwrap();
    found.sort();
    let count = found.len();
    assert!(count == 0, "{count} faults:\n{}", found.join("\n"));
}

#[test]
fn known_scenes_move_alike_in_all_frames() {
    let all = known();
    check(all.len(), |k| Some(all[k].clone()));
}

#[test]
fn random_bodies_move_alike_in_all_frames() {
    let (count, first) = (told("A3_SCENES", BODIES), told("A3_FIRST", 0));
    check(count, |k| {
        let k = first + k;
        Some((format!("bodies {k}"), bodies::scene(k as u64, [1.0; 3])))
    });
}

#[test]
fn random_scenes_move_alike_in_all_frames() {
    let (count, first) = (told("A3_SCENES", RANDOM), told("A3_FIRST", 0));
    let grammar = Grammar::new();
    check(count, |k| random(first + k, &grammar));
}
