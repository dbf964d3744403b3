//! The program as it is typed: what it writes, what it refuses, and how it says so.

#![allow(missing_docs, reason = "a test")]

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

fn a3(folder: &Path, words: &[&str]) -> Output {
    command(folder, words).output().unwrap()
}

fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_a3"));
    command.args(words).current_dir(folder).stdin(Stdio::null());
    // No display, and a folder for the libraries that complain when there is none.
    command
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    command.env("XDG_RUNTIME_DIR", folder);
    command
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The line on stderr, of a program that left with `code` and wrote nothing else.
fn complaint(folder: &Path, words: &[&str], code: i32) -> String {
    let output = a3(folder, words);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{words:?}: {stderr}");
    assert_eq!(
        stderr.lines().count(),
        1,
        "{words:?}: one line, not\n{stderr}"
    );
    assert!(stderr.starts_with("error: "), "{stderr}");
    assert!(output.stdout.is_empty());
    assert_eq!(
        fs::read_dir(folder).unwrap().count(),
        0,
        "{words:?} leaves nothing behind"
    );
    stderr.trim_end().to_owned()
}

fn gpu_may_be_missing(stderr: &str) -> bool {
    let missing = stderr.contains("mesa-vulkan-drivers");
    assert!(
        !missing || std::env::var_os("A3_REQUIRE_GPU").is_none(),
        "A3_REQUIRE_GPU is set: {stderr}"
    );
    if missing {
        // Past the test runner, which keeps what a passing test prints.
        let _ = writeln!(std::io::stderr(), "SKIPPED, NOT TESTED: {stderr}");
    }
    missing
}

