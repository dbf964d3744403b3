//! Layout of all charts: headings and foot, a legend, a grid of panels, and sizes of text that fit.

use crate::axis::Axis;
use crate::error::Error;
use crate::figure::Figure;
use crate::geometry::{Point, Rect};
use crate::label::{Anchor, GREY, Label, width};
use crate::paint::Pen;

/// The least size of text. Notes may have four fifths of it.
const MIN_TEXT_SIZE: f64 = 7.0;

/// Level of detail of a chart.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// The size of its text.
    pub size: f64,
    /// Whether it has its subtitle and foot, and long titles of panels.
    pub full: bool,
}

/// Returns the drawing with the largest text that fits. Explanations are left out only if no size
/// of text fits otherwise.
///
/// # Errors
/// [`Error::Sheet`] or [`Error::TooSmall`] if no drawing fits.
pub fn fit(size: Point, draw: impl Fn(Figure, Level) -> Option<Figure>) -> Result<Figure, Error> {
    let at = |size: Point| {
        let base = ((size[0] * size[1]).sqrt() / 75.0).max(9.0);
        largest(size, base, &draw)
    };
    if !size.iter().all(|length| (1.0..=20_000.0).contains(length)) {
        return Err(Error::Sheet(size));
    }
    at(size).ok_or_else(|| {
        let mut larger =
            (1..40).map(|k| 1.1_f64.powi(k)).map(|by| size.map(|length| (by * length).ceil()));
        Error::TooSmall { sheet: size, enough: larger.find(|size| at(*size).is_some()) }
    })
}

/// Returns the drawing with the largest text that fits, at most of the size `base`.
pub fn largest(
    size: Point,
    base: f64,
    draw: impl Fn(Figure, Level) -> Option<Figure>,
) -> Option<Figure> {
    let levels = [(1.0, true), (0.9, true), (0.8, true), (0.7, true), (0.7, false), (0.6, false)];
    levels.into_iter().find_map(|(part, full)| {
        let level = Level { size: (part * base).max(MIN_TEXT_SIZE), full };
        draw(Figure::new(size), level).filter(Figure::is_sound)
    })
}

/// Shortens a text with an ellipsis if it is longer than `room`.
pub fn elide(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut kept: Vec<_> = text.chars().collect();
    while kept.pop().is_some() {
        let shorter: String = kept.iter().collect::<String>().trim_end().to_owned() + "…";
        if width(&shorter, size) <= room {
            return shorter;
        }
    }
    String::new()
}

/// Breaks a text into lines of at most the length `room`. Lines break at spaces, except no-break
/// spaces, and at line breaks.
pub fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = vec![];
    for paragraph in text.lines() {
        let first = lines.len();
        for word in paragraph.split(' ').filter(|word| !word.is_empty()) {
            match lines[first..].last_mut() {
                Some(line) if width(&format!("{line} {word}"), size) <= room => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(elide(word, size, room)),
            }
        }
    }
    lines
}

/// Writes title, subtitle and foot, unless they are empty, and returns the rest of the sheet.
pub fn headings(figure: &mut Figure, [title, subtitle, foot]: [&str; 3], level: Level) -> Rect {
    let sheet = figure.sheet();
    let margin = level.size;
    let (x1, y1) = (sheet.x1 - margin, sheet.y1 - 0.6 * margin);
    let mut left = Rect::new(margin, 0.8 * margin, x1, y1);
    let parts = [(title, 1.45, true), (if level.full { subtitle } else { "" }, 1.0, false)];
    for (text, factor, bold) in parts {
        let size = factor * level.size;
        for line in wrap(text, size, left.width()) {
            let label = Label::new(&line, size);
            let label = if bold { label.bold() } else { label.colour(GREY) };
            figure.text([left.x0, left.y0 + 0.8 * size], label);
            left.y0 += 1.25 * size;
        }
    }
    let size = 0.85 * level.size;
    let foot = if level.full { foot } else { "" };
    for line in wrap(foot, size, left.width()).iter().rev() {
        let label = Label::new(line, size).colour(GREY);
        figure.text([left.x0, left.y1 - 0.3 * size], label);
        left.y1 -= 1.25 * size;
    }
    left.y1 -= 0.4 * level.size;
    left.y0 += 0.3 * level.size;
    left
}

