//! Limits of steps, and solvers chosen for a scene.

use std::fs;

use super::charts::said;

#[test]
fn bounded_accurate_and_slowly_growing_steps_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "stability",
        "--scene",
        "mit",
        "--solvers",
        "t,r,v,x,s",
        "-o",
        "s.svg",
    ];
    let text = said(folder.path(), &words);
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
    let svg = fs::read_to_string(folder.path().join("s.svg")).unwrap();
    for word in ["Where solvers fail: mit", "Re(h", "not sharp", "slowly"] {
        assert!(svg.contains(word), "{word}");
    }
}

#[test]
fn an_absolute_tolerance_is_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    let steps = |more: &[&str]| -> u64 {
        let words = "simulate x 1e-4 --scene chain --until 1 -o x.json --summary -";
        let words: Vec<_> = words.split(' ').chain(more.iter().copied()).collect();
        let text = said(folder.path(), &words);
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        summary["steps"].as_u64().unwrap()
    };
    let (usual, close) = (steps(&[]), steps(&["--absolute", "1e-9"]));
    // Errors of order 8: a hundred thousandth takes 10^(5/8) = 4 times the steps.
    assert!(close > 2 * usual, "{usual} {close}");
}

#[test]
fn a_choice_comes_with_its_command() {
    let folder = tempfile::tempdir().unwrap();
    let text = said(
        folder.path(),
        &["choose", "--error", "1e-4", "--scene", "chain"],
    );
    for word in ["best", "runner-up", "an error of 1e-4 m", "time/frame"] {
        assert!(text.contains(word), "{word} in\n{text}");
    }
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("run it:  a3 "))
        .unwrap();
    let mut words: Vec<_> = line.split_whitespace().collect();
    assert!(
        words.contains(&"--scene") && words.contains(&"chain"),
        "{line}"
    );
    // The same arguments, without a window.
    words.splice(0..0, ["simulate"]);
    words.extend(["--until", "1", "--output", "c.json"]);
    said(folder.path(), &words);
    let text = said(
        folder.path(),
        &[
            "choose", "--budget", "5", "--scene", "simple", "--until", "2",
        ],
    );
    assert!(
        text.contains("5 ms per frame") && text.contains("run it:  a3 "),
        "{text}"
    );
}
