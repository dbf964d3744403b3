//! Standard output and standard error: text for people, in which nothing from a file or a name
//! moves the cursor or changes colours, and data for programs.

use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};

use super::fault;
use crate::failure::Failure;
use crate::visible::is_shown;

/// Largest number of characters of a message.
const MAX_MESSAGE_CHARS: usize = 1200;
/// Largest number of characters of a word in a message.
const MAX_WORD_CHARS: usize = 160;

/// Writes text to standard output.
pub fn say(text: &str) -> Result<(), Failure> {
    print(&printable(text))
}

/// Writes data to standard output: unchanged, unless it is a terminal.
pub fn send(data: &str) -> Result<(), Failure> {
    if io::stdout().is_terminal() { say(data) } else { print(data) }
}

fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    check_write(
        fault::point()
            .and_then(|()| stdout.write_all(text.as_bytes()))
            .and_then(|()| stdout.flush()),
    )
}

/// Converts the result of a write to standard output. It is no failure if the reader closes the
/// pipe early, as `head` does.
pub fn check_write(written: io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::run(format!("standard output could not be written: {}", reason(&e))))
        }
        _ => Ok(()),
    }
}

/// Writes a message of one line to standard error. If that cannot be written, nobody reads it.
pub fn warn(message: &str) {
    let line = one_line(message) + "\n";
    let _ = io::stderr().lock().write_all(line.as_bytes());
}

/// Notes about scenes that wait to be told, and all of this process.
static NOTES: Mutex<(Vec<String>, BTreeSet<String>)> = Mutex::new((vec![], BTreeSet::new()));

/// Notes something about a scene, once in this process: commands build a scene several times. It is
/// told when the work begins, because a request that cannot be met ends with one line.
pub fn note(message: &str) {
    let mut notes = NOTES.lock().unwrap_or_else(PoisonError::into_inner);
    if notes.1.insert(message.to_owned()) {
        notes.0.push(message.to_owned());
    }
}

/// Writes the notes that wait to standard error.
pub fn tell_notes() {
    let notes = std::mem::take(&mut NOTES.lock().unwrap_or_else(PoisonError::into_inner).0);
    for message in notes {
        warn(&format!("note: {message}"));
    }
}

/// Returns a message as one line of limited length, in which every character is visible.
fn one_line(message: &str) -> String {
    let shown = visible(message);
    let words: Vec<_> = shown.split(' ').map(|word| shortened(word, MAX_WORD_CHARS)).collect();
    shortened(&words.join(" "), MAX_MESSAGE_CHARS)
}

/// Returns a text in which all characters except letters, signs and spaces are escaped.
pub fn visible(text: &str) -> String {
    printable(text).replace('\n', "\\n").replace('\t', "\\t")
}

/// Returns a text without its middle if it has more than `most` characters.
fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.into();
    }
    let end = most / 4;
    let begin = text.chars().take(most - end - 3);
    let end = text.chars().skip(count - end);
    begin.chain("...".chars()).chain(end).collect()
}

/// Returns a text in which control characters and all other invisible ones are escaped.
fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\t' => shown.push(c),
            _ if is_shown(c) => shown.push(c),
            _ => shown.extend(c.escape_debug()),
        }
    }
    shown
}

/// Returns why a file could not be read or written, in words.
pub fn reason(error: &io::Error) -> String {
    if error.kind() == io::ErrorKind::NotFound {
        return "there is no such file or folder".into();
    }
    // The name of a temporary file and the number of the error do not help.
    let mut why = error.to_string();
    for end in [" at path", " (os error"] {
        why.truncate(why.find(end).unwrap_or(why.len()));
    }
    why
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_moves_the_cursor_and_letters_stay() {
        for (text, shown) in [
            ("a\u{1b}[2J\u{7}b", "a\\u{1b}[2J\\u{7}b"),
            ("\r\u{7f}\u{9b}31m\0", "\\r\\u{7f}\\u{9b}31m\\0"),
            ("\u{202e}gpj\u{feff}", "\\u{202e}gpj\\u{feff}"),
            ("Tuch \"è\" 'e\u{301}' \\ 布 µ ×", "Tuch \"è\" 'e\u{301}' \\ 布 µ ×"),
            ("a\tb\nc\n", "a\tb\nc\n"),
        ] {
            assert_eq!(printable(text), shown);
        }
        assert_eq!(one_line("a\nb\tc"), "a\\nb\\tc");
    }

    #[test]
    fn a_long_message_keeps_its_beginning_and_its_end() {
        for (value, length) in [("é", MAX_WORD_CHARS + 22), ("é ", MAX_MESSAGE_CHARS)] {
            let line = format!("x.toml:3: {}é is too long", value.repeat(100_000));
            let line = one_line(&line);
            assert_eq!(line.chars().count(), length);
            assert!(line.starts_with("x.toml:3: é"), "{line}");
            assert!(line.ends_with("é is too long"), "{line}");
        }
    }
}
