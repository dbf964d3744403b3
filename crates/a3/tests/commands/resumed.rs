//! Runs that are killed and resumed from their checkpoints: the same files, to the bit.

use std::fs;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::{Folder, TEARING, a3, command, complaint, succeed, text};

/// Cloth that folds on a floor and touches itself.
const FOLDING: &str = "gravity = [0, -9.81, 0]\ndrag_per_mass = 0.5\n\
    floor = { height = 0, friction = 0.4 }\nself_collision = true\n\
    [[cloth]]\ngrid = [8, 8]\nwidth = 1\ndensity = 0.2\nstiffness = [40, 20, 0.5]\n\
    damping_ratio = 0.1\nfriction = 0.3\nright = [1, 0, 0]\ndown = [0, -0.98, 0.2]\nat = [0, 1.05, 0]\n";

/// Runs that together need everything in a checkpoint: tears, pins on paths, contact, rods, wind
/// and swing, adaptive steps and BDF's differences.
const RUNS: [&str; 6] = [
    "--scene rag.toml --until 1",
    "v 0.002 --scene fold.toml --until 0.8",
    "x 1e-5 --wind --swing --until 1.5",
    "r 0.0005 --scene double-pendulum --until 5",
    "o 1e-4 --scene chain --until 3",
    "a 1e-6 --scene rag.toml --until 1",
];

/// Returns the state and the summary of a run, without the values that depend on the machine.
fn written(folder: &Folder) -> (String, Value) {
    let state = folder.read("state.json");
    let summary = folder.read("summary.json");
    let mut summary: Value = serde_json::from_str(&summary).unwrap();
    summary["wall_time"] = Value::Null;
    (state, summary)
}

/// Returns the arguments of a command that makes a run and writes both.
fn words(run: &str, more: &str) -> String {
    format!("simulate {run} --output state.json --summary summary.json {more}")
}

/// `A3_KILLS` sets how many runs are killed.
#[test]
fn a_run_that_is_killed_goes_on_to_the_same_bits() {
    let kills = std::env::var("A3_KILLS").map_or(12, |kills| kills.parse().unwrap());
    let keep = "--checkpoint run.checkpoint --every 0";
    let mut resumed = 0;
    for (k, run) in RUNS.iter().enumerate() {
        let folder = &Folder::new();
        folder.write("rag.toml", TEARING);
        folder.write("fold.toml", FOLDING);
        let go = |more: &str, threads: &str| {
            let mut command = command(folder, words(run, more));
            let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
            assert!(output.status.success(), "{}", text(&output.stderr));
            written(folder)
        };
        let whole = go("", "2");
        let begun = Instant::now();
        assert_eq!(go(keep, "2"), whole, "keeping changes nothing");
        let taken = begun.elapsed();
        for kill in (k..kills).step_by(RUNS.len()) {
            let _ = fs::remove_file(folder.join("run.checkpoint"));
            let _ = fs::remove_file(folder.join("state.json"));
            let mut child = command(folder, words(run, keep)).spawn().unwrap();
            // Numbers that are spread evenly, by the golden ratio.
            let share = (f64::from(kill as u32) * 0.618_033_988_75).fract();
            std::thread::sleep(Duration::from_secs_f64(share * taken.as_secs_f64()));
            child.kill().unwrap();
            child.wait().unwrap();
            // Killed before the first checkpoint, or after the end.
            if folder.join("run.checkpoint").exists() {
                let threads = ["1", "3"][kill % 2];
                let again = go("--resume run.checkpoint", threads);
                assert!(again == whole, "{run:?} after {share} of its time");
                resumed += 1;
            }
        }
    }
    assert!(2 * resumed > kills, "{resumed} of {kills}");
}

