//! Results of another program as `a3 judge` sees them.

mod course;
mod guesses;

use crate::common::{Folder, a3, complaint, said, simulate, text};
use course::{
    Course, Step, Triple, cloth, euler, judged, positions_first, symplectic, trapezoid,
    trapezoid_late, write,
};

#[test]
fn methods_and_mistakes_of_another_program_are_named() {
    let folder = &Folder::new();
    folder.write("large.toml", cloth(false));
    folder.write("small.toml", cloth(true));
    for (scene, h) in [("chain", 0.01), ("large.toml", 0.004), ("small.toml", 0.004)] {
        let list = said(folder, format!("scenes --print {scene} --list"));
        let course = || Course::of(&list);
        let mut half = course();
        half.gravity = half.gravity.map(|g| g / 2.0);
        let mut no_rest = course();
        no_rest.spring = |k, length, _| k * length;
        let mut not_normalised = course();
        not_normalised.spring = |k, length, rest| k * (length - rest) * length;
        let mut one_end = course();
        one_end.on_both = false;
        let mut free = course();
        free.pinned.clear();
        let runs: [(&str, &Course, Step, &str, Option<&str>); 10] = [
            ("e", &course(), euler, "explicit Euler", None),
            ("s", &course(), symplectic, "symplectic Euler", None),
            ("t", &course(), trapezoid, "explicit trapezoid (Heun)", None),
            ("p", &course(), positions_first, "symplectic Euler, positions first", None),
            ("l", &course(), trapezoid_late, "explicit trapezoid (Heun)", None),
            ("g", &half, symplectic, "symplectic Euler", Some("half the gravity")),
            ("r", &no_rest, euler, "explicit Euler", Some("rest lengths of 0")),
            (
                "n",
                &not_normalised,
                trapezoid,
                "explicit trapezoid (Heun)",
                Some("spring directions that are not normalised"),
            ),
            ("o", &one_end, euler, "explicit Euler", Some("spring forces on the first end only")),
            ("f", &free, euler, "explicit Euler", Some("pins that move")),
        ];
        let names: Vec<_> = runs.iter().map(|run| format!("{}.csv", run.0)).collect();
        for (k, (run, name)) in runs.iter().zip(&names).enumerate() {
            write(&folder.join(name), h, &run.1.run(run.2, h, 60), k % 2 == 0);
        }
        let found = judged(folder, scene, &names.join(" "));
        for (found, (name, _, _, title, mistake)) in found.iter().zip(runs) {
            let method = &found["method"];
            assert_eq!(method["title"], *title, "{scene} {name}: {found:#}");
            let slip =
                mistake.or((name == "l").then_some("the second evaluation at the old velocity"));
            assert_eq!(method["mistake"].as_str(), slip, "{scene} {name}");
            let asks = mistake.is_some() || ["p", "l"].contains(&name);
            assert_eq!(method["question"].is_string(), asks, "{scene} {name}");
            assert_eq!(method["step"].as_f64(), Some(h), "{scene} {name}");
            assert!(method["distance"].as_f64().unwrap() < 1e-12, "{scene} {name}");
        }
    }
}

#[test]
fn errors_orders_and_limits_are_told() {
    let folder = &Folder::new();
    let course = Course::of(&said(folder, "scenes --print chain --list"));
    for (name, h) in [("a.csv", 0.02), ("b.csv", 0.01)] {
        let count = (1.0 / h) as usize;
        write(&folder.join(name), h, &course.run(trapezoid, h, count), true);
    }
    let both = "judge --scene chain a.csv b.csv";
    let report = said(folder, both);
    let order = report.lines().find_map(|line| line.strip_prefix("order "));
    let order: f64 = order.unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((order - 2.0).abs() < 0.05, "{report}");
    // The error at the end is that against an accurate run.
    let exact = simulate(folder, "dop853 1e-12 --scene chain --until 1");
    let exact: Vec<Triple> = serde_json::from_value(exact["positions"].clone()).unwrap();
    let [x, _] = &course.run(trapezoid, 0.02, 50)[50];
    let pairs = x.as_flattened().iter().zip(exact.as_flattened());
    let square: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
    let found = &judged(folder, "chain", "a.csv")[0];
    let errors = found["errors"].as_array().unwrap();
    let last = errors.last().unwrap().as_f64().unwrap();
    let own = (square / x.len() as f64).sqrt();
    assert!((last - own).abs() < 1e-9, "{last} {own}");
    // The limit is between the errors of both.
    let worst = |k: usize| judged(folder, "chain", "a.csv b.csv")[k]["error"].as_f64().unwrap();
    let limit = (worst(0) * worst(1)).sqrt();
    let missed = a3(folder, format!("{both} --within {limit}"));
    assert_eq!(missed.status.code(), Some(1));
    let why = text(&missed.stderr);
    assert!(why.starts_with("error: a.csv: it errs by") && why.lines().count() == 1, "{why}");
    assert!(text(&missed.stdout).contains("within    yes"));
    let words = format!("judge --scene chain b.csv --within {limit}");
    said(folder, words);
}

