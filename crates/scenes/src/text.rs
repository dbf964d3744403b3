//! Texts from all systems: byte order marks, and ends of lines.

use std::borrow::Cow;
use std::ops::Range;
use std::str::FromStr;

/// Byte order mark of UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Beginnings of files that are no texts, and advice for each.
#[rustfmt::skip]
const OTHERS: [(&[u8], &str); 5] = [
    (b"\x1f\x8b", "it is compressed by gzip: unpack it"),
    (b"PK\x03\x04", "it is a zip archive: unpack it"),
    (b"version https://git-lfs",
        "it is a pointer of Git LFS and not the file itself: fetch it by `git lfs pull`"),
    (b"<!DOCTYPE", "it is a web page: download the file itself"),
    (b"<html", "it is a web page: download the file itself"),
];

/// Returns the text without its byte order mark, if it has one.
///
/// # Errors
/// The text is UTF-16 or UTF-32, or it is no text, such as an archive.
pub fn unmarked(text: &[u8]) -> Result<&[u8], String> {
    if let Some((_, why)) = OTHERS.iter().find(|(begins, _)| text.starts_with(begins)) {
        return Err((*why).into());
    }
    // In ASCII text without a mark, the other bytes of each character are 0.
    let is_ascii = |b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    let begin = text.get(..8).unwrap_or_default();
    let is_wide_by = |size: usize| {
        let is_letter = |unit: &[u8]| match unit {
            [letter, zeros @ ..] if is_ascii(letter) => zeros.iter().all(|b| *b == 0),
            [zeros @ .., letter] => is_ascii(letter) && zeros.iter().all(|b| *b == 0),
            [] => false,
        };
        !begin.is_empty() && begin.chunks_exact(size).all(is_letter)
    };
    let is_marked_32 = matches!(text, [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..]);
    refuse!(if is_marked_32 || is_wide_by(4) => "it is UTF-32 text: save it as UTF-8");
    refuse!(if matches!(text, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]) || is_wide_by(2) =>
        "it is UTF-16 text: save it as UTF-8");
    Ok(text.strip_prefix(MARK).unwrap_or(text))
}

/// Returns the line of a byte, counted from 1.
pub(crate) fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|b| *b == b'\n').count()
}

/// Iterator over the lines of a text, which end in LF, CR LF or CR.
pub(crate) struct Lines<'a> {
    text: &'a [u8],
    /// Byte at which the next line begins.
    next: usize,
    /// Number of lines that were read.
    read: usize,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, next: 0, read: 0 }
    }

    /// Returns the next statement without its comment, which begins with `#`, and the number of its
    /// first line, counted from 1. A line that ends in a backslash continues in the next one, if
    /// `goes_on` is true for it.
    pub fn statement(&mut self, goes_on: impl Fn(&[u8]) -> bool) -> Option<(usize, &'a [u8])> {
        let Range { start, mut end } = self.line()?;
        let number = self.read;
        loop {
            let line = &self.text[start..end];
            if let Some(comment) = line.iter().position(|b| *b == b'#') {
                return Some((number, &line[..comment]));
            }
            if !line.trim_ascii_end().ends_with(b"\\") || !goes_on(line) {
                return Some((number, line));
            }
            let Some(more) = self.line() else {
                return Some((number, line));
            };
            end = more.end;
        }
    }

    /// Returns the next line, without its end.
    fn line(&mut self) -> Option<Range<usize>> {
        let start = self.next;
        let rest = self.text.get(start..).filter(|rest| !rest.is_empty())?;
        let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        let end = &rest[length..];
        let ended = if end.starts_with(b"\r\n") { 2 } else { 1 };
        self.next = start + length + ended.min(end.len());
        self.read += 1;
        Some(start..start + length)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    /// Returns the number of the next line, counted from 1, and the line without its comment.
    fn next(&mut self) -> Option<Self::Item> {
        self.statement(|_| false)
    }
}

/// Shortens a word for a message.
pub(crate) fn brief(word: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(&word[..word.len().min(40)])
}

/// Reads a word as a number.
pub(crate) fn number<T: FromStr>(word: &[u8]) -> Option<T> {
    str::from_utf8(word).ok()?.parse().ok()
}

/// Splits a statement into words, at spaces, ends of lines and backslashes.
pub(crate) fn words(statement: &[u8]) -> impl Iterator<Item = &[u8]> {
    let is_gap = |b: &u8| b.is_ascii_whitespace() || *b == b'\\';
    statement.split(is_gap).filter(|word| !word.is_empty())
}