/// A function that draws the symbol of a legend entry around a point.
pub type Sign<'a> = Box<dyn Fn(&mut Figure, Point) + 'a>;

/// Draws a legend in columns at the top of the area, and reduces `area` to the part below it.
pub fn legend(figure: &mut Figure, area: &mut Rect, entries: &[(String, Sign)], size: f64) {
    let (sign, gap) = (4.0 * size, 1.6 * size);
    let names = entries.iter().map(|(name, _)| width(name, size));
    let longest = names.fold(0.0, f64::max).min(area.width() - sign - gap);
    let column = sign + longest + gap;
    let fitting = ((area.width() + gap) / column).floor().max(1.0) as usize;
    // All rows have about equally many entries.
    let rows = entries.len().div_ceil(fitting).max(1);
    let columns = entries.len().div_ceil(rows).max(1);
    for (k, (name, draw)) in entries.iter().enumerate() {
        let x = area.x0 + (k % columns) as f64 * column;
        let y = area.y0 + (1.4 * (k / columns) as f64 + 0.7) * size;
        draw(figure, [x + 0.45 * sign, y]);
        figure.reserve(Rect::new(x, y - 0.5 * size, x + 0.9 * sign, y + 0.5 * size));
        let name = elide(name, size, longest + 0.01);
        figure.text([x + sign, y + 0.34 * size], Label::new(&name, size));
    }
    area.y0 += (1.4 * rows as f64 + 0.7) * size;
}

/// Returns cells for `n` panels, row by row and `gap` apart, and the number of columns. That number
/// maximises the merit of a panel, a function of its width and height.
pub fn grid(n: usize, area: Rect, gap: f64, merit: impl Fn(Point) -> f64) -> (Vec<Rect>, usize) {
    let cell = |columns: usize| {
        let share = |length: f64, parts: usize| (length + gap) / parts as f64 - gap;
        [share(area.width(), columns), share(area.height(), n.div_ceil(columns))]
    };
    let better = |a: &usize, b: &usize| merit(cell(*a)).total_cmp(&merit(cell(*b)));
    let columns = (1..=n).rev().max_by(better).unwrap_or(1);
    let [w, h] = cell(columns);
    let room = |k: usize| {
        let x0 = area.x0 + (k % columns) as f64 * (w + gap);
        let y0 = area.y0 + (k / columns) as f64 * (h + gap);
        Rect::new(x0, y0, x0 + w, y0 + h)
    };
    ((0..n).map(room).collect(), columns)
}

/// Returns the width of the widest label of an axis.
pub fn widest(axis: &Axis, size: f64) -> f64 {
    let ticks = axis.ticks(1.6 * size);
    let widths = ticks.iter().map(|tick| width(&tick.label, size));
    widths.fold(0.0, f64::max)
}

