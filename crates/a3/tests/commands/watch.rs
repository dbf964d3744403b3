//! Messages about gained energy and unmet constraints, and the advice in them.

use serde_json::Value;

use crate::common::{Folder, a3, complaint, succeed, text};

const STRAIGHT: &str = "gravity = [0, -9.81, 0]\n[particles]\n\
    positions = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\nmass = 1\npin = [{ particles = [0, 2] }]\n\
    [[constraint]]\nrod = [0, 1]\n[[constraint]]\nrod = [1, 2]\n";
const TAUT: &str = "gravity = [0, -9.81, 0]\n[particles]\n\
    positions = [[0, 0, 0], [0.5, -0.8660254037844386, 0], [1, 0, 0]]\nmass = 1\n\
    pin = [{ particles = [0] }, { particles = [2], shift = { by = [1.5, 0, 0], end = 1 } }]\n\
    [[constraint]]\nrod = [0, 1]\n[[constraint]]\nrod = [1, 2]\n";
const BEAD: &str = "gravity = [0, -9.81, 0]\n[particles]\n\
    positions = [[0, 0, 0], [0.5, 0, 0], [0.977668245, 0.147760103, 0]]\nmasses = [1, 0.1, 1]\n\
    pin = [{ particles = [0] }]\n[[constraint]]\nrod = [0, 1]\n[[constraint]]\nrod = [1, 2]\n";
const SHORT: &str = "gravity = [0, -9.81, 0]\n[[chain]]\nparticles = 6\nfrom = [0, 0, 0]\n\
    to = [0.005, 0, 0]\nmass = 1e-6\nstiffness = 0.2\npin = [{ at = [\"first\"] }]\n";
const HUNG: &str = "[[body]]\nparts = [{ ball = 0.1 }]\nmass = 1\n\
    [[constraint]]\nparticle = 1\npoint = [0, 0.5, 0]\n";

const AGAINST: &str = "[[body]]\nparts = [{ box = [0.2, 0.2, 0.2] }]\nmass = 1\n\
    pin = [{ particles = [0], shift = { by = [1, 0, 0], end = 1 } }]\n\
    [[joint]]\nbody = 0\nball = [0, 0, 0]\n";

/// Returns the arguments of a run of this scene, after `a3 simulate`.
fn words(folder: &Folder, scene: &str, more: &str) -> String {
    folder.write("scene.toml", scene);
    format!("simulate {more} --scene scene.toml -o x.json --summary s.json")
}

/// Returns the stderr of a run of this scene, and its summary.
fn told(scene: &str, more: &str) -> (String, Value) {
    let folder = &Folder::new();
    let output = succeed(folder, words(folder, scene, more));
    let said = text(&output.stderr).to_owned();
    let summary = folder.bytes("s.json");
    (said, serde_json::from_slice(&summary).unwrap())
}

/// Returns the error of a run of this scene that leaves no file.
fn failed(scene: &str, more: &str, code: i32) -> String {
    let folder = &Folder::new();
    let line = complaint(&a3(folder, words(folder, scene, more)), code);
    assert!(!folder.join("x.json").exists());
    line
}

#[test]
fn lost_rods_and_lost_energy_are_told() {
    let (said, summary) = told(BEAD, "v 0.012 --until 5");
    assert!(
        said.starts_with("warning: the run gained ")
            && said.contains("warning: constraint ")
            && said.contains("was off by "),
        "{said}"
    );
    assert!(summary["constraint"]["off_by_percent"].as_f64().unwrap() > 1.0);
    assert!(summary["energy_change_percent"].as_f64().unwrap() > 20.0);
    let (said, summary) = told(BEAD, "r 0.0005 --until 5");
    assert_eq!(said, "");
    assert_eq!(summary["constraint"], Value::Null);
    assert!(summary["energy_change_percent"].as_f64().unwrap().abs() < 0.1);
}

