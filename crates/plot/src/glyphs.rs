//! The outlines of labels: letters of the font, shaped (kerning, ligatures) and placed.

use std::sync::LazyLock;

use harfrust::{ShapeOptions, ShaperData, UnicodeBuffer};
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, MetadataProvider};
use tiny_skia::{Path, PathBuilder};

use crate::geometry::Point;
use crate::label::{FONT, Label, RAISED, pieces};

/// The font, with its data for shaping, which are read once.
static LETTERS: LazyLock<Option<(FontRef<'static>, ShaperData)>> = LazyLock::new(|| {
    let font = FontRef::new(FONT).ok()?;
    let data = ShaperData::new(&font);
    Some((font, data))
});

/// A placed letter.
struct Letter {
    glyph: skrifa::GlyphId,
    /// The left end on the base line, relative to the start of the text, in units of the sheet.
    at: Point,
    /// The size of a unit of the font, in units of the sheet.
    unit: f64,
}

/// Returns the outlines of a label at a point, in units of the sheet; `None` if nothing is visible.
pub fn outlines(at: Point, label: Label) -> Option<Path> {
    let (font, data) = LETTERS.as_ref()?;
    let (letters, natural) = letters(font, data, label);
    let stretch = match label.fixed_length() {
        Some(length) if natural > 0.0 => length / natural,
        _ => 1.0,
    };
    let before = label.look.anchor.part() * stretch * natural;
    let outlines = font.outline_glyphs();
    let mut path = PathBuilder::new();
    for letter in letters {
        let Some(outline) = outlines.get(letter.glyph) else {
            continue;
        };
        let mut pen = GlyphPen {
            path: &mut path,
            at,
            turned: label.look.turned,
            start: [stretch * letter.at[0] - before, letter.at[1]],
            unit: [stretch * letter.unit, letter.unit],
        };
        let plain = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        // A letter without an outline leaves its place empty.
        let _ = outline.draw(plain, &mut pen);
    }
    path.finish()
}

/// Returns the letters of a label from left to right, and the length of the text.
fn letters(font: &FontRef, data: &ShaperData, label: Label) -> (Vec<Letter>, f64) {
    let shaper = data.shaper(font).build();
    let em = f64::from(shaper.units_per_em());
    let (mut letters, mut x) = (vec![], 0.0);
    for (piece, raised) in pieces(label.text) {
        let (unit, rise) = if raised {
            (RAISED * label.look.size / em, label.look.rise())
        } else {
            (label.look.size / em, 0.0)
        };
        let mut text = UnicodeBuffer::new();
        for letter in piece.chars().filter(|c| !c.is_control()) {
            text.add(letter, 0);
        }
        text.guess_segment_properties();
        let shaped = shaper.shape(text, ShapeOptions::new());
        for (info, place) in shaped.glyph_infos().iter().zip(shaped.glyph_positions()) {
            let [dx, dy] = [place.x_offset, place.y_offset].map(|d| f64::from(d) * unit);
            letters.push(Letter { glyph: info.glyph_id.into(), at: [x + dx, -rise - dy], unit });
            x += f64::from(place.x_advance) * unit;
        }
    }
    (letters, x)
}

/// A pen that draws a letter on the sheet.
struct GlyphPen<'a> {
    path: &'a mut PathBuilder,
    /// The point where the label is written.
    at: Point,
    /// Whether the label is rotated, to be read from below.
    turned: bool,
    /// The start of the letter relative to that point, along the text and across it.
    start: Point,
    /// A unit of the font along the text and across it, in units of the sheet.
    unit: [f64; 2],
}

impl GlyphPen<'_> {
    /// Returns a point of the letter on the sheet.
    fn on_sheet(&self, x: f32, y: f32) -> (f32, f32) {
        let [along, across] = [
            self.start[0] + f64::from(x) * self.unit[0],
            self.start[1] - f64::from(y) * self.unit[1],
        ];
        let [dx, dy] = if self.turned { [across, -along] } else { [along, across] };
        ((self.at[0] + dx) as f32, (self.at[1] + dy) as f32)
    }
}

impl OutlinePen for GlyphPen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.on_sheet(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.on_sheet(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let ((cx, cy), (x, y)) = (self.on_sheet(cx, cy), self.on_sheet(x, y));
        self.path.quad_to(cx, cy, x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let ((ax, ay), (bx, by)) = (self.on_sheet(ax, ay), self.on_sheet(bx, by));
        let (x, y) = self.on_sheet(x, y);
        self.path.cubic_to(ax, ay, bx, by, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
