//! Limits of steps, and solvers chosen for a scene.

use crate::common::{Folder, said};

#[test]
fn bounded_accurate_and_slowly_growing_steps_are_told_apart() {
    let folder = &Folder::new();
    let words = "stability --scene mit --solvers t,r,v,x,s -o s.svg";
    let text = said(folder, words);
    let mut rows = 0;
    for line in text.lines() {
        let cells = line.split_whitespace().skip(1);
        // Of an interval, the longest step that held.
        let number = |cell: &str| cell.rsplit('\u{2013}').next()?.parse().ok();
        let cells: Vec<f64> = cells.map_while(number).collect();
        if let [bounded, tenfold, seen, moving, accurate] = cells[..] {
            assert!(bounded <= tenfold, "{line}");
            assert!((0.97..1.03).contains(&(seen / tenfold)), "{line}");
            assert!(accurate <= moving, "{line}");
            // An unsharp limit: motion grows slowly while the cloth moves to another shape.
            let most = if line.contains('\u{2013}') { 2.0 } else { 1.1 };
            assert!((0.9..most).contains(&(moving / tenfold)), "{line}");
            rows += 1;
        }
    }
    assert_eq!(rows, 5, "{text}");
    for word in ["a\u{2013}b       not sharp", "grows tenfold in 10 s"] {
        assert!(text.contains(word), "{word} in {text}");
    }
    let svg = folder.read("s.svg");
    for word in ["Where solvers fail: mit", "Re(h", "not sharp", "slowly"] {
        assert!(svg.contains(word), "{word}");
    }
}

/// A box on damped springs: its limits at rest are known too, and those of a solver do not depend
/// on the others that are asked for.
#[test]
fn limits_of_a_solver_do_not_depend_on_the_others() {
    let folder = &Folder::new();
    let scene = "gravity = [0, -9.81, 0]
        drag = 0.04
        springs = [[0, 10, 25, 0.5, 0], [1, 5, 30, 0.55, 0.05], [2, 8, 20, 0.6, 0]]
        [particles]
        positions = [[0.6, 0.5, 0.1], [-0.5, 0.6, -0.2], [0.1, 0.4, 0.6]]
        mass = 1
        pin = [{ particles = [0, 1, 2] }]
        [[body]]
        parts = [{ box = [0.3, 0.2, 0.15] }]
        mass = 0.9
        at = [0, 0, 0]
        velocity = [0.3, 0.2, -0.1]
        spin = [1, 4, -2]";
    folder.write("box.toml", scene);
    let pefrl = |solvers: &str| -> serde_json::Value {
        let words = "stability --scene box.toml -o s.svg --data s.json --solvers";
        let text = said(folder, format!("{words} {solvers}"));
        assert!(!text.contains(" 0\u{2013}") && !text.contains("ratio -"), "{text}");
        let rows = folder.read("s.json");
        let rows: Vec<serde_json::Value> = serde_json::from_str(&rows).unwrap();
        let row = rows.into_iter().find(|row| row["solver"] == "pefrl");
        row.unwrap()
    };
    let alone = pefrl("p");
    assert_eq!(alone, pefrl("e,t,r,s,v,p,h"));
    let [by_modes, seen] = [&alone["rest_tenfold"], &alone["rest_observed"]["longest_held"]];
    let ratio = seen.as_f64().unwrap() / by_modes.as_f64().unwrap();
    assert!((0.97..1.03).contains(&ratio), "{alone}");
}

/// The rods of a double pendulum are held by a feedback that is damped; its motion is not.
#[test]
fn the_feedback_of_constraints_is_no_motion() {
    let folder = &Folder::new();
    let words = "stability --scene double-pendulum --solvers r -o s.svg";
    let text = said(folder, words);
    let head = text.lines().next().unwrap();
    assert!(!head.contains("damping ratio 1.000"), "{head}");
    assert!(head.ends_with("; errors of constraints decay at 10.0 / s"), "{head}");
    // A rod that falls from its upright place, in drag.
    let scene = "gravity = [0, -9.81, 0]
        drag = 0.3
        [particles]
        positions = [[0, 0, 0], [0, 1, 0]]
        mass = 1
        pin = [{ particles = [0] }]
        [[constraint]]
        rod = [0, 1]";
    folder.write("rod.toml", scene);
    let words = "stability --scene rod.toml --solvers r -o s.svg";
    let text = said(folder, words);
    let head = text.lines().next().unwrap();
    assert!(!head.contains("damping ratio 1.000"), "{head}");
}

#[test]
fn an_absolute_tolerance_is_in_metres() {
    let folder = &Folder::new();
    let steps = |more: &str| -> u64 {
        let words = "simulate x 1e-4 --scene chain --until 1 -o x.json --summary -";
        let text = said(folder, format!("{words} {more}"));
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        summary["steps"].as_u64().unwrap()
    };
    let (usual, close) = (steps(""), steps("--absolute 1e-9"));
    // Errors of order 8: a hundred thousandth takes 10^(5/8) = 4 times the steps.
    assert!(close > 2 * usual, "{usual} {close}");
}

#[test]
fn a_choice_comes_with_its_command() {
    let folder = &Folder::new();
    let text = said(folder, "choose --error 1e-4 --scene chain");
    for word in ["best", "runner-up", "an error of 1e-4 m", "time/frame"] {
        assert!(text.contains(word), "{word} in\n{text}");
    }
    let line = text.lines().find_map(|line| line.strip_prefix("run it:  a3 ")).unwrap();
    assert!(line.contains("--scene chain"), "{line}");
    // The same arguments, without a window.
    said(folder, format!("simulate {line} --until 1 --output c.json"));
    let text = said(folder, "choose --budget 5 --scene simple --until 2");
    assert!(text.contains("5 ms per frame") && text.contains("run it:  a3 "), "{text}");
}

/// A rod falls from its upright place: differences grow 10-fold in 10 s, which is not hardly.
#[test]
fn growth_is_told_by_its_size() {
    let folder = &Folder::new();
    let note = |gravity: &str| {
        let scene = format!(
            "gravity = [0, {gravity}, 0]
            [particles]
            positions = [[0, 0, 0], [0, 1, 0]]
            mass = 1
            pin = [{{ particles = [0] }}]
            [[constraint]]
            rod = [0, 1]
            [state]
            positions = [[0, 0, 0], [0, 1, 0]]
            velocities = [[0, 0, 0], [0.01, 0, 0]]"
        );
        folder.write("rod.toml", scene);
        let words = "choose --error 1e-3 --work evaluations --scene rod.toml";
        said(folder, words)
    };
    let falls = note("-0.09");
    assert!(
        falls.contains("small differences grow ") && falls.contains("-fold by themselves in 10 s"),
        "{falls}"
    );
    let hangs = note("0.09");
    assert!(hangs.contains("small differences hardly grow by themselves"), "{hangs}");
}
