//! The state at the end of a run: its numbers, and the file that they are written to.

use std::fs;
use std::process::Stdio;

use crate::common::{Folder, a3, command, gpu_is_missing, simulate, succeed, text};
use crate::{complaint, refused};
use serde_json::Value;

#[test]
fn the_state_is_written_at_full_precision() {
    let folder = &Folder::new();
    let state = simulate(folder, "rk4 0.3 --scene simple --until 0.9");
    assert_eq!((&state["scene"], &state["solver"]), (&"simple".into(), &"rk4".into()));
    assert_eq!(
        (&state["step"], &state["time"], &state["steps"]),
        (&0.3.into(), &0.9.into(), &3.into())
    );
    assert_eq!((&state["evaluations"], &state["energy"]), (&12.into(), &Value::Null));
    // The same, by hand.
    let (mut x, mut y) = (1.0f64, 0.0f64);
    let f = |x: f64, y: f64| (-y, x);
    for h in [0.3; 3] {
        let k1 = f(x, y);
        let k2 = f(x + h / 2.0 * k1.0, y + h / 2.0 * k1.1);
        let k3 = f(x + h / 2.0 * k2.0, y + h / 2.0 * k2.1);
        let k4 = f(x + h * k3.0, y + h * k3.1);
        x += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        y += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
    }
    let position = &state["positions"][0];
    assert!((position[0].as_f64().unwrap() - x).abs() < 1e-15);
    assert!((position[1].as_f64().unwrap() - y).abs() < 1e-15);
    assert_eq!(state["velocities"][0][0].as_f64().unwrap(), -position[1].as_f64().unwrap());

    let state = simulate(folder, "t 0.01 --grid 5x7 --until 0.5 --wind --swing");
    assert_eq!(state["positions"].as_array().unwrap().len(), 35);
    assert_eq!(state["velocities"].as_array().unwrap().len(), 35);
    assert!(state["energy"].as_f64().is_some());
    let start = simulate(folder, "t 0.01 --grid 5x7 --until 0");
    assert_eq!((&start["steps"], &start["time"]), (&0.into(), &0.0.into()));

    // A tolerance is no step.
    let state = simulate(folder, "dopri5 1e-4 --until 0.1");
    assert!(state["step"].is_null());
    assert_eq!(state["tolerance"], 1e-4);
}

/// The number of steps is right, and no step has the size of a rounding error.
#[test]
fn steps_are_counted_right() {
    let folder = &Folder::new();
    for (step, until, steps) in [
        ("0.0003", "3", 10_000),
        ("0.6", "3.6", 6),
        ("0.3", "0.9", 3),
        ("0.03", "0.9", 30),
        ("0.4", "1", 3),
    ] {
        let run = format!("e {step} --scene simple --until {until}");
        let state = simulate(folder, run);
        assert_eq!(state["steps"], steps, "{until} s in steps of {step} s");
        assert_eq!(state["time"], until.parse::<f64>().unwrap());
    }
}

/// Steps as fractions meet frames exactly, and a step that misses them by less than a millionth of
/// itself does too: no sliver of a step is taken at each frame. A single state needs no frames.
#[test]
fn fractions_of_a_second_meet_frames() {
    let folder = &Folder::new();
    let steps = |step: &str| {
        let run = "--scene chain --until 2 --fps 60 -o frames.json --summary summary.json";
        succeed(folder, format!("simulate p {step} {run}"));
        let text = folder.read("summary.json");
        serde_json::from_str::<Value>(&text).unwrap()["steps"].clone()
    };
    assert_eq!(steps("1/60"), 120);
    assert_eq!(steps("0.01666666666"), 120);
    // The last step would end after the end of the run.
    assert_eq!(steps("0.016666666"), 121);
    assert_eq!(steps("0.01666"), 121);
    let words = "implicit 10 --scene simple --until 40000";
    assert_eq!(simulate(folder, words)["steps"], 4000);
    let folder = &Folder::new();
    for step in ["1/0", "1/x", "/", "-1/60"] {
        let line = refused(folder, format!("simulate r {step} -o x.json"), 2);
        assert!(line.contains("such as 0.01 or 1/60"), "{line}");
    }
}

