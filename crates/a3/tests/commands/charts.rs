//! Charts as a user makes them: measured, continued, interrupted, and refused in one line.

use std::fs;
use std::process::Command;
use std::time::Duration;

use crate::common::{Folder, a3, command, said};

pub const CHAIN: &str = "chart --scene chain --work evaluations";

#[test]
fn a_chart_of_evaluations_has_the_same_bits_every_time() {
    let folder = &Folder::new();
    let files = ["a.csv", "a.svg", "b.csv", "b.svg"].map(|name| folder.join(name));
    let run = |files: &str| said(folder, format!("{CHAIN} {files}"));
    let first = run("--data a.csv --output a.svg");
    let second = run("--data b.csv --output b.svg");
    assert_eq!(first.replace("a.svg", "b.svg"), second);
    let [a, drawn_a, b, drawn_b] = files.map(|file| fs::read(file).unwrap());
    assert!(a == b);
    assert!(drawn_a == drawn_b);
    for said in
        ["small differences", "1e-2 m", "1e-8 m", "* cheapest:", "chart: a.svg", "rk4", "dop853"]
    {
        assert!(first.contains(said), "{said} in\n{first}");
    }
    let svg = String::from_utf8(drawn_a).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for word in [
        "Speed against accuracy: chain",
        "evaluations per simulated second, linear algebra included",
        "blew up",
    ] {
        assert!(svg.contains(word), "{word}");
    }
    // Every number is finite, every run has its scene, solver and version.
    let mut reader = csv::Reader::from_reader(&a[..]);
    let headers = reader.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|h| h == name).unwrap();
    let (error, work, solver) = (column("error_position"), column("work"), column("solver"));
    let (mut solvers, mut runs) = (std::collections::BTreeSet::new(), 0);
    for line in reader.records() {
        let line = line.unwrap();
        // A run that blew up has no error.
        let is_lost = !line[column("lost_at")].is_empty();
        let finite = line[error].parse::<f64>().is_ok_and(f64::is_finite);
        assert!(finite != is_lost && (finite || line[error].is_empty()));
        assert!(line[work].parse::<f64>().unwrap() > 0.0);
        assert_eq!(&line[column("scene")], "chain");
        assert_eq!(&line[column("version")], env!("CARGO_PKG_VERSION"));
        assert_eq!(&line[column("seconds")], "");
        solvers.insert(line[solver].to_owned());
        runs += 1;
    }
    // Nothing is damped, and so implicit damping would repeat velocity Verlet; Radau serves plain
    // numbers.
    assert!(!solvers.contains("implicit-damping"));
    assert_eq!(solvers.len(), a3_core::integrators::METHODS.len() - 2);
    assert!(runs > 80, "{runs}");
}

#[test]
fn a_chart_goes_on_from_its_data() {
    let folder = &Folder::new();
    for data in ["d.csv", "d.json"] {
        let run = |more: &str| said(folder, format!("{CHAIN} --data {data} {more}"));
        run("--solvers r,v --output one.svg");
        let path = folder.join(data);
        let before = fs::read_to_string(&path).unwrap();
        run("--solvers r,v,x --output two.svg");
        let after = fs::read_to_string(&path).unwrap();
        assert!(after.contains("dop853") && !before.contains("dop853"));
        assert!(after.len() > before.len());
        run("--solvers r,v,x --output three.svg");
        let [two, three] = ["two.svg", "three.svg"].map(|name| folder.bytes(name));
        assert!(two == three);
        assert!(after == fs::read_to_string(&path).unwrap(), "{data}");
    }
    // Runs in the file are used, not measured again: here, that Verlet's method needs no work.
    let path = folder.join("d.csv");
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let headers = reader.headers().unwrap().clone();
    let mut writer = csv::Writer::from_path(folder.join("e.csv")).unwrap();
    // Without checksums, edited data are accepted.
    let count = headers.len() - 1;
    assert_eq!(&headers[count], "check");
    writer.write_record(headers.iter().take(count)).unwrap();
    for line in reader.records() {
        let line = line.unwrap();
        let is_verlet = line.iter().any(|cell| cell == "verlet");
        let cells = line
            .iter()
            .zip(&headers)
            .take(count)
            .map(|(cell, name)| if is_verlet && name == "work" { "0.125" } else { cell });
        writer.write_record(cells).unwrap();
    }
    writer.flush().unwrap();
    let words = "--data e.csv --solvers r,v --output e.svg";
    let text = said(folder, format!("{CHAIN} {words}"));
    assert!(text.contains("*0.12"), "{text}");
}

