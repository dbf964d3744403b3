//! Hashes of the states that every scene reaches by every method. A change that is not meant to
//! change results changes none of them. `A3_BLESS=1 cargo test -p a3-simulator --test golden`
//! writes them again; the commit then says which changed and why.

#![allow(missing_docs, reason = "a test")]

mod common;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::thread;

use a3_core::integrators::METHODS;
use a3_scenes::SCENES;
use common::{Folder, command, text};

const HASHES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/states.txt");
const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes");
/// Step (s) and relative tolerance of all runs.
const STEP: f64 = 2e-3;
const TOLERANCE: &str = "1e-6";
/// Scenes of at least 4096 particles, whose rows threads share: scene, grid and steps.
const LARGE: [(&str, &str, u32); 3] =
    [("cloth", "64x64", 20), ("mit", "70x64", 20), ("flag", "64x66", 12)];
const STEPS: u32 = 300;
/// Step (s) and steps in scenes whose surfaces touch, where each frame is checked for surfaces that
/// pass through one another. Adaptive methods take too long there.
const TOUCHING: (f64, u32) = (2.5e-3, 60);
/// Step (s) and steps in scenes whose rigid bodies touch: implicit methods take long there.
const RIGID: (f64, u32) = (1e-3, 20);
/// Steps of adaptive methods in scenes with friction, where they locate each slide and each stop.
const SLIDING: u32 = 60;

struct Run {
    scene: String,
    grid: Option<&'static str>,
    method: char,
    setting: String,
    until: f64,
    threads: u32,
    check: bool,
}

impl Run {
    fn name(&self) -> String {
        let Self { scene, grid, method, .. } = self;
        let scene = Path::new(scene).file_stem().unwrap().to_str().unwrap();
        format!("{scene} {} {method}", grid.unwrap_or("-"))
    }

    /// Returns the FNV-1a hash of all bits of the state, or the error of the run.
    fn hash(&self, folder: &Path) -> String {
        let mut words: Vec<String> = [
            "simulate".into(),
            self.method.to_string(),
            self.setting.clone(),
            "--scene".into(),
            self.scene.clone(),
            "--until".into(),
            self.until.to_string(),
            "--output".into(),
            "-".into(),
        ]
        .into();
        words.extend(self.check.then(|| "--check".into()));
        words.extend(self.grid.into_iter().flat_map(|grid| ["--grid".into(), grid.into()]));
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let output = command(folder, &words)
            .env("RAYON_NUM_THREADS", self.threads.to_string())
            .output()
            .unwrap();
        let why = text(&output.stderr);
        assert!(!why.contains("crosses"), "{}: {why}", self.name());
        match output.status.code() {
            Some(0) => {}
            Some(1) => return "lost".into(),
            Some(2) => return "refused".into(),
            _ => panic!("{}: {why}", self.name()),
        }
        let state: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut eat = |number: f64| {
            for byte in number.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        };
        for key in ["positions", "velocities"] {
            for column in state[key].as_array().into_iter().flatten() {
                for number in column.as_array().unwrap() {
                    eat(number.as_f64().unwrap());
                }
            }
        }
        format!("{hash:016x}")
    }
}

fn runs() -> Vec<Run> {
    let mut scenes: Vec<String> = SCENES.iter().map(|scene| scene.name.to_owned()).collect();
    let mut documented: Vec<_> = std::fs::read_dir(DOCS)
        .unwrap()
        .map(|entry| entry.unwrap().path().canonicalize().unwrap())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| path.to_str().unwrap().to_owned())
        .collect();
    documented.sort();
    scenes.extend(documented);
    let small = scenes.into_iter().map(|scene| (scene, None, STEPS, 1));
    let large = LARGE.into_iter().flat_map(|(scene, grid, steps)| {
        [1, 2, 3, 8].into_iter().map(move |threads| (scene.to_owned(), Some(grid), steps, threads))
    });
    small
        .chain(large)
        .flat_map(|(scene, grid, steps, threads)| {
            let toml = a3_scenes::find(&scene).map_or_else(
                || std::fs::read_to_string(&scene).unwrap(),
                |built_in| built_in.text.to_owned(),
            );
            let check = toml.lines().any(|line| line == "self_collision = true");
            let rigid = toml.contains("[[body]]") && toml.contains("gravity");
            let slides = toml.contains("friction");
            let (step, steps) = match (check, rigid) {
                (true, _) => TOUCHING,
                (_, true) => RIGID,
                _ => (STEP, steps),
            };
            let methods = METHODS.iter();
            let methods = methods.filter(move |method| !(check && method.is_adaptive()));
            methods.map(move |method| Run {
                scene: scene.clone(),
                grid,
                method: method.letter.unwrap(),
                setting: if method.is_adaptive() { TOLERANCE.into() } else { step.to_string() },
                until: f64::from(if slides && method.is_adaptive() {
                    steps.min(SLIDING)
                } else {
                    steps
                }) * step,
                threads,
                check,
            })
        })
        .collect()
}

#[test]
fn no_bit_of_any_state_has_changed() {
    let folder = &Folder::new();
    let runs = Mutex::new(runs());
    let found = Mutex::new(BTreeMap::<String, String>::new());
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let Some(run) = runs.lock().unwrap().pop() else {
                        return;
                    };
                    let hash = run.hash(folder);
                    let name = run.name();
                    let before = found.lock().unwrap().insert(name.clone(), hash.clone());
                    assert!(
                        before.as_ref().is_none_or(|before| *before == hash),
                        "{name}: the number of threads changes its bits"
                    );
                }
            });
        }
    });
    let found = found.into_inner().unwrap();
    if std::env::var_os("A3_BLESS").is_some() {
        let lines = found.iter().map(|(name, hash)| format!("{name} {hash}\n"));
        std::fs::write(HASHES, lines.collect::<String>()).unwrap();
        return;
    }
    let expected = std::fs::read_to_string(HASHES).unwrap();
    let expected: BTreeMap<_, _> =
        expected.lines().filter_map(|line| line.rsplit_once(' ')).collect();
    let changed: Vec<_> = found
        .iter()
        .filter(|(name, hash)| expected.get(name.as_str()) != Some(&hash.as_str()))
        .map(|(name, _)| name.as_str())
        .collect();
    let missing: Vec<_> = expected.keys().filter(|name| !found.contains_key(**name)).collect();
    assert!(
        changed.is_empty() && missing.is_empty(),
        "changed or new: {changed:#?}; missing: {missing:#?}"
    );
}