#[test]
fn wrong_usage_is_one_line_that_says_what_is_right() {
    let folder = tempfile::tempdir().unwrap();
    let simulate = [
        "simulate", "t", "0.01", "--until", "1", "--output", "x.json",
    ];
    let with = |more: &[&'static str]| [&simulate[..], more].concat();
    for (words, says) in [
        (vec!["q"], "t (trapezoid)"),
        (vec!["0.01"], "e (euler)"),
        (vec!["t", "-0.01"], "such as 0.01"),
        (vec!["t", "-1e-3"], "such as 0.01"),
        (vec!["t", "-inf"], "such as 0.01"),
        (vec!["simulat"], "simulate"),
        (
            vec!["t", "0.01", "--scene", "simple", "--wind"],
            "leave out --wind",
        ),
        (
            vec!["t", "0.01", "--scene", "simple", "--springs-of", "0"],
            "no springs",
        ),
        (vec!["t", "0"], "such as 0.01"),
        (vec!["t", "-0"], "such as 0.01"),
        (vec!["t", "nan"], "such as 0.01"),
        (vec!["t", "inf"], "such as 0.01"),
        (vec!["t", "1e9"], "such as 0.01"),
        (vec!["t", "1e-300"], "such as 0.01"),
        (vec!["t", "fast"], "such as 0.01"),
        (vec!["t", "0.01", "0.02"], "a3 t 0.01"),
        (vec!["t", "0.01", "--scene", "rug"], "mit-sphere"),
        (vec!["t", "0.01", "--grid", "1x5"], "at least 2x2"),
        (vec!["t", "0.01", "--grid", "5"], "such as 20x30"),
        (vec!["t", "0.01", "--grid", "-3x5"], "20x30"),
        (
            vec!["t", "0.01", "--grid", "4294967295x4294967295"],
            "at most 4194304",
        ),
        (
            vec!["t", "0.01", "--grid", "99999999999999999999x2"],
            "20x30",
        ),
        (
            vec!["t", "0.01", "--grid", "5x5", "--scene", "chain"],
            "has no grid",
        ),
        (vec!["t", "0.01", "--springs-of", "400"], "0 to 399"),
        (vec!["t", "0.01", "--springs-of", "-1"], "whole number"),
        (vec!["v", "0.01", "--scene", "simple"], "first order"),
        (vec!["t", "0.01", "--wire"], "--wireframe"),
        (
            vec!["simulate", "t", "0.01", "--output", "x.json"],
            "--until",
        ),
        (vec!["simulate", "t", "0.01", "--until", "1"], "--output"),
        (
            vec![
                "simulate", "t", "0.01", "--until", "-1", "--output", "x.json",
            ],
            "such as 10",
        ),
        (
            vec![
                "simulate", "t", "0.01", "--until", "inf", "--output", "x.json",
            ],
            "such as 10",
        ),
        (
            vec!["simulate", "t", "0.01", "--until", "1", "--output", "x.txt"],
            ".json",
        ),
        (with(&["--grid", "3x0"]), "at least 2x2"),
        (
            vec!["render", "t", "0.01", "--until", "1", "--output", "x.jpg"],
            ".png",
        ),
        (
            vec![
                "render", "t", "0.01", "--until", "1", "--output", "x.png", "--size", "0x5",
            ],
            "1280x720",
        ),
        (
            vec![
                "render",
                "t",
                "0.01",
                "--until",
                "1",
                "--output",
                "x.png",
                "--springs-of",
                "999",
            ],
            "0 to 399",
        ),
    ] {
        let line = complaint(folder.path(), &words, 2);
        println!("a3 {}\n{line}", words.join(" "));
        assert!(line.contains(says), "{words:?}: {line}");
    }
}

#[test]
fn wrong_comparisons_too() {
    let folder = tempfile::tempdir().unwrap();
    for (words, says) in [
        (vec!["compare"], "2 to 4"),
        (vec!["compare", "e:0.05"], "a3 compare e:0.05 r:0.05"),
        (vec!["compare", "e", "t", "r", "s", "v"], "not 5"),
        (vec!["compare", "e:0.05", "q:0.05"], "r (rk4)"),
        (vec!["compare", "e:0.05", "r:"], "such as 0.01"),
        (vec!["compare", "e:0.05", "r:-1"], "such as 0.01"),
        (vec!["compare", "e", "r:0.01:0.02"], "such as 0.01"),
        (
            vec!["compare", "e", "v", "--scene", "simple"],
            "first order",
        ),
        (
            vec!["compare", "e", "r", "--springs-of", "3"],
            "--springs-of",
        ),
        (vec!["compare", "e", "r", "--until", "1"], "--output"),
        (vec!["compare", "e", "r", "--output", "x.png"], "--until"),
        (vec!["compare", "e", "r", "--size", "80x60"], "--output"),
        (
            vec!["compare", "e", "r", "--until", "1", "--output", "x.jpg"],
            ".png",
        ),
        (
            vec![
                "compare", "e", "r", "--paused", "--until", "1", "--output", "x.png",
            ],
            "--paused",
        ),
    ] {
        let line = complaint(folder.path(), &words, 2);
        assert!(line.contains(says), "{words:?}: {line}");
    }
}

#[test]
fn huge_grids_are_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let begun = Instant::now();
    complaint(
        folder.path(),
        &["t", "0.01", "--grid", "2000000x2000000"],
        2,
    );
    // A program that tried would be busy for much longer.
    assert!(begun.elapsed() < Duration::from_secs(5));
}

#[test]
fn help_and_version() {
    let folder = tempfile::tempdir().unwrap();
    for words in [
        &["--help"][..],
        &["-h"],
        &["simulate", "--help"],
        &["--version"],
    ] {
        let output = a3(folder.path(), words);
        assert!(output.status.success() && output.stderr.is_empty());
        assert!(!output.stdout.is_empty());
    }
    let help = a3(folder.path(), &["--help"]);
    for word in [
        "simulate",
        "render",
        "compare",
        "scenes",
        "solvers",
        "--scene",
        "--grid",
        "--springs-of",
        "a3 t 0.01",
    ] {
        assert!(text(&help.stdout).contains(word), "{word}");
    }
    assert!(!text(&help.stdout).contains("--status"));
}

#[test]
fn lists() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = a3(folder.path(), &["scenes"]);
    let row = |name: &str| {
        let stdout = text(&scenes.stdout).to_owned();
        let row = stdout
            .lines()
            .find(|line| line.split_whitespace().next() == Some(name))
            .map(str::to_owned);
        row.unwrap_or_else(|| panic!("no {name} in\n{stdout}"))
    };
    for number in [
        "15x15", "225", "1202", "1350", "gravity", "drag", "sphere", "floor",
    ] {
        assert!(row("mit-sphere").contains(number), "{number}");
    }
    assert!(row("simple").contains(" 3 "));
    let solvers = a3(folder.path(), &["solvers"]);
    for solver in a3_core::integrators::METHODS {
        let start = format!("{}  {} ", solver.letter, solver.name);
        assert!(
            text(&solvers.stdout)
                .lines()
                .any(|line| line.starts_with(&start)),
            "{start}"
        );
    }
}