#[test]
fn every_format_is_read_alike() {
    let folder = &Folder::new();
    let of = |file: &str| {
        let found = judged(folder, "chain", &format!("{file} --step 0.01")).remove(0);
        let method = &found["method"];
        assert_eq!(method["solver"], "rk4", "{file}: {found:#}");
        (found["error"].as_f64().unwrap(), found["energy_error"].as_f64().unwrap())
    };
    let mut all = vec![];
    for file in ["a.csv", "a.json", "a.npz"] {
        let words = "simulate rk4 0.01 --scene chain --until 1 --fps 60 --output";
        said(folder, format!("{words} {file}"));
        all.push(of(file));
    }
    assert!(all.iter().all(|found| *found == all[0]), "{all:?}");
    // Another program's names, separators and digits.
    let csv = folder.read("a.csv");
    let digits = |cell: &str| cell.parse().map_or(cell.into(), |x: f64| format!("{x:.7}"));
    let lines = csv.lines().map(|line| {
        let cells: Vec<_> = line.split(',').map(digits).collect();
        let particle = line.split(',').nth(2).unwrap();
        [cells[1].as_str(), particle, &cells[3], &cells[4], &cells[5]].join("; ")
    });
    let rounded: Vec<_> = lines.collect();
    folder.write("b.txt", rounded.join("\n"));
    let found = judged(folder, "chain", "b.txt --step 0.01").remove(0);
    assert_eq!(found["method"]["solver"], "rk4", "{found:#}");
    assert!(found["energy_error"].is_null());
}

#[test]
fn a_list_is_read_back_and_moves_alike() {
    let folder = &Folder::new();
    folder.write("cloth.toml", cloth(false));
    for scene in ["pendulum", "chain", "mit", "cloth.toml"] {
        let list = said(folder, format!("scenes --print {scene} --list"));
        folder.write("list.json", list);
        let end = |scene: &str| {
            let state = simulate(folder, format!("rk4 0.005 --until 0.5 --scene {scene}"));
            serde_json::from_value::<Vec<Triple>>(state["positions"].clone()).unwrap()
        };
        let (listed, own) = (end("list.json"), end(scene));
        let pairs = listed.as_flattened().iter().zip(own.as_flattened());
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 1e-12, "{scene}: {most}");
    }
    for (scene, part) in [
        ("cloth", "floor"),
        ("flag", "wind, capsule"),
        ("simple", "single equation"),
        ("drop", "fluid"),
    ] {
        let why = complaint(&a3(folder, format!("scenes --print {scene} --list")), 2);
        assert!(why.contains(part), "{why}");
    }
}

#[test]
fn a_file_that_does_not_fit_is_refused_in_a_line_and_those_beside_it_are_judged() {
    let folder = &Folder::new();
    let course = Course::of(&said(folder, "scenes --print pendulum --list"));
    let states = course.run(symplectic, 0.01, 20);
    write(&folder.join("good.csv"), 0.01, &states, false);
    let good = folder.read("good.csv");
    for (bad, why) in [
        (String::new(), "empty"),
        ("1,2,3".into(), "names no time"),
        ("t,x0,y0,z0\n0,0,0,0".into(), "1 particle, and the scene has 2"),
        (good.replacen("\n0.05", "\n0.01", 1), "times must increase: after 0.04 s comes 0.01 s"),
        (good.replacen("\n0,", "\nNaN,", 1), "a time must be a number of seconds from 0"),
        (good.replacen("\n0,0,", "\n0,nan,", 1), "first state has numbers that are not finite"),
        (good.replacen("\n0,0,", "\n0,O,", 1), "line 2: `O` is no number"),
        (good.replacen("\n0.01,", "\n0.01,1,", 1), "line 3: it has 8 columns"),
    ] {
        folder.write("bad.csv", bad);
        let line = complaint(&a3(folder, "judge --scene pendulum bad.csv"), 2);
        assert!(line.starts_with("error: bad.csv: ") && line.contains(why), "{line}");
        let both = a3(folder, "judge --scene pendulum bad.csv good.csv");
        assert_eq!(both.status.code(), Some(2));
        assert!(text(&both.stdout).contains("agrees with symplectic Euler at 0.01 s"));
        assert!(text(&both.stderr).contains(why));
    }
    // A run that blew up is judged until then, and is not within any error.
    let lines: Vec<_> = good.lines().map(str::to_owned).collect();
    let (kept, lost) = lines.split_at(15);
    let lost =
        lost.iter().map(|line| format!("{},nan,0,0,nan,0,0", line.split(',').next().unwrap()));
    let lines: Vec<_> = kept.iter().cloned().chain(lost).collect();
    folder.write("lost.csv", lines.join("\n"));
    let lost = a3(folder, "judge --scene pendulum lost.csv --within 1");
    assert_eq!(lost.status.code(), Some(1));
    assert!(text(&lost.stdout).contains("not finite from 0.14 s on"), "{}", text(&lost.stdout));
    assert!(text(&lost.stdout).contains("agrees with symplectic Euler"));
}

#[test]
fn files_are_on_the_chart() {
    let folder = &Folder::new();
    let course = Course::of(&said(folder, "scenes --print pendulum --list"));
    write(&folder.join("first-try.csv"), 0.01, &course.run(euler, 0.01, 100), false);
    for more in ["", "--seconds 0.001"] {
        let words = "judge --scene pendulum first-try.csv --chart chart.svg";
        let report = said(folder, format!("{words} {more}"));
        assert!(report.ends_with("chart: chart.svg\n"), "{report}");
        let picture = folder.read("chart.svg");
        assert!(picture.contains("first-try"), "{more:?}");
        assert_eq!(picture.contains("computing time"), !more.is_empty());
    }
}

/// Explicit Euler is unstable at this step: the rows grow beyond all that double precision tells
/// apart from the start.
#[test]
fn a_run_that_explodes_is_named_by_its_first_rows() {
    let folder = &Folder::new();
    let course = Course::of(&said(folder, "scenes --print chain --list"));
    let states = course.run(euler, 0.1, 300);
    assert!(states[300][0][3][1].abs() > 1e20);
    write(&folder.join("lost.csv"), 0.1, &states, true);
    let found = judged(folder, "chain", "lost.csv").remove(0);
    assert_eq!(found["method"]["title"], "explicit Euler", "{:#}", found["method"]);
    assert_eq!(found["method"]["step"], 0.1);
}
