//! Short runs of random scenes by all methods: none panics, none hangs, and none explodes without a
//! warning.

#[path = "../common/mod.rs"]
mod common;

mod alike;
mod bodies;
mod chance;
mod energy;
mod frames;
mod grammar;
mod invariance;
mod kinds;
mod numbered;
mod ranges;
mod run;
mod sense;
mod units;

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use a3_scenes::{Description, MATERIALS, Material, Mesh, Setup, Stuff};
use serde_json::Value;

use chance::Chance;
use grammar::Grammar;
use run::{Ended, check_said, run};

/// Default number of scenes. `A3_SCENES` sets another, and `A3_FIRST` the number of the first.
const SCENES: usize = 2000;

/// Largest number of particles of a scene: many small scenes find more than a few large ones.
const MOST_PARTICLES: usize = 80;

/// Processor time after which a run counts as endless: a thousand times that of most.
const LONGEST: Duration = Duration::from_secs(5);

/// Real time after which the process is ended.
const NEVER: Duration = Duration::from_secs(120);

/// Largest number of findings that are shown.
const SHOWN: usize = 20;

/// Returns the processor time of this thread, or the real time if the system does not tell.
fn time_taken(begun: Instant) -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| begun.elapsed(), Duration::from_nanos)
}

fn mesh(name: &str) -> Result<Mesh, String> {
    match name {
        "two.msh" => Mesh::from_gmsh(&common::seed("msh/two.msh")),
        other => Mesh::from_obj(&common::seed(&format!("obj/{other}"))),
    }
}

/// Builds the scene of a text; `None` if it is refused with a clear message.
fn build(text: &str) -> Result<Option<Setup>, String> {
    match Description::parse(text).and_then(|d| d.build(None, &mut mesh)) {
        Ok(setup) => Ok(Some(setup)),
        Err(fault) => check_said(&fault.to_string()).map(|()| None),
    }
}

/// Results of all scenes.
#[derive(Default)]
struct Results {
    taken: usize,
    well: usize,
    seen: BTreeSet<String>,
    findings: Vec<String>,
    /// Longest time of a scene, and the number of that scene.
    slowest: (Duration, usize),
}

/// Scene that is being tried: the time at which it began, and its text so far.
#[derive(Default)]
struct Trial {
    since: Option<Instant>,
    text: String,
}

/// Names a material in each body of a scene that can have one, and in some scenes the gravity that
/// contact suits, and adds these keys.
fn name_materials(scene: &mut Value, k: usize, keys: &mut BTreeSet<String>) {
    if k.is_multiple_of(64) {
        scene["contact_gravity"] = 10.0.into();
        keys.insert(".contact_gravity".into());
    }
    for (kind, table) in [
        ("cloth", "Cloth"),
        ("mesh", "MeshCloth"),
        ("jelly", "Jelly"),
        ("solid", "Solid"),
        ("body", "RigidBody"),
    ] {
        let of_cloth = table.contains("Cloth");
        let is_for_it = |it: &&Material| matches!(it.stuff, Stuff::Fabric { .. }) == of_cloth;
        let all: Vec<_> = MATERIALS.iter().filter(is_for_it).collect();
        let bodies = scene.get_mut(kind).and_then(Value::as_array_mut);
        for body in bodies.into_iter().flatten() {
            body["material"] = all[k % all.len()].name.into();
            keys.insert(format!("{table}.material"));
        }
    }
}

