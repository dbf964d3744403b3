//! What a scene can do without, judged by runs by hand and by closed forms.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{Folder, a3, complaint, said, simulate};

/// A cloth in still air, with a useless part of many kinds.
const USELESS: &str = r#"
duration = 1
gravity = [0, -9.81, 0]
drag = 2e-4
floor = { height = -20, friction = 0.3 }
[[cloth]]
grid = [9, 9]
width = 1
density = 0.2
stiffness = [400, 100, 1e-6]
damping = 1e-8
strain_limit = 3.0
friction = 0.5
at = [0, 0, 0]
pin = [{ at = ["top"] }]
sway = [0, 0, 0.5]
[[sphere]]
center = [5, 0, 0]
radius = 0.3
[[box]]
center = [-5, 0, 0]
size = [1, 1, 1]
"#;

/// Parts of that scene that change nothing.
const IDLE: [&str; 7] =
    ["damping of springs", "bend springs", "limit of strain", "friction", "floor", "sphere", "box"];

/// The number in the second column of a row of the table.
fn change(table: &str, row: &str) -> f64 {
    let line = table.lines().find(|line| line.starts_with(row));
    let line = line.unwrap_or_else(|| panic!("{row} in {table}"));
    let numbers = line[row.len()..].split_whitespace();
    numbers.flat_map(str::parse).next().unwrap()
}

/// The error of the grid and its order, as they are said.
fn of_grid(table: &str) -> [f64; 2] {
    let number = |after: &str, end: char| {
        let rest = table.split(after).nth(1).unwrap();
        rest.split(end).next().unwrap().parse().unwrap()
    };
    [number("errs by about ", ' '), number("(order ", ')')]
}

/// The change of each model in a file of effects.
fn effects(file: &Path) -> Vec<(String, f64)> {
    let mut rows = csv::Reader::from_path(file).unwrap();
    let keys = rows.headers().unwrap().clone();
    let at = |key: &str| keys.iter().position(|found| found == key).unwrap();
    let (model, change) = (at("model"), at("change"));
    let rows = rows.records().map(Result::unwrap);
    rows.map(|row| (row[model].to_owned(), row[change].parse().unwrap())).collect()
}

/// Positions of a final state, particle by particle.
fn positions(state: &Value) -> Vec<[f64; 3]> {
    serde_json::from_value(state["positions"].clone()).unwrap()
}