#[test]
#[cfg(unix)]
fn links_stay_links_and_modes_stay_modes() {
    use std::os::unix::fs::PermissionsExt;
    let folder = &Folder::new();
    let (target, link) = (folder.join("target.json"), folder.join("link.json"));
    fs::write(&target, "old").unwrap();
    fs::set_permissions(&target, fs::Permissions::from_mode(0o600)).unwrap();
    std::os::unix::fs::symlink("target.json", &link).unwrap();
    let words = "simulate t 0.01 --scene chain --until 1 --output link.json";
    succeed(folder, words);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(fs::read_to_string(&target).unwrap().starts_with('{'));
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o600);
}

#[test]
fn a_state_file_is_whole_or_absent() {
    let folder = &Folder::new();
    let run = |output: &str| {
        let words = "simulate t 0.01 --scene chain --until 1 --output";
        a3(folder, format!("{words} {output}"))
    };
    assert!(run("state.json").status.success());
    let first = folder.bytes("state.json");
    assert!(run("state.json").status.success());
    assert_eq!(folder.bytes("state.json"), first, "a run repeats itself to the byte");
    assert_eq!(folder.count(), 1);
    let output = run("nowhere/state.json");
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("there is no folder nowhere"));
    #[cfg(target_os = "linux")]
    {
        // A device that is always full, as a file ending in .json and as standard output.
        std::os::unix::fs::symlink("/dev/full", folder.join("full.json")).unwrap();
        let output = run("full.json");
        assert_eq!(output.status.code(), Some(1));
        assert!(
            text(&output.stderr).contains("full.json") && text(&output.stderr).contains("space")
        );
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let words = "simulate t 0.01 --scene chain --until 1 --output -";
        let output = command(folder, words).stdout(full).stderr(Stdio::piped()).spawn().unwrap();
        let output = output.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains("standard output"));
    }
}

#[test]
fn a_blow_up_writes_nothing_and_says_where() {
    let folder = &Folder::new();
    let words = "simulate rk4 0.04 --scene mit --until 8 --output state.json";
    let line = refused(folder, words, 1);
    for part in [
        "blew up at step ",
        "t = 0.",
        "J that nothing put in, and particle ",
        "nothing was written; a step of 0.03 s would have held",
    ] {
        assert!(line.contains(part), "{line}");
    }
    let words = "render rk4 0.04 --scene mit --until 8 --output picture.png";
    let output = a3(folder, words);
    if !gpu_is_missing(&output) {
        assert!(refused(folder, words, 1).contains("blew up"));
    }
}

/// The number of threads is as requested, and changes no bit.
#[test]
#[cfg(target_os = "linux")]
fn threads_are_as_many_as_asked_for() {
    let folder = &Folder::new();
    let run = |threads: &str| {
        let words = "simulate r 0.001 --scene mit --grid 80x80 --until 0.2 -o x.json --threads";
        let mut run = command(folder, format!("{words} {threads}")).spawn().unwrap();
        let tasks = format!("/proc/{}/task", run.id());
        let mut most = 0;
        while run.try_wait().unwrap().is_none() {
            most = fs::read_dir(&tasks).map_or(most, |tasks| most.max(tasks.count()));
        }
        (most, folder.bytes("x.json"))
    };
    let ((few, one), (many, eight)) = (run("1"), run("8"));
    assert!(few < 8 && many == few + 7, "{few} and {many} threads");
    assert!(one == eight);
    for none in ["0", "-1", "many", "1e3"] {
        let line = complaint(&a3(folder, ["--threads", none]), 2);
        assert!(line.contains("a whole number from 1 to 1024"), "{line}");
    }
}