fn simulate(folder: &Path, words: &[&str]) -> Value {
    let output = a3(folder, &[&["simulate"], words, &["--output", "-"]].concat());
    assert!(
        output.status.success(),
        "{words:?}: {}",
        text(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_state_is_written_at_full_precision() {
    let folder = tempfile::tempdir().unwrap();
    let state = simulate(
        folder.path(),
        &["rk4", "0.3", "--scene", "simple", "--until", "1"],
    );
    assert_eq!(
        (&state["scene"], &state["solver"]),
        (&"simple".into(), &"rk4".into())
    );
    assert_eq!(
        (&state["step"], &state["time"], &state["steps"]),
        (&0.3.into(), &1.0.into(), &4.into())
    );
    assert_eq!(
        (&state["evaluations"], &state["energy"]),
        (&16.into(), &Value::Null)
    );
    // The same, by hand.
    let (mut x, mut y) = (1.0f64, 0.0f64);
    let f = |x: f64, y: f64| (-y, x);
    for h in [0.3, 0.3, 0.3, 1.0 - 3.0 * 0.3] {
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
    assert_eq!(
        state["velocities"][0][0].as_f64().unwrap(),
        -position[1].as_f64().unwrap()
    );

    let state = simulate(
        folder.path(),
        &[
            "t", "0.01", "--grid", "5x7", "--until", "0.5", "--wind", "--swing",
        ],
    );
    assert_eq!(state["positions"].as_array().unwrap().len(), 35);
    assert_eq!(state["velocities"].as_array().unwrap().len(), 35);
    assert!(state["energy"].as_f64().is_some());
    let start = simulate(
        folder.path(),
        &["t", "0.01", "--grid", "5x7", "--until", "0"],
    );
    assert_eq!((&start["steps"], &start["time"]), (&0.into(), &0.0.into()));

    // A tolerance is no step.
    let state = simulate(folder.path(), &["dopri5", "1e-4", "--until", "0.1"]);
    assert!(state["step"].is_null());
    assert_eq!(state["tolerance"], 1e-4);
}

/// As many steps as it takes, and none of a rounding error's size.
#[test]
fn steps_are_counted_right() {
    let folder = tempfile::tempdir().unwrap();
    for (step, until, steps) in [
        ("0.0003", "3", 10_000),
        ("0.6", "3.6", 6),
        ("0.3", "0.9", 3),
        ("0.03", "0.9", 30),
        ("0.4", "1", 3),
    ] {
        let state = simulate(
            folder.path(),
            &["e", step, "--scene", "simple", "--until", until],
        );
        assert_eq!(state["steps"], steps, "{until} s in steps of {step} s");
        assert_eq!(state["time"], until.parse::<f64>().unwrap());
    }
}

#[test]
fn a_closed_or_full_output_is_no_panic() {
    let folder = tempfile::tempdir().unwrap();
    for words in [
        &["scenes"][..],
        &["t", "0.01", "--scene", "pendulum"],
        &["solvers"],
        &["--help"],
        &["chart", "--help"],
    ] {
        let mut child = command(folder.path(), words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(
            output.status.success() && !text(&output.stderr).contains("panicked"),
            "{words:?}"
        );
        #[cfg(target_os = "linux")]
        {
            let full = fs::File::options().write(true).open("/dev/full").unwrap();
            let output = command(folder.path(), words)
                .stdout(full)
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let output = output.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{words:?}");
            assert!(text(&output.stderr).contains("standard output"));
        }
    }
}

#[test]
#[cfg(unix)]
fn links_stay_links_and_modes_stay_modes() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (target, link) = (
        folder.path().join("target.json"),
        folder.path().join("link.json"),
    );
    fs::write(&target, "old").unwrap();
    fs::set_permissions(&target, fs::Permissions::from_mode(0o600)).unwrap();
    std::os::unix::fs::symlink("target.json", &link).unwrap();
    let words = [
        "simulate",
        "t",
        "0.01",
        "--scene",
        "chain",
        "--until",
        "1",
        "--output",
        "link.json",
    ];
    assert!(a3(folder.path(), &words).status.success());
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(fs::read_to_string(&target).unwrap().starts_with('{'));
    assert_eq!(
        fs::metadata(&target).unwrap().permissions().mode() & 0o777,
        0o600
    );
}

#[test]
fn a_state_file_is_whole_or_absent() {
    let folder = tempfile::tempdir().unwrap();
    let run = |output: &str| {
        a3(
            folder.path(),
            &[
                "simulate", "t", "0.01", "--scene", "chain", "--until", "1", "--output", output,
            ],
        )
    };
    assert!(run("state.json").status.success());
    let first = fs::read(folder.path().join("state.json")).unwrap();
    assert!(run("state.json").status.success());
    assert_eq!(
        fs::read(folder.path().join("state.json")).unwrap(),
        first,
        "a run repeats itself to the byte"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let output = run("nowhere/state.json");
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("there is no folder nowhere"));
    #[cfg(target_os = "linux")]
    {
        // A device that is always full, as a file ending in .json and as standard output.
        std::os::unix::fs::symlink("/dev/full", folder.path().join("full.json")).unwrap();
        let output = run("full.json");
        assert_eq!(output.status.code(), Some(1));
        assert!(
            text(&output.stderr).contains("full.json") && text(&output.stderr).contains("space")
        );
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let words = [
            "simulate", "t", "0.01", "--scene", "chain", "--until", "1", "--output", "-",
        ];
        let output = command(folder.path(), &words)
            .stdout(full)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let output = output.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(text(&output.stderr).contains("standard output"));
    }
}

#[test]
fn a_blow_up_writes_nothing_and_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "simulate",
        "rk4",
        "0.04",
        "--scene",
        "mit",
        "--until",
        "8",
        "--output",
        "state.json",
    ];
    let line = complaint(folder.path(), &words, 1);
    for part in ["blew up at step ", "t = 0.", "particle "] {
        assert!(line.contains(part), "{line}");
    }
    let words = [
        "render",
        "rk4",
        "0.04",
        "--scene",
        "mit",
        "--until",
        "8",
        "--output",
        "picture.png",
    ];
    let output = a3(folder.path(), &words);
    if !gpu_may_be_missing(text(&output.stderr)) {
        assert!(complaint(folder.path(), &words, 1).contains("blew up"));
    }
}

#[test]
fn pictures_without_a_window() {
    let folder = tempfile::tempdir().unwrap();
    let render = |name: &str, more: &[&str]| {
        let words = [
            &[
                "render", "t", "0.01", "--until", "1", "--size", "320x200", "--output", name,
            ],
            more,
        ]
        .concat();
        let output = a3(folder.path(), &words);
        if gpu_may_be_missing(text(&output.stderr)) {
            return None;
        }
        assert!(output.status.success(), "{}", text(&output.stderr));
        let picture = image::open(folder.path().join(name)).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (320, 200));
        let red = picture
            .pixels()
            .filter(|p| p.0[0] > 100 && p.0[0] / 2 > p.0[1] && p.0[0] / 2 > p.0[2])
            .count();
        Some((red, text(&output.stdout).to_owned()))
    };
    let Some((red, _)) = render("shaded.png", &[]) else {
        return;
    };
    assert!(red > 2000, "a red cloth: {red}");
    let (red, _) = render("wires.png", &["--wireframe"]).unwrap();
    assert!(red < 50, "wires: {red}");
    let (_, listed) = render("springs.png", &["--springs-of", "210"]).unwrap();
    assert_eq!(listed.lines().count(), 13, "{listed}");
    for name in ["simple", "pendulum", "chain", "mit-sphere"] {
        render(&format!("{name}.png"), &["--scene", name]).unwrap();
    }
    let words = [
        "render",
        "t",
        "0.01",
        "--until",
        "1",
        "--output",
        "x.png",
        "--size",
        "99999x99999",
    ];
    let output = a3(folder.path(), &words);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("99999x99999"));
}

