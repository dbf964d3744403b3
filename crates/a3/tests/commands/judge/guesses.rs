//! What `a3 judge` finds out of a program by itself: its step, its precision, and its constants.

use std::time::Instant;

use super::course::{Course, Step, cloth, judged, slowed, symplectic, trapezoid, write};
use crate::common::{Folder, said};

#[test]
fn the_step_is_found_if_rows_lie_between_steps() {
    let folder = &Folder::new();
    let simulate = |step: &str| {
        let words = "--scene chain --fps 30 --until 2 --output mine.csv";
        said(folder, format!("simulate t {step} {words}"));
    };
    simulate("0.01");
    let found = judged(folder, "chain", "mine.csv").remove(0);
    let method = &found["method"];
    assert_eq!(method["solver"], "trapezoid", "{found:#}");
    assert_eq!((&method["step"], &method["points"]), (&0.01.into(), &3.into()));
    // A step that nobody types is asked for, and no neighbour is named.
    simulate("0.0137");
    let words = "judge --scene chain mine.csv";
    let report = said(folder, words);
    assert!(report.contains("if its step is another, add --step"), "{report}");
    assert!(!report.contains("nearest"), "{report}");
    let report = said(folder, format!("{words} --step 0.0137"));
    assert!(report.contains("(Heun) at 0.0137 s"), "{report}");
}

/// A part of many thousands of rows is compared. Between each two of them lies a whole number of
/// steps.
#[test]
fn the_step_is_found_in_a_file_of_many_rows() {
    let folder = &Folder::new();
    let words = "simulate r 0.0005 --scene double-pendulum --fps 20000 --until 0.5 -o mine.csv";
    said(folder, words);
    let found = judged(folder, "double-pendulum", "mine.csv").remove(0);
    assert_eq!(found["method"]["solver"], "rk4", "{found:#}");
    assert_eq!(found["method"]["step"], 5e-4);
    assert!(found["times"].as_array().unwrap().len() <= 2000);
    assert_eq!(found["until"], 0.5);
}

/// An accurate method at the distance of the rows is near, too, but not as near as the right one.
#[test]
fn steps_far_shorter_than_the_distance_of_rows_are_found() {
    let folder = &Folder::new();
    for step in [2e-3, 1e-3] {
        said(folder, format!("simulate r {step} --scene chain --fps 20 --until 2 -o mine.csv"));
        let found = judged(folder, "chain", "mine.csv").remove(0);
        assert_eq!(found["method"]["solver"], "rk4", "{found:#}");
        assert_eq!(found["method"]["step"], step, "{found:#}");
    }
}

/// No way to compute steps changes the first row.
#[test]
fn a_file_with_another_start_takes_no_search() {
    let folder = &Folder::new();
    let course = Course::of(&said(folder, "scenes --print chain --list"));
    let mut states = course.run(trapezoid, 0.01, 200);
    states.iter_mut().flatten().for_each(|all| all.reverse());
    write(&folder.join("mine.csv"), 0.01, &states, true);
    let begun = Instant::now();
    let found = judged(folder, "chain", "mine.csv").remove(0);
    let seconds = begun.elapsed().as_secs_f64();
    assert!(seconds < 10.0, "{seconds} s");
    assert!(found["method"].is_null(), "{found:#}");
}

#[test]
fn single_precision_is_recognised() {
    let folder = &Folder::new();
    folder.write("cloth.toml", cloth(false));
    for (scene, h) in [("chain", 0.01f32), ("cloth.toml", 0.004)] {
        let course = Course::of(&said(folder, format!("scenes --print {scene} --list")));
        write(&folder.join("mine.csv"), f64::from(h), &course.run_single(h, 60), true);
        let report = said(folder, format!("judge --scene {scene} mine.csv"));
        let line = format!("agrees with symplectic Euler at {h} s in single precision to ");
        assert!(report.contains(&line), "{report}");
        let found = judged(folder, scene, "mine.csv").remove(0);
        assert_eq!(found["method"]["single_precision"], true, "{found:#}");
        // A few wrong digits in double precision are no single precision.
        let mut states = course.run(symplectic, f64::from(h), 60);
        states.iter_mut().flatten().flatten().flatten().for_each(|x| *x *= 1.0 + 1e-7);
        write(&folder.join("other.csv"), f64::from(h), &states, true);
        let found = judged(folder, scene, "other.csv").remove(0);
        assert!(found["method"].is_null(), "{found:#}");
    }
}

#[test]
fn constants_that_are_a_little_off_are_named() {
    let folder = &Folder::new();
    folder.write("cloth.toml", cloth(false));
    for (scene, h) in [("chain", 0.01), ("cloth.toml", 0.004)] {
        let list = said(folder, format!("scenes --print {scene} --list"));
        let mut light = Course::of(&list);
        light.gravity = light.gravity.map(|g| g * 9.8 / 9.81);
        let mut stiff = Course::of(&list);
        stiff.spring = |k, length, rest| 1.01 * k * (length - rest);
        let runs: [(&str, &Course, Step, &str, f64); 3] = [
            ("g.csv", &light, symplectic, "gravity", 9.8 / 9.81),
            ("k.csv", &stiff, trapezoid, "stiffness", 1.01),
            ("v.csv", &Course::of(&list), slowed, "velocities at the end of each step", 0.99),
        ];
        for (name, course, step, constant, factor) in runs {
            write(&folder.join(name), h, &course.run(step, h, 60), true);
            let found = judged(folder, scene, name).remove(0);
            let way = &found["method"];
            assert_eq!(way["constant"], constant, "{scene} {name}: {found:#}");
            let off = way["factor"].as_f64().unwrap() - factor;
            assert!(off.abs() < 1e-7, "{scene} {name}: {off}");
        }
    }
    let report = said(folder, "judge --scene cloth.toml g.csv");
    let words = "but with a gravity of 9.8 m/s² in place of 9.81 m/s²";
    assert!(report.contains(words), "{report}");
}

#[test]
fn constants_that_are_far_off_are_named() {
    let folder = &Folder::new();
    let list = said(folder, "scenes --print chain --list");
    let judged_as = |scene: &str, course: &Course| {
        let states = course.run(trapezoid, 0.004, 200);
        write(&folder.join("mine.csv"), 0.004, &states, false);
        judged(folder, scene, "mine.csv").remove(0)
    };
    for factor in [0.3, 0.5, 3.0] {
        let (mut heavy, mut strong) = (Course::of(&list), Course::of(&list));
        heavy.mass.iter_mut().for_each(|mass| *mass *= factor);
        strong.gravity = strong.gravity.map(|g| g * factor);
        for (constant, course) in [("mass", heavy), ("gravity", strong)] {
            let found = judged_as("chain", &course);
            let way = &found["method"];
            assert_eq!(way["constant"], constant, "{factor}: {found:#}");
            let off = way["factor"].as_f64().unwrap() - factor;
            assert!(off.abs() < 1e-7, "{constant}: {off}");
        }
    }
    folder.write("cloth.toml", cloth(false));
    let list = said(folder, "scenes --print cloth.toml --list");
    let (mut loose, mut still) = (Course::of(&list), Course::of(&list));
    loose.spring = |_, _, _| 0.0;
    still.v.fill([0.0; 3]);
    for (course, mistake) in [(loose, "springs without stiffness"), (still, "a start at rest")] {
        let found = judged_as("cloth.toml", &course);
        assert_eq!(found["method"]["mistake"], mistake, "{found:#}");
    }
}
