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
        let rows = if self.rows.is_empty() {
            String::new()
        } else {
            table(&self.rows)
        };
        format!("{}{rows}{}", self.head, self.foot)
    }
}

/// Lays out a table with columns as wide as their widest cells. A column whose heading starts with
/// a space is aligned to the right.
pub fn table(rows: &[Vec<String>]) -> String {
    let headings = &rows[0];
    let width = |c: usize| {
        rows.iter()
            .map(|row| row[c].trim().chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<_> = (0..headings.len()).map(width).collect();
    let cell = |(c, cell): (usize, &String)| {
        let (cell, width) = (cell.trim(), widths[c]);
        if headings[c].starts_with(' ') {
            format!("{cell:>width$}")
        } else {
            format!("{cell:<width$}")
        }
    };
    let line = |row: &Vec<String>| {
        row.iter()
            .enumerate()
            .map(cell)
            .collect::<Vec<_>>()
            .join("  ")
    };
    rows.iter()
        .map(|row| line(row).trim_end().to_owned() + "\n")
        .collect()
}
