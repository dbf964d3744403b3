//! Suggestions for misspelt names.

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

#[cfg(test)]
mod tests {
    use super::nearest;

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
}
