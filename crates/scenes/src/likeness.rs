//! What was probably meant by a word that nothing is called.

/// Least likeness of two words that are taken for one another, from 0 to 1.
const ALIKE: f64 = 0.55;
/// Length that no name has (bytes). The time that a comparison takes grows with the length.
const TOO_LONG: usize = 50;
/// Least length of a word that is taken for the beginning of a name (bytes).
const BEGINNING: usize = 3;

/// The name that is most like a word, if one is: two neighbouring letters in the wrong order count
/// as one slip, and small and capital letters are the same.
#[must_use]
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() >= TOO_LONG {
        return None;
    }
    let word = word.to_lowercase();
    let likeness = |name: &str| {
        if word.len() >= BEGINNING && name.starts_with(&word) {
            1.0
        } else {
            strsim::normalized_damerau_levenshtein(&word, &name.to_lowercase())
        }
    };
    let alike = names.into_iter().map(|name| (likeness(name), name));
    let alike = alike.filter(|(likeness, _)| *likeness > ALIKE);
    // Of several that are equally near, the first.
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
