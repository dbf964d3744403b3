//! Messages about the text of a scene, in the words of those who write scenes, and suggestions for
//! misspelt names.

use std::borrow::Cow;

/// Description of a whole number.
pub(crate) const WHOLE: &str = "a whole number of at least 0";

/// Shortens a message, which may quote a whole file, to `most` characters.
pub(crate) fn brief(message: &str, most: usize) -> Cow<'_, str> {
    match message.char_indices().nth(most) {
        Some((end, _)) => format!("{} ...", &message[..end]).into(),
        None => message.into(),
    }
}

/// Quotes a text.
pub(crate) fn quoted(text: &str) -> String {
    format!("the text \"{}\"", brief(text, 60))
}

/// Describes a list of `count` numbers.
pub(crate) fn list_of(count: impl std::fmt::Display) -> String {
    format!("a list of {count} numbers in square brackets")
}

/// Returns the message for a list of the wrong length.
pub(crate) fn wrong_length(wanted: usize, found: usize) -> String {
    // A decimal comma makes two numbers of one.
    let advice = if found > wanted {
        "; write decimal points, as in 0.5, and commas between numbers"
    } else {
        ""
    };
    format!("it must be a list of {wanted} numbers, not of {found}{advice}")
}

/// Returns the message for a whole number that is too large.
pub(crate) fn too_large(number: impl std::fmt::Display) -> String {
    format!("the number {number} is too large")
}

/// Returns the message for a missing key.
pub(crate) fn missing(key: &str) -> String {
    format!("the key `{key}` is missing")
}

/// Returns the message for an unknown key.
pub(crate) fn unknown_key(key: &str, known: &[&str]) -> String {
    unknown("key ", key, "valid keys", known)
}

/// Returns the message for a name that is not among the choices.
pub(crate) fn unknown_choice(name: &str, known: &[&str]) -> String {
    unknown("", name, "choices", known)
}

fn unknown(kind: &str, word: &str, all: &str, known: &[&str]) -> String {
    let what = format!("there is no {kind}`{}`", brief(word, 60));
    let list = known.join(", ");
    match nearest(word, known.iter().copied()) {
        Some(name) => format!("{what}; did you mean `{name}`? The {all} are {list}"),
        None => format!("{what}; the {all} are {list}"),
    }
}

/// Translates a message of the JSON parser.
#[rustfmt::skip]
pub(crate) fn of_json(message: &str) -> &str {
    match message {
        "EOF while parsing a list" => "the text ends within a list: `]` is missing",
        "EOF while parsing an object" => "the text ends too early: `}` is missing",
        "EOF while parsing a string" => "the text ends within quotes: `\"` is missing",
        "EOF while parsing a value" => "the text ends where a value should be",
        "expected `:`" => "a key must be followed by `:` and its value",
        "expected `,` or `]`" =>
            "the values of a list must have `,` between them and `]` at the end",
        "expected `,` or `}`" => "keys must have `,` between them and `}` at the end",
        "expected value" | "expected ident" =>
            "a value is expected: a number such as 0.5, a text in double quotes, a list or braces",
        "invalid number" => "a number must be written like 5, 0.5 or 1e-3",
        "key must be a string" | "expected `\"`" => "a key must be in double quotes",
        "trailing comma" => "there must be no `,` after the last value",
        "trailing characters" => "something follows after the end",
        "invalid escape" => "after `\\` must be one of `\"`, `\\`, `/`, b, f, n, r, t, u",
        _ if message.starts_with("control character") =>
            "a text in quotes must have no line break and no control character in it",
        _ => message,
    }
}

