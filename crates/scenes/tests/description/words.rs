//! Messages about wrong texts are in plain English, from any parser.

use super::*;

/// Words of programmers, which authors of scenes need not know.
const JARGON: &str = "invalid type, invalid value, invalid length, f64, usize, u64, struct, tuple, \
    sequence, map, variant, field, EOF, null-, serde, mantissa, literal, i128, parsing";

/// Changes of the cloth, with the messages.
const TOML: &str = r#"
spacing = 0.5
    spacing = 0,5 => line 5: a number has a decimal point, not a comma, as in 0.5
    spacing = "0.5" => line 5: cloth.spacing: it must be a number, not the text "0.5"
    spacing = [0.5] => line 5: cloth.spacing: it must be a number, not a list
    spacing = { x = 1 } => line 5: cloth.spacing: it must be a number, not a table
    spacing = true => line 5: cloth.spacing: it must be a number, not true
    spacing = 2026-11-23 => line 5: cloth.spacing: it must be a number, not the date 2026-11-23
    spacing =  => line 5: the value must be a number such as 0.5, a text in quotes,
    spacing = half => line 5: the value must be a number such as 0.5, a text in quotes,
    spacing: 0.5 => line 5: a key must be followed by `=` and its value
    spacing = .5 => line 5: a number has digits before and after its decimal point
    spacing = 00.5 => line 5: a number must not begin with 0, unless a point follows
    spacing = 0.5\nspacing = 1 => line 6: the key is there twice
    spacing = 1e400 => line 5: cloth.spacing: it must be a number from -1e13 to 1e13
    Spacing = 0.5 =>
        line 5: cloth.Spacing: there is no key `Spacing`; did you mean `spacing`? The valid keys are grid, width,
    colour = 0.5 => line 5: cloth.colour: there is no key `colour`; the valid keys are grid, width,
grid = [3, 4]
    grid = [3, 4, 5] => line 4: cloth.grid: it must be a list of 2 numbers, not of 3
    grid = [3] => line 4: cloth.grid: it must be a list of 2 numbers, not of 1
    grid = 3 => line 4: cloth.grid: it must be a list of 2 numbers in square brackets, not 3
    grid = [3.5, 4] => line 4: cloth.grid: it must be a whole number of at least 0, not 3.5
    grid = [-3, 4] => line 4: cloth.grid: it must be a whole number of at least 0, not -3
    grid = [99999999999999999999, 4] =>
        line 4: cloth.grid: the number 99999999999999999999 is too large
    grid = [3; 4] => line 4:
stiffness = [10, 5, 2]
    stiffness = [10, 5, 2, 1] => line 7: cloth.stiffness: it must be a list of 3 numbers, not of 4
    stiffness = [\n10,\n5,\n"2"] => line 10: cloth.stiffness: it must be a number, not the text "2"
at = [0, 2, 0]
    at = [0,5, 2, 0] =>
        line 8: cloth.at: it must be a list of 3 numbers, not of 4; write decimal points, as in 0.5
    pin = { at = ["top"] } =>
        line 8: cloth.pin: it must be a list of tables, not a table: put it in square brackets
    pin = ["top"] => line 8: cloth.pin: it must be a table with keys among at, particles,
    pin = [{ at = "top" }] =>
        line 8: cloth.pin.at: it must be a list in square brackets, not the text "top"
    pin = [{ at = [1] }] => line 8: cloth.pin.at: it must be one of "top", "bottom",
    pin = [{ particles = [-1] }] =>
        line 8: cloth.pin.particles: it must be a whole number of at least 0, not -1
[[cloth]]
    [cloth] =>
        line 3: cloth: it must be a list of tables, not a table: write its header as `[[cloth]]`
    [[cloth] => line 3: the header is not closed: `]]` is missing
    [[clth]] => line 3: clth: there is no key `clth`; did you mean `cloth`? The valid keys are name,
gravity = [0, -9.81, 0]
    // a comment => line 1: a key must be followed by `=` and its value; a comment begins with `#`
    name = 3 => line 1: name: it must be a text in quotes, not 3
    name = "x => line 1: the text in quotes is not closed
    self_collision = "yes" => line 1: self_collision: it must be true or false, not the text "yes"
    self_collision = True => line 1: the words true and false are written in small letters
    wind = { seed = None } => line 1: a number is written like 0.5 or 1e-3, without formulas,
    gravity = [0, -9.81*2, 0] => line 1: a number is written like 0.5 or 1e-3, without formulas,
    trail = 1.5 => line 1: trail: it must be a whole number of at least 0, not 1.5
    camera = [0, 0, 1] => line 1: camera: it must be a table with keys among eye, target, not a list
    camera = [[0, 0, 1], [0, 0, 0]] => line 1: camera: it must be a table
    camera = { eye = [0, 0, 1] } => line 1: camera: the key `target` is missing
    wind = { seed = 1.5 } => line 1: wind.seed: it must be a whole number of at least 0, not 1.5
    springs = [[0, 1, 1, 1]] => line 1: springs: it must be a list of 5 numbers, not of 4
    springs = [[0, 1, 1, 1, 0],\n[0, 1, 1, 1]] =>
        line 2: springs.1: it must be a list of 5 numbers, not of 4
    torn = [0, 1] => line 1: torn: it must be a list of 2 numbers in square brackets, not 0
    solid = [{ model = "neo" }] =>
        line 1: solid.model: there is no `neo`; did you mean `neo-hookean`?
    solver = "trapezod" => line 1: solver: there is no `trapezod`; did you mean `trapezoid`?
    gravity = 0\ngravity.y = 1 => line 2: the key has a value already
"#;

/// Asserts that a message has no words of programmers.
pub fn plain(said: String) -> String {
    for word in JARGON.split(", ") {
        assert!(!said.contains(word), "{word} in {said}");
    }
    said
}

#[test]
fn toml_is_refused_in_plain_english() {
    refused(CLOTH, TOML, |text| plain(said(text)));
}

#[test]
fn numbers_are_read_as_toml_writes_them() {
    let grids = ["[0x3, 0b100]", "[+3, 4]"].map(|grid| CLOTH.replace("[3, 4]", grid));
    let spacings = ["1_000", "5e-1", "0xff", "1"];
    let spacings = spacings.map(|it| CLOTH.replace("= 0.5", &format!("= {it}")));
    for text in grids.iter().chain(&spacings) {
        assert!(*text != CLOTH && build(text).is_ok(), "{text}");
    }
}

#[test]
fn slips_capitals_and_beginnings_are_understood() {
    let names = ["simulate", "simple", "scenes", "t"];
    for (word, meant) in [
        ("simulte", Some("simulate")),
        ("simualte", Some("simulate")),
        ("SCENES", Some("scenes")),
        ("sim", Some("simulate")),
        ("T", Some("t")),
        ("s", None),
        ("rug", None),
        ("", None),
    ] {
        assert_eq!(nearest(word, names), meant, "{word}");
    }
    assert_eq!(nearest(&"simulate".repeat(100_000), names), None);
}