#[test]
fn contradictions_are_named_without_advice() {
    let runs = ["r 0.001", "v 0.005", "a 1e-6"];
    let both = [TAUT, AGAINST].into_iter();
    for (scene, run) in both.flat_map(|scene| runs.map(|run| (scene, run))) {
        let line = failed(scene, &format!("{run} --until 3"), 1);
        assert!(line.contains("contradicts other constraints or pins"), "{line}");
        assert!(!line.contains("step of") && !line.contains("tolerance"), "{line}");
    }
    let (said, _) = told(STRAIGHT, "r 0.001 --until 1");
    assert!(said.contains("contradict") && said.contains("single place"), "{said}");
    let line = failed(HUNG, "r 0.001 --until 1", 2);
    assert!(line.contains("constraint 0, the point of particle 1, is off by"), "{line}");
}

#[test]
fn the_end_of_a_short_run_is_looked_at() {
    let line = failed(SHORT, "v 0.0028 --until 0.06", 1);
    assert!(line.contains("blew up"), "{line}");
}

#[test]
fn advice_held_for_as_long() {
    let folder = &Folder::new();
    let run = |step: &str| {
        let words = format!("simulate t {step} --scene double-pendulum --until 60 -o x.json");
        a3(folder, words)
    };
    let line = complaint(&run("0.1"), 1);
    let (_, advice) = line.split_once("; a step of ").unwrap();
    let (step, _) = advice.split_once(" s would have held").unwrap();
    let output = run(step);
    assert!(output.status.success());
    assert_eq!(text(&output.stderr), "");
    // The spring is unstable with every step that a3 accepts.
    let hopeless = "springs = [[0, 1, 1e9, 1, 0]]\n[particles]\n\
        positions = [[0, 0, 0], [1.5, 0, 0]]\nmass = 1e-9\n";
    let line = failed(hopeless, "r 0.001 --until 1", 1);
    assert!(line.contains("; only steps below 2.00e-9 s hold"), "{line}");
}

/// Chain of light links on ball joints with a heavy ball at its end.
fn heavy_end() -> String {
    let link = |k: usize| {
        let x = 0.1 + 0.2 * k as f64;
        format!(
            "[[body]]\nparts = [{{ box = [0.18, 0.02, 0.02] }}]\nmass = 0.1\nat = [{x}, 0, 0]\n"
        )
    };
    let joint = |k: usize| {
        let x = 0.2 * k as f64;
        let bodies = if k == 0 { "body = 0".into() } else { format!("bodies = [{}, {k}]", k - 1) };
        format!("[[joint]]\n{bodies}\nball = [{x}, 0, 0]\n")
    };
    let ball = "[[body]]\nparts = [{ ball = 0.2 }]\nmass = 1000\nat = [2.2, 0, 0]\n";
    let links: String = (0..10).map(link).collect();
    let joints: String = (0..11).map(joint).collect();
    format!("gravity = [0, -9.81, 0]\n{links}{ball}{joints}")
}

#[test]
fn advice_says_how_far_it_was_tried() {
    // Two seconds of this take longer than the search.
    let line = failed(&heavy_end(), "n 0.005 --until 5", 1);
    let (_, advice) = line.split_once("; a step of ").unwrap();
    let (_, advice) = advice.split_once(" s held ").unwrap();
    let (held, _) = advice.split_once(" s of 5 s, as far as it was tried").unwrap();
    assert!(held.parse::<f64>().unwrap() < 5.0, "{line}");
    // The joints can be met, however a step has torn them.
    let line = failed(&heavy_end(), "i 0.02 --until 5", 1);
    assert!(!line.contains("contradicts") && line.contains("; a step of "), "{line}");
}

#[test]
fn a_tolerance_that_holds_is_named() {
    let line = failed(BEAD, "a 0.1 --until 5", 1);
    let (_, advice) = line.split_once("; a tolerance of ").unwrap();
    let (tolerance, _) = advice.split_once(" would have held").unwrap();
    let (said, _) = told(BEAD, &format!("a {tolerance} --until 5"));
    assert_eq!(said, "");
}
