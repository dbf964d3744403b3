//! Characters that a reader sees: others move the cursor, change colours, or turn text round.

/// Returns whether a character is shown as itself. After a letter, accents that combine with it
/// are.
pub fn is_shown(c: char) -> bool {
    matches!(c, ' '..='~') || format!("a{c}").escape_debug().count() == 2
}

/// Returns the name of a scene as a part of a line of a file.
pub fn in_a_line(name: &str) -> String {
    name.replace(|c| !is_shown(c), " ")
}

/// Returns the name of a scene as a part of the name of a file: without path separators and
/// invisible characters.
pub fn part_of_name(scene: &str) -> String {
    scene.replace(|c| !is_shown(c) || "/\\".contains(c), "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_show_all_their_characters() {
        let name = "a/b\\c\u{9b}31m\u{202e}gpj.\u{feff}é e\u{301}";
        assert_eq!(part_of_name(name), "a-b-c-31m-gpj.-é e\u{301}");
        assert_eq!(in_a_line("a\nb\u{202e}"), "a b ");
    }
}
