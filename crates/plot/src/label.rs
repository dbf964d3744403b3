//! Labels: lines of text, how they look, and the room they take.

use std::sync::LazyLock;

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};

use crate::geometry::{Point, Rect};

/// The colour of text that is to be read first.
pub const INK: &str = "#1b1b1b";
/// The colour of text that explains.
pub const GREY: &str = "#5a5a5a";

/// The part of a label that lies at the point where it is drawn.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text, in which `10^{-3}` has a superscript.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    pub text: &'a str,
    pub size: f64,
    pub colour: &'a str,
    pub anchor: Anchor,
    pub bold: bool,
    /// Whether it is read from below.
    pub turned: bool,
}

impl<'a> Label<'a> {
    pub fn new(text: &'a str, size: f64) -> Self {
        Self {
            text,
            size,
            colour: INK,
            anchor: Anchor::Start,
            bold: false,
            turned: false,
        }
    }

    pub fn colour(self, colour: &'a str) -> Self {
        Self { colour, ..self }
    }

    pub fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// The label, read from below.
    pub fn turned(self) -> Self {
        Self {
            turned: true,
            ..self
        }
    }

    /// The room that the label takes with its anchor, on the base line, at a point.
    pub fn room(self, [x, y]: Point) -> Rect {
        let length = width(self.text, self.size);
        let before = length
            * match self.anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => 0.5,
                Anchor::End => 1.0,
            };
        let (up, down) = (UP * self.size, 0.22 * self.size);
        if self.turned {
            Rect::new(x - up, y + before - length, x + down, y + before)
        } else {
            Rect::new(x - before, y - up, x - before + length, y + down)
        }
    }
}

/// The pieces of a text in order, each with whether it is a superscript.
pub fn pieces(text: &str) -> impl Iterator<Item = (&str, bool)> {
    text.split("^{").enumerate().flat_map(|(k, part)| {
        let (raised, flat) = if k == 0 {
            ("", part)
        } else {
            part.split_once('}').unwrap_or(("", part))
        };
        [(raised, true), (flat, false)]
    })
}

/// The font of charts, as a file. A constant would be copied to each place that names it.
pub static FONT: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// The size of a superscript over that of the text.
pub const RAISED: f64 = 0.7;
/// The height of letters and superscripts above the base line, over the size of the text.
const UP: f64 = 0.84;

/// The length of a text of this size.
pub fn width(text: &str, size: f64) -> f64 {
    static LETTERS: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| FontRef::new(FONT).ok());
    let Some(font) = &*LETTERS else {
        return 0.6 * size * text.chars().count() as f64;
    };
    let (letters, metrics) = (
        font.charmap(),
        font.glyph_metrics(Size::new(size as f32), LocationRef::default()),
    );
    let advance = |c| {
        letters
            .map(c)
            .and_then(|glyph| metrics.advance_width(glyph))
    };
    pieces(text)
        .map(|(piece, raised)| {
            let sum: f64 = piece
                .chars()
                .map(|c| advance(c).map_or(0.6 * size, f64::from))
                .sum();
            sum * if raised { RAISED } else { 1.0 }
        })
        .sum()
}