/// Root mean square distance of particles.
fn distance(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    (pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn useless_parts_are_found_and_effects_are_those_of_runs_by_hand() {
    let folder = &Folder::new();
    folder.write("useless.toml", USELESS);
    let words = "simplify --scene useless.toml --error 2e-3 --at-end --until 1 -o lean.toml --data effects.csv";
    let table = said(folder, words);
    for part in IDLE {
        let line = table.lines().find(|line| line.starts_with(part)).unwrap();
        assert!(line.ends_with("leave it out"), "{line}");
    }
    for part in ["structural springs", "gravity"] {
        let line = table.lines().find(|line| line.starts_with(part)).unwrap();
        assert!(line.ends_with("needed"), "{line}");
    }
    let run =
        |scene: &str| positions(&simulate(folder, format!("rk4 0.0005 --scene {scene} --until 1")));
    let whole = run("useless.toml");
    let effects = effects(&folder.join("effects.csv"));
    let without = |line: &str, part: &str, by: &str| {
        assert!(USELESS.contains(line));
        folder.write("other.toml", USELESS.replace(line, by));
        let by_hand = distance(&whole, &run("other.toml"));
        let &(_, found) = effects.iter().find(|(model, _)| model == part).unwrap();
        // The accurate runs err by up to 4e-5 m.
        let tolerated = 0.01 * by_hand + 4e-5;
        assert!((found - by_hand).abs() < tolerated, "{part}: {found} {by_hand}");
    };
    without("drag = 2e-4", "drag", "");
    without("gravity = [0, -9.81, 0]", "gravity", "");
    without("[400, 100, 1e-6]", "shear springs", "[400, 0, 1e-6]");
    // The scene that was written, by its own solver.
    let text = folder.read("lean.toml");
    for key in ["floor", "sphere", "box", "strain_limit", "friction"] {
        assert!(!text.contains(key), "{key} in {text}");
    }
    let lean = simulate(folder, "--scene lean.toml --until 1");
    let error = distance(&whole, &positions(&lean));
    assert!(error < 2e-3, "{error} {table}");
}

/// Savings are the same from one command to the next, though the machine does other work, too.
#[test]
fn savings_are_steady() {
    let folder = &Folder::new();
    folder.write("useless.toml", USELESS);
    let times = |file: &str| -> Vec<(String, f64)> {
        let words = "simplify --scene useless.toml --error 2e-3 --until 1 --data";
        said(folder, format!("{words} {file}"));
        let mut rows = csv::Reader::from_path(folder.join(file)).unwrap();
        let keys = rows.headers().unwrap().clone();
        let at = |key: &str| keys.iter().position(|found| found == key).unwrap();
        let (model, time) = (at("model"), at("time"));
        let rows = rows.records().map(Result::unwrap);
        rows.map(|row| (row[model].to_owned(), row[time].parse().unwrap())).collect()
    };
    let (first, second) = (times("a.csv"), times("b.csv"));
    assert!(first.len() > 10);
    for ((model, a), (other, b)) in first.iter().zip(&second) {
        assert_eq!(model, other);
        assert!((a / b - 1.0).abs() < 0.1, "{model}: {a} and {b}");
    }
}

/// A cloth that hangs by its own weight. Row j of n rows hangs on springs that bear what is below:
/// with mass M and n springs of stiffness k beside one another, it is lower by the sum of
/// (n - i) M g / (n n k) for i up to j. A continuous cloth is lower by M g / k (s - s2 / 2).
#[test]
fn the_error_of_a_grid_is_that_of_a_closed_form() {
    let folder = &Folder::new();
    let scene = "duration = 20\ngravity = [0, -9.81, 0]\ndrag_per_mass = 4\n[[cloth]]\ngrid = [9, 9]\nwidth = 1\n\
         density = 1\nstiffness = [200, 0, 0]\nat = [0, 0, 0]\npin = [{ at = [\"top\"] }]\n";
    folder.write("hung.toml", scene);
    let words = "simplify --scene hung.toml --error 1e-3 --at-end --until 20 --chart models.svg";
    let table = said(folder, words);
    let (n, weight, k) = (9, 9.81, 200.0);
    let lower = |n: usize, j: usize| -> f64 {
        let each = |i: usize| (n - i) as f64 * weight / ((n * n) as f64 * k);
        (1..=j).map(each).sum()
    };
    let rms = |exact: &dyn Fn(usize) -> f64| {
        let squares = (0..n).map(|j| (lower(n, j) - exact(j)).powi(2));
        (squares.sum::<f64>() / n as f64).sqrt()
    };
    // Against a grid twice as fine, exactly.
    let finer = rms(&|j| lower(2 * n - 1, 2 * j));
    let found = change(&table, "grid of 17 x 17");
    assert!((found / finer - 1.0).abs() < 0.05, "{found} {finer}");
    let truth = rms(&|j| {
        let s = j as f64 / (n - 1) as f64;
        weight / k * (s - 0.5 * s * s)
    });
    let [said, order] = of_grid(&table);
    assert!((said / truth - 1.0).abs() < 0.15, "{said} {truth}\n{table}");
    let chart = folder.read("models.svg");
    for word in ["Models: hung", "grid of 3 x 3", "grid of 9 x 9", "grid of 17 x 17"] {
        assert!(chart.contains(word), "{word}");
    }
    assert!((0.8..1.2).contains(&order), "{order}");
}

#[test]
fn a_large_grid_is_compared_with_a_coarser_one() {
    let folder = &Folder::new();
    let scene = "gravity = [0, -9.81, 0]\n[[cloth]]\ngrid = [41, 41]\nwidth = 1\ndensity = 1\nstiffness = [200, 0, 0]\n\
         at = [0, 0, 0]\npin = [{ at = [\"top\"] }]\n";
    folder.write("large.toml", scene);
    let words = "choose --scene large.toml --error 1e-6 --until 0.1";
    let found = said(folder, words);
    assert!(found.contains("the grid of 41 x 41 differs from one half as fine by "), "{found}");
}

/// A strip of cloth that hangs between its ends: an elastic catenary. With the weight w of a unit
/// of its unstretched length, the stiffness k, and tensions H and V along x and y,
/// x(s) = H s / k + H / w (asinh(V(0) / H) - asinh(V(s) / H)) and
/// y(s) = (T(s) - T(0)) / w - (V(0) s - w s2 / 2) / k, where V(s) = V(0) - w s and T2 = H2 + V2.
#[test]
fn the_error_of_a_grid_is_that_of_a_catenary() {
    let folder = &Folder::new();
    let scene = "duration = 20\ngravity = [0, -9.81, 0]\ndrag_per_mass = 4\n[[cloth]]\ngrid = [9, 33]\nwidth = 2\n\
         density = 0.5\nstiffness = [60, 0, 0]\nat = [0, 0, 0]\npin = [{ at = [\"left\", \"right\"] }]\n";
    folder.write("strip.toml", scene);
    let words = "simplify --scene strip.toml --error 1e-3 --at-end --until 20";
    let table = said(folder, words);
    let (length, k, w) = (2.0, 60.0, 0.5 * 9.81);
    let up = 0.5 * w * length;
    let x = |s: f64, h: f64| h * s / k + h / w * ((up / h).asinh() - ((up - w * s) / h).asinh());
    // The tension along x with which the strip spans the distance, by bisection.
    let (mut least, mut most) = (1e-6, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (least + most);
        if x(length, middle) < length {
            least = middle;
        } else {
            most = middle;
        }
    }
    let tension = |s: f64| least.hypot(up - w * s);
    let y = |s: f64| (tension(s) - tension(0.0)) / w - (up * s - 0.5 * w * s * s) / k;
    let words = "verner65 1e-8 --scene strip.toml --until 20";
    let found = positions(&simulate(folder, words));
    let exact: Vec<_> = (0..9 * 33)
        .map(|i| {
            let s = (i % 33) as f64 * length / 32.0;
            let [x0, y0, _] = found[i / 33 * 33];
            [x0 + x(s, least), y0 + y(s), 0.0]
        })
        .collect();
    let truth = distance(&found, &exact);
    let [said, order] = of_grid(&table);
    assert!((said / truth - 1.0).abs() < 0.1, "{said} {truth}\n{table}");
    assert!((0.8..1.2).contains(&order), "{order}");
}

#[test]
fn effects_in_a_file_are_not_measured_again() {
    let folder = &Folder::new();
    let scene = "gravity = [0, -9.81, 0]\ndrag = 1e-3\n[[cloth]]\ngrid = [5, 5]\nwidth = 1\ndensity = 0.2\n\
         stiffness = [50, 20, 0]\nat = [0, 0, 0]\npin = [{ at = [\"top-left\", \"top-right\"] }]\n";
    folder.write("small.toml", scene);
    let words = "simplify --scene small.toml --error 1e-2 --until 1 --data effects.csv";
    let first = said(folder, words);
    let file = folder.join("effects.csv");
    let text = fs::read_to_string(&file).unwrap();
    assert_eq!(effects(&file).len(), 8, "{text}");
    said(folder, words);
    assert_eq!(fs::read_to_string(&file).unwrap(), text);
    // A value that somebody changed shows in the table. Without checksums, it is believed.
    let drag = change(&first, "drag");
    let lines = text.lines().map(|line| {
        let (line, _) = line.rsplit_once(',').unwrap();
        let mut values: Vec<_> = line.split(',').collect();
        if values[7] == "drag" {
            values[8] = "0.125";
        }
        values.join(",") + "\n"
    });
    fs::write(&file, lines.collect::<String>()).unwrap();
    let table = said(folder, words);
    assert!(change(&table, "drag") == 0.12 || change(&table, "drag") == 0.13, "{drag} {table}");
    // Another quantity and another scope have their own effects.
    for other in ["--of centre", "--at-end"] {
        let table = said(folder, format!("{words} {other}"));
        assert!(change(&table, "drag") < 0.1, "{other:?}");
    }
    folder.write("effects.csv", "buy,milk\n");
    let said = complaint(&a3(folder, words), 2);
    assert!(said.contains("does not hold the effects of models"), "{said}");
}

#[test]
fn quantities_of_their_own_are_compared() {
    let folder = &Folder::new();
    // A free fall with drag on the mass: the centre falls by g t2 / 2 without drag, and the energy
    // stays.
    let scene = "gravity = [0, -10, 0]\ndrag_per_mass = 0.5\n[[cloth]]\ngrid = [3, 3]\nwidth = 1\ndensity = 0.9\n\
         stiffness = [50, 20, 0]\nat = [0, 0, 0]\n";
    folder.write("fall.toml", scene);
    let of = |quantity: &str| {
        let words = "simplify --scene fall.toml --error 1e-4 --until 1";
        said(folder, format!("{words} --of {quantity} --data {quantity}.csv"));
        let file = folder.join(format!("{quantity}.csv"));
        let effects = effects(&file);
        effects.into_iter().find(|(model, _)| model == "drag").unwrap().1
    };
    // v = g / d (1 - exp(-d t)), and the distance is its integral.
    let (g, d, mass) = (10.0, 0.5_f64, 0.9);
    let [v, fallen] = [g / d * (1.0 - (-d).exp()), g / d * (1.0 - (1.0 - (-d).exp()) / d)];
    let centre = of("centre");
    assert!((centre - (0.5 * g - fallen)).abs() < 1e-4, "{centre}");
    let lost = mass * (g * fallen - 0.5 * v * v);
    let energy = of("energy");
    assert!((energy - lost).abs() < 1e-4, "{energy} {lost}");
    let words = "simplify --error 1e-2 --of energy --particle 3";
    let said = complaint(&a3(folder, words), 2);
    assert!(said.contains("--particle: only positions"), "{said}");
}

#[test]
fn what_cannot_be_simplified_is_refused_in_a_line() {
    let folder = &Folder::new();
    folder.write("there.toml", "");
    for (words, why) in [
        ("simplify", "`--error E` is missing"),
        (
            "simplify --scene simple --error 1e-3",
            "the scene simple is a single equation: there is nothing to leave out",
        ),
        (
            "simplify --error 1e-3 -o there.toml",
            "there.toml: there is such a file already: give the scene another name",
        ),
        (
            "simplify --error 1e-3 --chart models.txt",
            "models.txt: the name of the file must end in .svg, .pdf or .png",
        ),
        ("simplify --error 1e-3 -o lean.json", "lean.json: the name of the file must end in .toml"),
        (
            "simplify --scene chain --error 1e-12",
            "the motion of this scene over 10 s is itself known to ",
        ),
    ] {
        let output = a3(folder, words);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(why), "{said}");
    }
    let said = complaint(&a3(folder, "simplify --error 0"), 2);
    assert!(said.contains("--error 0"), "{said}");
    assert!(!folder.join("lean.json").exists());
}
