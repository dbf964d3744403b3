//! Labels: lines of text, their style, and the space that they occupy.

use std::sync::LazyLock;

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

use crate::geometry::{Point, Rect};
use crate::paint::{Paint, Pen};

/// The colour of important text.
pub const INK: &str = "#1b1b1b";
/// The colour of explanations.
pub const GREY: &str = "#5a5a5a";

/// The part of a label that is placed at its point.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Anchor {
    /// Returns the fraction of the label before its point.
    #[must_use]
    pub fn part(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
}

/// The style of a label.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// The size of the font, in units of the sheet.
    pub size: f64,
    /// The colour, as `#` and six hexadecimal digits.
    pub colour: &'static str,
    /// The part that is at its point.
    pub anchor: Anchor,
    /// Whether it is bold.
    pub bold: bool,
    /// Whether the label is rotated, to be read from below.
    pub turned: bool,
}

impl Look {
    /// Returns the width of the line around the letters of a bold label, in units of the sheet.
    pub(crate) fn weight(&self) -> f64 {
        0.035 * self.size
    }

    /// Returns the height of a superscript above the base line, in units of the sheet.
    pub(crate) fn rise(&self) -> f64 {
        0.33 * self.size
    }

    /// Returns the paint of the letters. The font has no bold face; its outlines are drawn instead.
    pub(crate) fn paint(&self) -> Paint {
        let plain = Paint::fill(self.colour);
        if self.bold { plain.outlined(Pen::new(self.colour, self.weight())) } else { plain }
    }
}

/// A line of text, in which `10^{-3}` stands for a superscript.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    pub text: &'a str,
    pub look: Look,
}

impl<'a> Label<'a> {
    pub fn new(text: &'a str, size: f64) -> Self {
        let look = Look { size, colour: INK, anchor: Anchor::Start, bold: false, turned: false };
        Self { text, look }
    }

    pub fn colour(mut self, colour: &'static str) -> Self {
        self.look.colour = colour;
        self
    }

    pub fn anchor(mut self, anchor: Anchor) -> Self {
        self.look.anchor = anchor;
        self
    }

    pub fn bold(mut self) -> Self {
        self.look.bold = true;
        self
    }

    /// Rotates the label, to be read from below.
    pub fn turned(mut self) -> Self {
        self.look.turned = true;
        self
    }

    /// Returns the length to which the text is stretched, in units of the sheet, unless it has
    /// superscripts.
    pub fn fixed_length(self) -> Option<f64> {
        let plain = !self.text.contains("^{");
        plain.then(|| width(self.text, self.look.size))
    }

    /// Returns the rectangle that the label occupies, with its anchor on the base line at a point.
    pub fn room(self, [x, y]: Point) -> Rect {
        let Look { size, anchor, .. } = self.look;
        let length = width(self.text, size);
        let before = length * anchor.part();
        let (up, down) = (ASCENT * size, 0.22 * size);
        if self.look.turned {
            Rect::new(x - up, y + before - length, x + down, y + before)
        } else {
            Rect::new(x - before, y - up, x - before + length, y + down)
        }
    }
}

/// Returns the pieces of a text in order, and whether each is a superscript.
pub fn pieces(text: &str) -> impl Iterator<Item = (&str, bool)> {
    text.split("^{").enumerate().flat_map(|(k, part)| {
        let (raised, flat) =
            if k == 0 { ("", part) } else { part.split_once('}').unwrap_or(("", part)) };
        [(raised, true), (flat, false)]
    })
}

/// The font of charts, as a file. It is a static, because a constant would be copied to each use.
pub static FONT: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// The size of a superscript over that of the text.
pub const RAISED: f64 = 0.7;
/// The height of letters and superscripts above the base line, over the size of the text.
const ASCENT: f64 = 0.84;

/// Returns the length of a text of this size.
pub fn width(text: &str, size: f64) -> f64 {
    static LETTERS: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| FontRef::new(FONT).ok());
    let Some(font) = &*LETTERS else {
        return 0.6 * size * text.chars().count() as f64;
    };
    let (letters, metrics) =
        (font.charmap(), font.glyph_metrics(Size::new(size as f32), LocationRef::default()));
    let advance = |c| letters.map(c).and_then(|glyph| metrics.advance_width(glyph));
    pieces(text)
        .map(|(piece, raised)| {
            let sum: f64 = piece.chars().map(|c| advance(c).map_or(0.6 * size, f64::from)).sum();
            sum * if raised { RAISED } else { 1.0 }
        })
        .sum()
}
