//! Messages about gained energy and unmet constraints, and the advice in them.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{a3, complaint, text};

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

/// Returns the arguments of a run of this scene, after `a3 simulate`.
fn words<'a>(folder: &Path, scene: &str, more: &'a str) -> Vec<&'a str> {
    fs::write(folder.join("scene.toml"), scene).unwrap();
    let files = "--scene scene.toml -o x.json --summary s.json";
    ["simulate"]
        .into_iter()
        .chain(more.split(' '))
        .chain(files.split(' '))
        .collect()
}

/// Returns the stderr of a run of this scene, and its summary.
fn told(scene: &str, more: &str) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    let output = a3(folder.path(), &words(folder.path(), scene, more));
    let said = text(&output.stderr).to_owned();
    assert!(output.status.success(), "{said}");
    let summary = fs::read(folder.path().join("s.json")).unwrap();
    (said, serde_json::from_slice(&summary).unwrap())
}

/// Returns the error of a run of this scene that leaves no file.
fn failed(scene: &str, more: &str, code: i32) -> String {
    let folder = tempfile::tempdir().unwrap();
    let line = complaint(&a3(folder.path(), &words(folder.path(), scene, more)), code);
    assert!(!folder.path().join("x.json").exists());
    line
}

#[test]
fn lost_rods_and_lost_energy_are_told() {
    let (said, summary) = told(BEAD, "v 0.012 --until 5");
    assert!(
        said.starts_with("warning: constraint ") && said.contains("was off by "),
        "{said}"
    );
    assert!(summary["constraint"]["off_by_percent"].as_f64().unwrap() > 1.0);
    assert!(summary["energy_change_percent"].as_f64().unwrap() > 30.0);
    let (said, summary) = told(BEAD, "r 0.0005 --until 5");
    assert_eq!(said, "");
    assert_eq!(summary["constraint"], Value::Null);
    assert!(summary["energy_change_percent"].as_f64().unwrap().abs() < 0.1);
}

#[test]
fn contradictions_are_named_without_advice() {
    for run in ["r 0.001", "v 0.005", "a 1e-6"] {
        let line = failed(TAUT, &format!("{run} --until 3"), 1);
        assert!(
            line.contains("contradicts other constraints or pins"),
            "{line}"
        );
        assert!(
            !line.contains("step of") && !line.contains("tolerance"),
            "{line}"
        );
    }
    let (said, _) = told(STRAIGHT, "r 0.001 --until 1");
    assert!(
        said.contains("contradict") && said.contains("single place"),
        "{said}"
    );
    let line = failed(HUNG, "r 0.001 --until 1", 2);
    assert!(
        line.contains("constraint 0, the point of particle 1, is off by"),
        "{line}"
    );
}

#[test]
fn the_end_of_a_short_run_is_looked_at() {
    let line = failed(SHORT, "v 0.0028 --until 0.06", 1);
    assert!(line.contains("blew up"), "{line}");
}

#[test]
fn advice_held_for_as_long() {
    let folder = tempfile::tempdir().unwrap();
    let run = |step: &str| {
        let words = format!("simulate t {step} --scene double-pendulum --until 60 -o x.json");
        a3(folder.path(), &words.split(' ').collect::<Vec<_>>())
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
    assert!(
        line.contains("; no shorter step holds, down to a step of 0.00000"),
        "{line}"
    );
}