#[test]
fn frames_go_on_where_the_checkpoint_was_made() {
    let folder = &Folder::new();
    let run = |more: &str| {
        let output = succeed(folder, format!("simulate v 0.01 --fps 20 {more}"));
        text(&output.stderr).to_owned()
    };
    let rows = |file: &str| folder.read(file);
    run("--until 0.5 -o whole.csv");
    run("--until 0.2 -o begin.csv --checkpoint c.checkpoint");
    let said = run("--until 0.5 --resume c.checkpoint -o end.csv");
    assert!(said.contains("end.csv begins with frame 4"), "{said}");
    let (whole, end) = (rows("whole.csv"), rows("end.csv"));
    let (heading, end) = end.split_once('\n').unwrap();
    assert!(whole.starts_with(heading) && whole.ends_with(end) && end.starts_with("4,0.2"));
    // Files of a sequence keep their numbers.
    run("--until 0.5 --resume c.checkpoint -o f-##.obj");
    assert!(!folder.join("f-04.obj").exists() && folder.join("f-05.obj").exists());
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let folder = &Folder::new();
    let scene = |mass: &str| {
        let text = format!(
            "[[chain]]\nparticles = 3\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = {mass}\nstiffness = 50\npin = [{{ particles = [0] }}]\n\
             [[mesh]]\nfile = \"square.obj\"\ndensity = 1\nstiffness = [1, 1]\n"
        );
        folder.write("own.toml", text);
    };
    let square = |faces: &str| {
        let points = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\n";
        folder.write("square.obj", format!("{points}{faces}"));
    };
    scene("1");
    square("f 1 2 3\nf 1 3 4\n");
    let keep = "--scene own.toml --until 0.5 -o x.json --checkpoint c.checkpoint";
    succeed(folder, format!("simulate r 0.01 {keep}"));
    let refused = |words: &str, why: &str| {
        let resumed = format!("simulate {words} -o y.json --resume c.checkpoint");
        let line = complaint(&a3(folder, resumed), 2);
        assert!(line.starts_with("error: c.checkpoint: "), "{line}");
        assert!(line.contains(why), "{line}");
        assert!(!folder.join("y.json").exists());
    };
    refused("--until 1", "of the scene own, not of cloth");
    let own = "--scene own.toml --until 1";
    for other in ["v", "r 0.02"] {
        refused(&format!("{other} {own}"), "continues with rk4 0.01");
    }
    refused("--scene own.toml --until 0.4", "at t = 0.5 s already");
    // The same points in other triangles.
    square("f 1 2 4\nf 2 3 4\n");
    refused(own, "of another scene own");
    square("f 1 2 3\nf 1 3 4\n");
    scene("2");
    refused(own, "of another scene own");
    folder.write("c.checkpoint", "{}");
    let line = complaint(&a3(folder, format!("simulate {keep}")), 2);
    assert!(line.contains("would be overwritten"), "{line}");
    refused(own, "no checkpoint of a3");
}

/// The solver of a scene that cannot run it is not needed to resume by another.
#[test]
fn a_run_goes_on_by_the_solver_of_its_checkpoint() {
    let folder = &Folder::new();
    let own = "solver = \"dprkn86\"\ngravity = [0, -9.81, 0]\ndrag = 0.1\n[[chain]]\nparticles = 3\n\
         from = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 50\ndamping = 0.5\npin = [{ particles = [0] }]\n";
    folder.write("own.toml", own);
    let scene = "--scene own.toml -o x.json";
    let keep = "--until 0.2 --checkpoint c.checkpoint";
    succeed(folder, format!("simulate r 0.01 {scene} {keep}"));
    let plain = format!("simulate --until 1 {scene}");
    let line = complaint(&a3(folder, &plain), 2);
    assert!(line.contains("the solvers that can run it"), "{line}");
    succeed(folder, plain + " --resume c.checkpoint");
}

/// A run that is resumed has taken as many evaluations as one that was not interrupted.
#[test]
fn evaluations_are_those_of_a_run_in_one_go() {
    let folder = &Folder::new();
    let evaluations = |more: &str| {
        let run = "simulate x 1e-6 -o x.json --summary s.json";
        succeed(folder, format!("{run} {more}"));
        let summary = folder.read("s.json");
        let summary: Value = serde_json::from_str(&summary).unwrap();
        summary["evaluations"].as_u64().unwrap()
    };
    let whole = evaluations("--until 1");
    evaluations("--until 0.123 --checkpoint c.checkpoint");
    let resumed = evaluations("--until 1 --resume c.checkpoint");
    assert_eq!(resumed, whole);
}
