//! Bench of fixtures: files of seeds, runs, random numbers, and tables of wrong texts.
#![allow(dead_code, reason = "each test file uses its part")]

use a3_core::{Control, Scene, Simulation, integrators};

/// Reads a file of the seeds of the fuzzer.
pub fn seed(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/../../../fuzz/seeds/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Begins a run of a scene by a method in steps of h (s).
pub fn run(scene: Scene, method: &str, h: f64) -> Simulation {
    Simulation::new(scene, integrators::find(method).unwrap(), Control::Step(h)).unwrap()
}

/// Creates a generator of repeatable numbers from 0 to 1.
pub fn random(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Asserts how a message begins.
pub fn begins(said: impl AsRef<str>, expected: &str) {
    let said = said.as_ref();
    assert!(said.starts_with(expected), "{said}\n{expected}");
}

/// Asserts that a text is refused after each change of a table, without a line break in the
/// message.
///
/// The table has a part of the text in a line, and indented below it each of its replacements, with
/// the beginning of the message after `=>`, or in the next line. `\n` stands for a line break. A
/// message after `...` may begin in any way.
pub fn refused(whole: &str, table: &str, said: impl Fn(&str) -> String) {
    let plain = |text: &str| text.trim().replace("\\n", "\n");
    let (mut part, mut lines) = (String::new(), table.lines());
    while let Some(line) = lines.next() {
        let Some((instead, expected)) = line.split_once("=>") else {
            part = plain(line);
            continue;
        };
        let expected = if expected.is_empty() { lines.next().unwrap() } else { expected }.trim();
        let text = whole.replacen(&part, &plain(instead), 1);
        assert!(text != whole, "{part}");
        let said = said(&text);
        match expected.strip_prefix("... ") {
            Some(expected) => assert!(said.contains(expected), "{said}\n{expected}"),
            None => begins(&said, expected),
        }
        assert!(!said.contains('\n'), "{said}");
    }
}