/// Draws the grid, the frame and the labels of a panel; `numbers` tells whether x and y are
/// labelled.
pub fn axes(figure: &mut Figure, area: Rect, [x, y]: [&Axis; 2], size: f64, numbers: [bool; 2]) {
    figure.panels.push((area, [*x, *y]));
    let grid = |label: &str| {
        let styles = [("#d9d9d9", 0.07), ("#efefef", 0.045)];
        let (colour, width) = styles[usize::from(label.is_empty())];
        Pen::new(colour, width * size)
    };
    let (xs, ys) = (x.ticks(if x.log { 3.4 } else { 2.3 } * size), y.ticks(1.6 * size));
    // Labelled ticks are drawn over minor ones.
    for named in [false, true] {
        for tick in xs.iter().filter(|tick| tick.label.is_empty() != named) {
            let at = x.at(tick.value);
            figure.line(&[[at, area.y0], [at, area.y1]], grid(&tick.label));
        }
        for tick in ys.iter().filter(|tick| tick.label.is_empty() != named) {
            let at = y.at(tick.value);
            figure.line(&[[area.x0, at], [area.x1, at]], grid(&tick.label));
        }
    }
    figure.rect(area, Pen::new("#8a8a8a", 0.07 * size).into());
    let mut number = |at: Point, label: Label| {
        if figure.is_free(label.room(at)) {
            figure.text(at, label);
        }
    };
    for tick in xs.iter().filter(|_| numbers[0]) {
        let label = Label::new(&tick.label, size).anchor(Anchor::Middle);
        number([x.at(tick.value), area.y1 + 1.15 * size], label);
    }
    for tick in ys.iter().filter(|_| numbers[1]) {
        let label = Label::new(&tick.label, size).anchor(Anchor::End);
        let at = [area.x0 - 0.4 * size, y.at(tick.value) + 0.34 * size];
        number(at, label);
    }
}

/// Writes the label below all panels, with an arrow to the left and the text `better` at it, unless
/// that is empty.
pub fn label_below(figure: &mut Figure, room: Rect, label: &str, better: &str, size: f64) {
    let y = room.y1 - 0.3 * size;
    let mut x0 = room.x0;
    if !better.is_empty() {
        let line = y - 0.28 * size;
        figure.arrow([x0 + 2.0 * size, line], [x0, line], 0.1 * size);
        let better = Label::new(better, size).colour(GREY);
        x0 = figure.text([x0 + 2.4 * size, y], better).x1 + 1.5 * size;
    }
    let label = elide(label, size, room.x1 - x0);
    let half = width(&label, size) / 2.0;
    let x = room.centre()[0].clamp(x0 + half, (room.x1 - half).max(x0 + half));
    figure.text([x, y], Label::new(&label, size).anchor(Anchor::Middle));
}

/// Writes the label left of all panels, with an arrow downwards and the text `better` at it, unless
/// that is empty.
pub fn label_left(figure: &mut Figure, room: Rect, label: &str, better: &str, size: f64) {
    let x = room.x0 + 0.8 * size;
    let arrow = 3.9 * size + width(better, size);
    // If space is short, an explanation after a comma is left out first, and then the arrow.
    let short = label.split(", ").next().unwrap_or(label);
    let fits = |label: &str, left: f64| width(label, size) <= room.height() - left;
    let label = if fits(label, arrow) { label } else { short };
    let mut y1 = room.y1;
    if !better.is_empty() && (fits(label, arrow) || !fits(label, 0.0)) {
        let line = x - 0.28 * size;
        figure.arrow([line, y1 - 2.0 * size], [line, y1], 0.1 * size);
        let better = Label::new(better, size).colour(GREY).turned();
        y1 = figure.text([x, y1 - 2.4 * size], better).y0 - 1.5 * size;
    }
    let longest = y1 - room.y0;
    let label = elide(label, size, longest);
    let half = width(&label, size) / 2.0;
    let y = room.centre()[1].clamp(room.y0 + half, (y1 - half).max(room.y0 + half));
    let label = Label::new(&label, size).anchor(Anchor::Middle);
    figure.text([x, y], label.turned());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_wrapped_or_cut() {
        assert_eq!(wrap("one two three", 10.0, 40.0), ["one two", "three"]);
        assert!(elide("a very long name", 10.0, 40.0).ends_with('…'));
        assert_eq!(elide("short", 10.0, 40.0), "short");
    }

    #[test]
    fn panels_fill_the_sheet() {
        let wide = Rect::new(0.0, 0.0, 1200.0, 600.0);
        let columns = |n| {
            let (rooms, columns) = grid(n, wide, 10.0, |[w, h]| (w / 1.2).min(h));
            assert_eq!(rooms.len(), n);
            assert!(rooms.iter().all(|room| wide.holds(*room)));
            columns
        };
        assert_eq!([1, 2, 6, 8].map(columns), [1, 2, 3, 4]);
    }
}