/// Messages of the TOML parser, and what they mean.
#[rustfmt::skip]
const TOML: [(&[&str], &str); 20] = [
    (&["unexpected key or value"], "after a value there must be a new line"),
    (&["string values must be quoted"], "the value must be a number such as 0.5, a text in quotes, \
        true, false, a list such as [1, 2] or a table such as { a = 1 }"),
    (&["key with no value"],
        "a key must be followed by `=` and its value; a comment begins with `#`"),
    (&["duplicate key"], "the key is there twice"),
    (&["extra `=`"], "there must be one `=` alone"),
    (&["unquoted keys cannot be empty", "invalid key-value pair"],
        "a key is expected, such as `grid = [3, 4]`, or a header, such as `[[cloth]]`"),
    (&["invalid mantissa", "invalid fraction", "invalid exponent"],
        "a number has digits before and after its decimal point and its e, as in 0.5 or 1e-3"),
    (&["unexpected leading zero"], "a number must not begin with 0, unless a point follows"),
    (&["redundant numeric sign"], "a number has one sign at most"),
    (&["floating-point number overflowed"], "the number is too large"),
    (&["invalid boolean"], "the words true and false are written in small letters"),
    (&["invalid float"], "a number is written like 0.5 or 1e-3, without formulas, or as inf, in \
        small letters; a key that has no value is left out"),
    (&["missing comma between array elements"],
        "the values of a list must have `,` between them and `]` at the end"),
    (&["unclosed array"], "the list is not closed: `]` is missing"),
    (&["unclosed array table"], "the header is not closed: `]]` is missing"),
    (&["unclosed table"], "the header is not closed: `]` is missing"),
    (&["unclosed inline table"], "the table is not closed: `}` is missing"),
    (&["invalid basic string", "invalid literal string"],
        "the text in quotes is not closed, or has a character that it must not have"),
    (&["invalid multi-line basic string", "invalid multi-line literal string"],
        "the text in three quotes is not closed"),
    (&["missing escaped value"], "after `\\` must be one of `\"`, `\\`, b, e, f, n, r, t, u, U, x; \
        paths are best written with `/`"),
];

/// Translates a message of the TOML parser. `rest` is the text from the place of the error on.
pub(crate) fn of_toml(message: &str, rest: &str) -> Cow<'static, str> {
    let line = message.lines().next().unwrap_or_default();
    let mut words = line.split(", expected");
    let what = words.next().unwrap_or_default();
    let wanted = words.next().unwrap_or_default().trim();
    let known = TOML.iter().find(|(names, _)| names.contains(&what));
    match known {
        _ if what == "unexpected key or value" && rest.starts_with(',') => {
            "a number has a decimal point, not a comma, as in 0.5".into()
        }
        Some((_, meaning)) => (*meaning).into(),
        None if what.starts_with("cannot extend value") => {
            "the key has a value already, and is no table".into()
        }
        None if wanted.is_empty() || wanted == "nothing" => what.to_owned().into(),
        None => format!("{what}: {wanted} is expected").into(),
    }
}

/// Smallest similarity, from 0 to 1, at which a name is suggested for a word.
const MIN_SIMILARITY: f64 = 0.55;
/// Length from which on a word has no suggestion (bytes). The time of a comparison grows with the
/// length.
const TOO_LONG: usize = 50;
/// Shortest word that counts as the beginning of a name (bytes).
const MIN_PREFIX: usize = 3;

/// Finds the name that is most similar to a word, if one is similar enough. Two neighbouring
/// letters in the wrong order count as one error, and small and capital letters as equal.
///
/// ```
/// assert_eq!(a3_scenes::nearest("pendulm", ["chain", "pendulum"]), Some("pendulum"));
/// assert_eq!(a3_scenes::nearest("teapot", ["chain", "pendulum"]), None);
/// ```
#[must_use]
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() >= TOO_LONG {
        return None;
    }
    let word = word.to_lowercase();
    let likeness = |name: &str| {
        if word.len() >= MIN_PREFIX && name.starts_with(&word) {
            1.0
        } else {
            strsim::normalized_damerau_levenshtein(&word, &name.to_lowercase())
        }
    };
    let alike = names.into_iter().map(|name| (likeness(name), name));
    let alike = alike.filter(|(likeness, _)| *likeness > MIN_SIMILARITY);
    // The first of several names that are equally similar.
    let nearest = alike.reduce(|best, next| if next.0 > best.0 { next } else { best });
    nearest.map(|(_, name)| name)
}
