//! Pages of lessons as text for a terminal: paragraphs of 80 columns, headings with a line below
//! them, tables in columns, and no marks. The steps for the window are left out.

use crate::report::{WIDTH, table, wrapped};

/// Part of a page.
#[derive(Debug, PartialEq)]
pub(super) enum Piece {
    Text(String),
    /// Answer to a question, which is shown later.
    Answer(String),
}

/// Returns a page as text, in pieces.
pub(super) fn pieces(page: &str) -> Vec<Piece> {
    let mut writer = Writer::default();
    let mut is_code = false;
    for line in page.lines() {
        if line.starts_with("### ") {
            break;
        }
        let is_fence = line.starts_with("```");
        match line {
            _ if is_fence => {
                writer.end();
                is_code = !is_code;
            }
            // Whether a command fails is often the answer to a question.
            _ if is_code => {
                let command = line.split("    # exit code").next().unwrap_or(line);
                writer.add_line(&format!("    {command}"));
            }
            "" => {
                writer.end();
                writer.gap();
            }
            _ if line.starts_with("<details>") => writer.cut(Piece::Text),
            "</details>" => writer.cut(Piece::Answer),
            _ if line.starts_with('#') => writer.add_heading(line.trim_start_matches(['#', ' '])),
            _ if line.starts_with("|--") => {}
            _ if line.starts_with('|') => writer.rows.push(cells(line)),
            _ if line.starts_with("    ") => writer.add_line(line),
            _ if line.starts_with("- ") => {
                writer.end();
                writer.add_words(line);
            }
            _ => writer.add_words(line),
        }
    }
    writer.cut(Piece::Text);
    writer.pieces
}

/// The text laid out so far, and the paragraph, list item or table that is being read.
#[derive(Default)]
struct Writer {
    pieces: Vec<Piece>,
    text: String,
    /// Words of a paragraph.
    words: String,
    /// Rows of a table.
    rows: Vec<Vec<String>>,
}

impl Writer {
    fn add_line(&mut self, line: &str) {
        self.text += line.trim_end();
        self.text += "\n";
    }

    /// Adds an empty line, unless there is one.
    fn gap(&mut self) {
        if !self.text.is_empty() && !self.text.ends_with("\n\n") {
            self.text += "\n";
        }
    }

    fn add_words(&mut self, line: &str) {
        self.words += line;
        self.words += " ";
    }

    fn add_heading(&mut self, words: &str) {
        let words = unmarked(words);
        let below = "-".repeat(words.chars().count());
        self.add_line(&words);
        self.add_line(&below);
    }

    /// Lays out the paragraph or the table that ends here.
    fn end(&mut self) {
        let words = unmarked(&std::mem::take(&mut self.words));
        let indent = if words.starts_with("- ") { "  " } else { "" };
        if !words.is_empty() {
            let lines = wrapped(&words, WIDTH - indent.len());
            self.add_line(&lines.join(&format!("\n{indent}")));
        }
        let rows = std::mem::take(&mut self.rows);
        if !rows.is_empty() {
            self.text += &table(&rows);
        }
    }

    /// Ends a piece.
    fn cut(&mut self, piece: fn(String) -> Piece) {
        self.end();
        let text = std::mem::take(&mut self.text);
        let text = text.trim_matches('\n');
        if !text.is_empty() {
            self.pieces.push(piece(format!("{text}\n")));
        }
    }
}

/// Returns the cells of a row of a table.
fn cells(row: &str) -> Vec<String> {
    let cells = row.trim_matches('|').split('|');
    cells.map(unmarked).collect()
}

/// Returns a text without the marks of code, emphasis, links and pictures. Of a link it keeps the
/// words, of a picture what it shows.
fn unmarked(text: &str) -> String {
    let parts = text.split('`').enumerate().map(|(k, part)| match k % 2 {
        1 => part.to_owned(),
        _ => without_links(part).replace('*', ""),
    });
    parts.collect::<String>().trim().into()
}

/// Returns a text with the words of links in their place.
fn without_links(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("](") {
        let (lead, words) = before.rsplit_once('[').unwrap_or((before, ""));
        match lead.strip_suffix('!') {
            Some(lead) => plain.extend([lead, "Picture: ", words]),
            None => plain.extend([lead, words]),
        }
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_becomes_text() {
        let page = "# 1. Title\n\nSome **bold** words and `a * b`, a [link](x.md) and\nmore.\n\n\
            ```sh\na3 *t*\n```\n\n![A curve](p.png)\n\n| a | b |\n|---|---|\n| 1 | *two* |\n\n\
            **Question.** Why?\n\n<details><summary>Answer</summary>\n\n- So.\n\n</details>\n\n\
            ## In the window\n\nKey F1.\n\n### A step\n\nLeft out.\n";
        let text = "1. Title\n--------\n\nSome bold words and a * b, a link and more.\n\n    a3 *t*\n\n\
            Picture: A curve\n\na  b\n1  two\n\nQuestion. Why?\n";
        let window = "In the window\n-------------\n\nKey F1.\n";
        let expected =
            [Piece::Text(text.into()), Piece::Answer("- So.\n".into()), Piece::Text(window.into())];
        assert_eq!(pieces(page), expected);
    }

    /// No page has a mark that is not understood.
    #[test]
    fn no_page_keeps_its_marks() {
        for page in super::super::PAGES {
            for Piece::Text(text) | Piece::Answer(text) in pieces(page) {
                for line in text.lines().filter(|line| !line.starts_with("    ")) {
                    let is_marked =
                        ["`", "**", "](", "</", "|", "#"].iter().any(|mark| line.contains(mark));
                    assert!(!is_marked && line.chars().count() <= WIDTH, "{line}");
                }
            }
        }
    }
}
