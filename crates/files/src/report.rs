//! Tables with the words above and below them, for the terminal and for the window.

/// A table with the lines above and below it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Lines above the table.
    pub head: String,
    /// Rows of cells, the headings first. Columns whose headings start with a space are aligned to
    /// the right.
    pub rows: Vec<Vec<String>>,
    /// Lines below the table.
    pub foot: String,
}

impl Report {
    /// Returns the report as text for the terminal.
    pub fn text(&self) -> String {
        let rows = if self.rows.is_empty() { String::new() } else { table(&self.rows) };
        format!("{}{rows}{}", self.head, self.foot)
    }
}

/// Returns the first row of a table: its headings, which are separated by bars.
pub fn headings(words: &str) -> Vec<Vec<String>> {
    vec![words.split('|').map(String::from).collect()]
}

/// Number of characters of a line of text, and of a table whose last column can be wrapped.
pub(crate) const WIDTH: usize = 80;
/// Least number of characters to which a last column is wrapped.
const MIN_WIDTH: usize = 10;

/// Lays out a table with columns as wide as their widest cells. A column whose heading starts with
/// a space is aligned to the right. Long cells of a last column are wrapped.
pub fn table(rows: &[Vec<String>]) -> String {
    let headings = &rows[0];
    let width = |c: usize| rows.iter().map(|row| row[c].trim().chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..headings.len()).map(width).collect();
    let cell = |(c, cell): (usize, &String)| {
        let (cell, width) = (cell.trim(), widths[c]);
        if headings[c].starts_with(' ') {
            format!("{cell:>width$}")
        } else {
            format!("{cell:<width$}")
        }
    };
    let last = headings.len() - 1;
    let begin = widths[..last].iter().map(|width| width + 2).sum();
    let room = WIDTH.saturating_sub(begin);
    let wraps = room >= MIN_WIDTH && !headings[last].starts_with(' ');
    let line = |row: &Vec<String>| {
        let mut cells: Vec<_> = row.iter().enumerate().map(cell).collect();
        if wraps {
            cells[last] = wrapped(&cells[last], room).join(&format!("\n{:begin$}", ""));
        }
        cells.join("  ").trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

/// Breaks a text into lines of `width` characters, if its words are no longer.
pub(crate) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let (mut lines, mut line) = (vec![], String::new());
    for word in text.split_whitespace() {
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    lines.push(line);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_fits_a_terminal() {
        let rows = |rows: &[[&str; 3]]| {
            rows.iter().map(|row| row.map(String::from).to_vec()).collect::<Vec<_>>()
        };
        let long = "word ".repeat(30);
        let all = [["name", " number", "words"], ["a", "1", &long], ["b", "22", "short"]];
        let text = table(&rows(&all));
        let lines: Vec<_> = text.lines().collect();
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert_eq!(lines[0], "name  number  words");
        assert!(lines[1].starts_with("a          1  word word"), "{text}");
        assert!(lines[2].starts_with("              word word"), "{text}");
        assert_eq!(text.matches("word").count(), 31);
        assert_eq!(lines.last(), Some(&"b         22  short"));
        // A column that begins too far to the right stays whole.
        let wide = ["x".repeat(75), "1".into(), long.clone()];
        assert_eq!(table(&[all[0].map(String::from).to_vec(), wide.to_vec()]).lines().count(), 2);
    }
}