/// The panes of a picture that differ from the first, pixel by pixel, below the text.
#[test]
fn methods_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "compare", "e:0.05", "r:0.05", "r:0.025", "--scene", "simple", "--until", "20", "--output",
        "x.png", "--size", "906x500",
    ];
    let output = a3(folder.path(), &words);
    if gpu_may_be_missing(text(&output.stderr)) {
        return;
    }
    assert!(output.status.success(), "{}", text(&output.stderr));
    // What is said: Euler's radius grows as sqrt(1 + h^2) a step, and RK4 is late by h^4 / 120 a second.
    let stdout = text(&output.stdout);
    let rows: Vec<Vec<&str>> = stdout
        .lines()
        .skip(1)
        .map(|line| line.split_whitespace().collect())
        .collect();
    let error = |row: usize| rows[row][3].parse::<f64>().unwrap();
    assert_eq!(rows.len(), 3, "{stdout}");
    assert!((error(0) - 0.648).abs() < 0.01, "{stdout}");
    assert!((error(1) - 1.04e-6).abs() < 0.02e-6, "{stdout}");
    assert!((error(2) - 6.5e-8).abs() < 0.1e-8, "{stdout}");
    assert_eq!(
        (rows[0][4], rows[1][4], rows[2][4]),
        ("20.0", "80.0", "160")
    );

    // What is seen: the trail of the second is that of the third, and the first leads elsewhere.
    let picture = image::open(folder.path().join("x.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (906, 500));
    let pane = |k: u32| image::imageops::crop_imm(&picture, 303 * k, 205, 300, 295).to_image();
    let different = |a: u32, b: u32| {
        let (a, b) = (pane(a), pane(b));
        let pairs = a.pixels().zip(b.pixels());
        pairs
            .filter(|(p, q)| p.0.iter().zip(q.0).any(|(p, q)| p.abs_diff(q) > 40))
            .count()
    };
    let (euler, rk4) = (different(0, 1), different(1, 2));
    assert!(euler > 1000 && 4 * rk4 < euler, "{euler} {rk4}");
    // Dark letters on light paper, in each pane.
    for k in 0..3 {
        let caption = image::imageops::crop_imm(&picture, 303 * k + 12, 45, 180, 130).to_image();
        let dark = caption.pixels().filter(|p| p.0[0] < 90).count();
        let light = caption.pixels().filter(|p| p.0[0] > 225).count();
        assert!(dark > 150 && light > 10_000, "{dark} {light}");
    }

    // One that blows up says so, and the others are there all the same.
    let words = [
        "compare", "e:0.05", "r", "--scene", "mit", "--until", "1", "--output", "y.png", "--size",
        "400x300",
    ];
    let output = a3(folder.path(), &words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stdout = text(&output.stdout);
    assert!(stdout.contains("blew up at step") && stdout.contains("1.00"));
    image::open(folder.path().join("y.png")).unwrap();
}

#[test]
fn without_a_display_the_job_is_done_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let output = a3(folder.path(), &["t", "0.01"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stderr = text(&output.stderr);
    assert!(stderr.starts_with("no display"), "{stderr}");
    let stdout = text(&output.stdout);
    for second in 0..=10 {
        let start = format!("{second}.00");
        assert!(
            stdout
                .lines()
                .any(|line| line.trim_start().starts_with(&start)),
            "{start} in\n{stdout}"
        );
    }
    if !gpu_may_be_missing(stderr) {
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(stdout.contains("a3-cloth-1.png"));
        image::open(folder.path().join("a3-cloth-1.png")).unwrap();
    }
}

#[test]
fn without_a_display_methods_are_compared_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["compare", "e:0.05", "r:0.05", "--scene", "simple"];
    let output = a3(folder.path(), &words);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success() && stderr.starts_with("no display"));
    assert!(
        stdout.contains("euler") && stdout.contains("10.00"),
        "{stdout}"
    );
    if !gpu_may_be_missing(stderr) {
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        image::open(folder.path().join("a3-simple-1.png")).unwrap();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_an_adapter_it_still_simulates() {
    let folder = tempfile::tempdir().unwrap();
    let blind = |words: &[&str]| {
        command(folder.path(), words)
            .env("WGPU_BACKEND", "vulkan")
            .env("VK_DRIVER_FILES", "/nowhere")
            .output()
            .unwrap()
    };
    let output = blind(&["t", "0.01"]);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{stderr}");
    assert!(
        stdout.contains("10.00") && stderr.contains("mesa-vulkan-drivers"),
        "{stdout}{stderr}"
    );
    let output = blind(&["render", "t", "0.01", "--until", "1", "--output", "x.png"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("mesa-vulkan-drivers"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
