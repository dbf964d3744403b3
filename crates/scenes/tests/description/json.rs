//! Lists of particles and springs in JSON: messages are in plain English.

use a3_scenes::parse_json;

use super::words::plain;
use super::*;

/// Changes of a list of two particles, with the messages.
const JSON: &str = r#"
[1, 1]
    1 => line 2: mass: it must be a list in square brackets, not 1
    ["1", 1] => line 2: mass: it must be a number, not the text "1"
    {} => line 2: mass: it must be a list in square brackets, not a table
    [1 1] => line 2: the values of a list must have `,` between them
    [1, .5] => line 2: a value is expected: a number such as 0.5
    [1, 01] => line 2: a number must be written like 5, 0.5 or 1e-3
    [1, 1e999] => line 2: mass: it must be a number from -1e13 to 1e13, not inf
    [1, 1, 1] => line 2: mass: there are 3, but 2 positions
"mass"
    "mas" => line 2: mas: there is no key `mas`; did you mean `mass`? The valid keys are name,
    mass => line 2: a key must be in double quotes
    "mass": [1, 1], "mass" => line 2: mass: the key is there twice
"mass": [1, 1],
     => the key `mass` is missing
[0, 0, 0]
    [0, 0] => line 3: positions.0: it must be a list of 3 numbers, not of 2
    [0,5, 0, 0] =>
        line 3: positions.0: it must be a list of 3 numbers, not of 4; write decimal points
    0 => line 3: positions: it must be a list of 3 numbers in square brackets, not 0
[0, 1, 10, 1, 0]
    [0, 1, 10, 1] => line 4: springs: it must be a list of 5 numbers, not of 4
    [0.5, 1, 10, 1, 0] => line 4: springs: it must be a whole number of at least 0, not 0.5
    [0, 5, 10, 1, 0] => line 4: springs: spring 0, counted from 0
0]]\n
    0]],\n => line 5: there must be no `,` after the last value
\n}
     => line 4: the text ends too early: `}` is missing
    \n}} => line 5: something follows after the end
"#;

const PAIR: &str = "{\n\"mass\": [1, 1],\n\"positions\": [[0, 0, 0], [1, 0, 0]],\n\"springs\": [[0, 1, 10, 1, 0]]\n}";

#[test]
fn json_is_refused_in_plain_english() {
    let read = |text: &str| parse_json(text).and_then(made);
    let said = |text: &str| plain(read(text).err().unwrap().to_string());
    assert!(read(PAIR).is_ok());
    let deep = format!("{}1{}", "{\"a\":".repeat(100_000), "}".repeat(100_000));
    assert!(read(&PAIR.replace("\"mass\"", &format!("\"states\": {deep}, \"mass\""))).is_ok());
    refused(PAIR, JSON, said);
    assert!(said("").starts_with("line 1: the text ends where a value should be"));
    let table = "line 1: it must be a table with keys among name, note, units, ";
    assert!(["[]", "3"].iter().all(|text| said(text).starts_with(table)));
}