/// Creates scene k and runs it. A finding is an error.
fn try_scene(
    k: usize,
    grammar: &Grammar,
    trial: &Mutex<Trial>,
    results: &Mutex<Results>,
) -> Result<(), String> {
    let show = |text: &str| trial.lock().unwrap().text = format!("# scene {k}\n{text}");
    let mut chance = Chance(k as u64);
    let (mut scene, mut keys) = grammar.table("", &mut chance);
    if k.is_multiple_of(4) {
        name_materials(&mut scene, k, &mut keys);
    }
    let write = |scene: &Value| toml::to_string(scene).unwrap();
    let mut text = write(&scene);
    show(&text);
    let Some(mut setup) = build(&text)? else {
        return Ok(());
    };
    if setup.scene.model.particles() > MOST_PARTICLES {
        return Ok(());
    }
    let more = numbered::add(grammar, &mut scene, &setup, &mut chance);
    if !more.is_empty() {
        text = write(&scene);
        show(&text);
        let Some(other) = build(&text)? else {
            return Ok(());
        };
        setup = other;
        keys.extend(more);
    }
    results.lock().unwrap().taken += 1;
    let mut said = String::new();
    let ended = run(&text, &setup, &mut chance, |method| {
        said = format!("# {method}\n{text}");
        show(&said);
    })?;
    let mut results = results.lock().unwrap();
    results.seen.extend(keys);
    results.well += usize::from(ended == Ended::Well);
    Ok(())
}

/// Tries the scenes whose numbers `next` gives, until there are none left.
fn work(next: impl Fn() -> Option<usize>, trial: &Mutex<Trial>, results: &Mutex<Results>) {
    let grammar = Grammar::new();
    let begun = Instant::now();
    while let Some(k) = next() {
        *trial.lock().unwrap() =
            Trial { since: Some(Instant::now()), text: format!("# scene {k}") };
        let before = time_taken(begun);
        let tried = catch_unwind(AssertUnwindSafe(|| try_scene(k, &grammar, trial, results)));
        let took = time_taken(begun).saturating_sub(before);
        let why = match tried {
            Ok(Ok(())) if took > LONGEST => Some(format!("it took {took:?}")),
            Ok(Ok(())) => None,
            Ok(Err(why)) => Some(why),
            Err(_) => Some("it panicked".to_owned()),
        };
        let mut trial = trial.lock().unwrap();
        trial.since = None;
        let mut results = results.lock().unwrap();
        results.slowest = results.slowest.max((took, k));
        let found = why.map(|why| format!("{why}\n{}", trial.text));
        results.findings.extend(found);
    }
}

/// Ends the process if a trial does not end.
fn watch(trials: &[Mutex<Trial>], is_done: impl Fn() -> bool) {
    while !is_done() {
        thread::sleep(Duration::from_millis(100));
        for trial in trials {
            let trial = trial.lock().unwrap();
            if trial.since.is_some_and(|since| since.elapsed() > NEVER) {
                eprintln!("this does not end:\n{}", trial.text);
                std::process::exit(1);
            }
        }
    }
}

/// Returns a number that the environment sets, or the usual one.
fn told(name: &str, usual: usize) -> usize {
    std::env::var(name).map_or(usual, |number| number.parse().unwrap())
}

#[test]
fn random_scenes_run_or_say_why_not() {
    let (scenes, first) = (told("A3_SCENES", SCENES), told("A3_FIRST", 0));
    let (next, done) = (AtomicUsize::new(first), AtomicUsize::new(0));
    let results = Mutex::new(Results::default());
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let trials: Vec<_> = (0..workers).map(|_| Mutex::default()).collect();
    thread::scope(|scope| {
        let number = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|k| *k < first + scenes);
        for trial in &trials {
            let (results, done) = (&results, &done);
            scope.spawn(move || {
                work(number, trial, results);
                done.fetch_add(1, Ordering::Relaxed);
            });
        }
        scope.spawn(|| watch(&trials, || done.load(Ordering::Relaxed) == workers));
    });
    let all = results.into_inner().unwrap();
    let (taken, well, slowest) = (all.taken, all.well, all.slowest);
    println!("{taken} of {scenes} scenes were taken, {well} ran well; the slowest is {slowest:?}");
    let shown: Vec<_> = all.findings.into_iter().take(SHOWN).collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
    if scenes < SCENES {
        return;
    }
    assert!(10 * taken > 7 * scenes, "{taken} of {scenes} were taken");
    assert!(2 * well > scenes, "{well} of {scenes} ran well");
    let keys = Grammar::new().keys();
    let unseen: Vec<_> = keys.difference(&all.seen).collect();
    assert!(unseen.is_empty(), "no run has {unseen:?}");
}
