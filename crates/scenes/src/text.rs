//! Texts as programs of all systems write them: byte order marks, and ends of lines.

use std::ops::Range;

/// Byte order mark of UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// The text without its byte order mark, if it has one.
///
/// # Errors
/// The text is UTF-16.
pub fn unmarked(text: &[u8]) -> Result<&[u8], String> {
    let is_wide = matches!(text, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]);
    // Without a mark, every second byte of what is ASCII is 0.
    let is_half_empty = matches!(text, [a, b, ..] if (*a == 0) != (*b == 0));
    if is_wide || is_half_empty {
        return Err("it is UTF-16 text: save it as UTF-8".into());
    }
    Ok(text.strip_prefix(MARK).unwrap_or(text))
}

/// Lines of a text, which end in LF, CR LF or CR.
pub(crate) struct Lines<'a> {
    text: &'a [u8],
    /// Where the next line begins.
    next: usize,
    /// Number of lines that were read.
    read: usize,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self {
            text,
            next: 0,
            read: 0,
        }
    }

    /// The next line without its comment, which begins with `#`; where `goes_on` says so of its
    /// beginning and it ends in a backslash, with the lines after it that it goes on in. Before it
    /// the number of its first line, counted from 1.
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

    /// The next line, without its end.
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

    /// The next line without its comment, and before it its number, counted from 1.
    fn next(&mut self) -> Option<Self::Item> {
        self.statement(|_| false)
    }
}

/// Words of a statement: what is between spaces, ends of lines and the backslashes before these.
pub(crate) fn words(statement: &[u8]) -> impl Iterator<Item = &[u8]> {
    let is_gap = |b: &u8| b.is_ascii_whitespace() || *b == b'\\';
    statement.split(is_gap).filter(|word| !word.is_empty())
}