/// Ctrl-C in the middle: the runs so far are drawn and saved, and the next command gives the chart
/// that this one would have given.
#[cfg(unix)]
#[test]
fn an_interrupted_chart_draws_what_it_has() {
    let folder = &Folder::new();
    let run = "chart --scene mit --work evaluations --until 1 --solvers t,r,v,a";
    let interrupted = format!("{run} --data i.csv --output i.svg");
    let mut child = command(folder, &interrupted).spawn().unwrap();
    // Once the first method is in the file.
    let data = folder.join("i.csv");
    while !data.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before");
        std::thread::sleep(Duration::from_millis(5));
    }
    let interrupt = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupt.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("interrupted: the chart has what was measured"), "{stderr}");
    assert!(folder.join("i.svg").exists());
    let partial = fs::read_to_string(&data).unwrap();
    said(folder, &interrupted);
    said(folder, format!("{run} --data j.csv --output j.svg"));
    let [whole, straight] = ["i.csv", "j.csv"].map(|n| fs::read_to_string(folder.join(n)).unwrap());
    assert!(partial.len() < whole.len());
    assert!(whole == straight);
}

#[test]
fn stiffness_makes_panels_and_other_errors_count() {
    let folder = &Folder::new();
    let words =
        "--stiffness 1,100 --solvers v,r --error energy --until 0.5 -o p.png --size 800x500";
    let text = said(folder, format!("{CHAIN} {words}"));
    assert!(text.contains("stiffness x 100") && text.contains("1e-4 J"), "{text}");
    let picture = image::open(folder.join("p.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (800, 500));
}

#[test]
fn seconds_are_measured() {
    let folder = &Folder::new();
    let words = "chart --scene simple --solvers e,r --until 2 --data s.json";
    let text = said(folder, words);
    assert!(text.contains("computing time (ms)"), "{text}");
    assert!(folder.join("a3-chart-simple.svg").exists());
    let runs: serde_json::Value = folder.json("s.json");
    let runs = runs.as_array().unwrap();
    assert!(runs.iter().any(|run| run["seconds"].as_f64().is_some_and(|s| s > 0.0)));
    for run in runs {
        assert!(run["seconds"].is_number() || run["lost_at"].is_number());
    }
}

#[test]
fn a_long_horizon_is_warned_of() {
    let folder = &Folder::new();
    let words = "chart --scene double-pendulum --until 8 --solvers r --work evaluations";
    let output = a3(folder, words);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.contains("warning: ") && stderr.contains("Lyapunov time"), "{stderr}");
}

#[test]
fn wrong_usage_is_one_line() {
    let folder = &Folder::new();
    folder.write("bad.csv", "a,b\n1,2\n");
    folder.write("bad.json", "[{\"scene\": 1}]");
    let bounce = include_str!("../../../../docs/scenes/bounce.toml");
    folder.write("bounce.toml", bounce);
    for (words, right, code) in [
        ("chart --solvers t,q", "`a3 solvers` lists", 2),
        ("chart --stiffness 1,0", "such as 10", 2),
        ("chart --stiffness -1", "such as 10", 2),
        ("chart --stiffness 2 --scene simple", "has no springs", 2),
        ("chart --until 0", "such as 1", 2),
        ("chart --until nan", "such as 1", 2),
        ("chart --error speed", "position", 2),
        ("chart --error energy --scene simple", "ask for position or phase", 2),
        ("choose --error 1e-3 --of strain --scene simple", "ask for position or phase", 2),
        ("chart --error impact --scene chain", "no surfaces touch in the scene chain", 2),
        ("choose --error 1e-3 --of strain --scene cantilever", "cantilever has no springs", 2),
        (
            "choose --error 1e-3 --of impact --until 0.1 --scene bounce.toml",
            "no impact begins or ends in 0.1 s",
            2,
        ),
        ("chart --particle 4 --scene chain", "its particles are 0 to 3", 2),
        ("chart --work joules", "evaluations", 2),
        ("chart --output x.gif", ".svg, .pdf or .png", 2),
        ("chart --data x.txt", ".csv or .json", 2),
        ("chart --data bad.csv", "does not hold the data of a chart", 2),
        ("chart --data bad.json", "does not hold the data of a chart", 2),
        ("chart --output no/x.svg", "there is no folder no", 1),
        ("chart --size 10x10", "320x240", 2),
        ("chart --solvers v --scene simple", "needs forces", 2),
        ("stability --step 0", "such as 0.01", 2),
        ("stability --output s.eps", ".svg, .pdf or .png", 2),
        ("choose", "--error", 2),
        ("choose --error 0", "such as 1e-3", 2),
        ("choose --budget -1", "such as 2", 2),
        ("choose --error 1e-3 --budget 1", "--error", 2),
        ("choose --error 1e-12 --scene chain", "at least", 2),
        ("a 3", "relative tolerance", 2),
        ("x 1e-20", "such as 0.01", 2),
    ] {
        let output = a3(folder, words);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{words:?}: {stderr}");
        assert!(stderr.starts_with("error: ") && stderr.contains(right), "{words:?}: {stderr}");
    }
    assert_eq!(folder.count(), 3);
}

/// `--open` gives the picture, by its whole path, to the program of the desktop.
#[cfg(target_os = "linux")]
#[test]
fn a_chart_opens_in_the_viewer() {
    let folder = &Folder::new();
    let viewer = folder.join("xdg-open");
    folder.write("xdg-open", "#!/bin/sh\n/bin/cp \"$1\" shown.tmp && /bin/mv shown.tmp shown\n");
    let runs = std::os::unix::fs::PermissionsExt::from_mode(0o700);
    fs::set_permissions(&viewer, runs).unwrap();
    let shown = folder.join("shown");
    let hung = "gravity = [0, -9.81, 0]\ndrag_per_mass = 4\n[[cloth]]\ngrid = [9, 9]\nwidth = 1\ndensity = 1\n\
        stiffness = [200, 0, 0]\nat = [0, 0, 0]\npin = [{ at = [\"top\"] }]\n";
    folder.write("hung.toml", hung);
    let chart = format!("{CHAIN} --solvers r --until 0.1 --no-model");
    let stability = "stability --scene simple --solvers r";
    let simplify = "simplify --scene hung.toml --error 1e-2 --until 1";
    let open = |words: &str| {
        let mut command = command(folder, format!("{words} --open"));
        command.env("PATH", &**folder).output().unwrap()
    };
    for (words, file) in [
        (&*chart, "a3-chart-chain.svg"),
        (stability, "a3-stability-simple.svg"),
        (simplify, "a3-simplify-hung.svg"),
    ] {
        let output = open(words);
        let [said, why] = [output.stdout, output.stderr].map(|it| String::from_utf8(it).unwrap());
        assert!(said.contains(&format!("chart: {file}")), "{said}{why}");
        let begun = std::time::Instant::now();
        while !shown.exists() {
            assert!(begun.elapsed() < Duration::from_secs(20), "{words:?}: {why}");
            std::thread::sleep(Duration::from_millis(10));
        }
        let picture = folder.bytes(file);
        assert!(fs::read(&shown).unwrap() == picture, "{file}");
        fs::remove_file(&shown).unwrap();
    }
    fs::remove_file(viewer).unwrap();
    let output = open(stability);
    let why = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{why}");
    assert!(
        why.starts_with("error: a3-stability-simple.svg: it is written, but no viewer"),
        "{why}"
    );
}
