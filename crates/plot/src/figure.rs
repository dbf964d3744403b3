//! Figures: sheets that remember where their labels are, as SVG and PNG.

use std::fmt::Write;
use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use crate::error::Error;
use crate::geometry::{Point, Rect};
use crate::label::{Anchor, FONT, GREY, Label, RAISED, pieces};

/// Fonts in order of preference. Labels are measured with the first.
const FONTS: &str = "Ubuntu, 'Ubuntu Light', 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif";

/// The colour and width of a line, as attributes of SVG.
pub fn stroke(colour: &str, width: f64) -> String {
    format!("stroke=\"{colour}\" stroke-width=\"{width:.2}\"")
}

/// A drawing on a sheet, whose units are the pixels of an SVG.
#[derive(Debug)]
pub struct Figure {
    size: Point,
    /// The elements of the SVG so far.
    body: String,
    /// The rooms that labels take.
    labels: Vec<Rect>,
    /// The number of clip paths so far.
    clips: usize,
}

impl Figure {
    /// An empty sheet of this width and height.
    pub(crate) fn new(size: Point) -> Self {
        Self {
            size,
            body: String::new(),
            labels: vec![],
            clips: 0,
        }
    }

    /// The whole sheet.
    pub(crate) fn sheet(&self) -> Rect {
        Rect::new(0.0, 0.0, self.size[0], self.size[1])
    }

    /// Draws a line through points; `style` is attributes of SVG.
    pub(crate) fn line(&mut self, points: &[Point], style: &str) {
        self.path(&[points], "", &format!("fill=\"none\" {style}"));
    }

    /// Fills the area inside outlines. An outline inside another is that of a hole.
    pub(crate) fn area(&mut self, outlines: &[impl AsRef<[Point]>], style: &str) {
        self.path(outlines, "Z", &format!("fill-rule=\"evenodd\" {style}"));
    }

    fn path(&mut self, lines: &[impl AsRef<[Point]>], end: &str, style: &str) {
        self.body.push_str("<path d=\"");
        for line in lines {
            for (k, [x, y]) in line.as_ref().iter().enumerate() {
                let _ = write!(self.body, "{}{x:.2} {y:.2}", if k == 0 { 'M' } else { 'L' });
            }
            self.body.push_str(end);
        }
        let _ = writeln!(self.body, "\" {style}/>");
    }

    /// Fills a rectangle.
    pub(crate) fn rect(&mut self, r: Rect, style: &str) {
        self.area(&[r.corners()], style);
    }

    /// Lets `draw` draw, and cuts that off at the edges of `window`.
    pub(crate) fn clipped(&mut self, window: Rect, draw: impl FnOnce(&mut Self)) {
        self.clips += 1;
        let _ = writeln!(
            self.body,
            "<clipPath id=\"c{0}\"><rect x=\"{1:.2}\" y=\"{2:.2}\" width=\"{3:.2}\" height=\"{4:.2}\"/></clipPath>\n<g clip-path=\"url(#c{0})\">",
            self.clips,
            window.x0,
            window.y0,
            window.width(),
            window.height()
        );
        draw(self);
        self.body.push_str("</g>\n");
    }

    /// Draws an arrow with its head at `to`.
    pub(crate) fn arrow(&mut self, from: Point, to: Point, width: f64) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy).max(1e-9);
        let (u, v) = (4.0 * width * dx / length, 4.0 * width * dy / length);
        let neck = [to[0] - u, to[1] - v];
        self.line(&[from, neck], &stroke(GREY, width));
        let head = [
            to,
            [neck[0] - v / 2.0, neck[1] + u / 2.0],
            [neck[0] + v / 2.0, neck[1] - u / 2.0],
        ];
        self.area(&[head], &format!("fill=\"{GREY}\""));
    }

    /// Writes a label at a point, and returns the room that it takes.
    pub(crate) fn text(&mut self, at: Point, label: Label) -> Rect {
        let room = label.room(at);
        if label.text.is_empty() {
            return room;
        }
        let [x, y] = at;
        let Label { size, colour, .. } = label;
        let _ = write!(
            self.body,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\" fill=\"{colour}\""
        );
        // The text keeps to its room with any font. Some programs stretch superscripts wrongly, and
        // texts with superscripts are short.
        if !label.text.contains("^{") {
            let length = if label.turned {
                room.height()
            } else {
                room.width()
            };
            let _ = write!(
                self.body,
                " textLength=\"{length:.2}\" lengthAdjust=\"spacingAndGlyphs\""
            );
        }
        match label.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.body.push_str(" text-anchor=\"middle\""),
            Anchor::End => self.body.push_str(" text-anchor=\"end\""),
        }
        if label.bold {
            // The font has no bold face; its outlines are drawn instead.
            let _ = write!(self.body, " {}", stroke(colour, 0.035 * size));
        }
        if label.turned {
            let _ = write!(self.body, " transform=\"rotate(-90 {x:.2} {y:.2})\"");
        }
        self.body.push('>');
        for (piece, raised) in pieces(label.text).filter(|(piece, _)| !piece.is_empty()) {
            if raised {
                let (rise, small) = (0.33 * size, RAISED * size);
                let _ = write!(
                    self.body,
                    "<tspan dy=\"-{rise:.2}\" font-size=\"{small:.2}\">{}</tspan>",
                    escape(piece)
                );
            } else {
                self.body.push_str(&escape(piece));
            }
        }
        self.body.push_str("</text>\n");
        self.labels.push(room);
        room
    }

    /// Keeps labels out of a room.
    pub(crate) fn reserve(&mut self, room: Rect) {
        self.labels.push(room);
    }

    /// Whether a room is on the sheet and clear of labels.
    pub(crate) fn is_free(&self, room: Rect) -> bool {
        self.sheet().holds(room) && !self.labels.iter().any(|label| label.overlaps(room))
    }

    /// Whether every label is on the sheet and clear of the others.
    pub(crate) fn is_sound(&self) -> bool {
        let free = |(k, label): (usize, &Rect)| {
            let others = &self.labels[..k];
            self.sheet().holds(*label) && !others.iter().any(|other| other.overlaps(*label))
        };
        self.labels.iter().enumerate().all(free)
    }

    /// The figure as an SVG file.
    #[must_use]
    pub fn svg(&self) -> String {
        let [w, h] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"{FONTS}\" font-weight=\"300\" stroke-linejoin=\"round\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// The figure as a PNG file, with `scale` pixels for each unit of the sheet.
    ///
    /// # Errors
    /// [`Error::Pixels`] if the picture would be too large.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, Error> {
        let wrong = |why: &dyn std::fmt::Display| Error::Pixels(why.to_string());
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(FONT)));
        let options = usvg::Options {
            fontdb: Arc::new(fonts),
            ..usvg::Options::default()
        };
        let tree = usvg::Tree::from_str(&self.svg(), &options).map_err(|e| wrong(&e))?;
        let [w, h] = self.size.map(|length| (length * scale).ceil() as u32);
        let mut pixels = tiny_skia::Pixmap::new(w, h)
            .ok_or_else(|| wrong(&format!("no picture can be {w} x {h} pixels")))?;
        pixels.fill(tiny_skia::Color::WHITE);
        let zoom = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, zoom, &mut pixels.as_mut());
        pixels.encode_png().map_err(|e| wrong(&e))
    }
}

/// Text as XML writes it, without control characters, which XML forbids.
fn escape(text: &str) -> String {
    let clean: String = text.chars().filter(|c| !c.is_control()).collect();
    clean
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_sees_texts_that_overlap() {
        let mut figure = Figure::new([100.0, 50.0]);
        figure.text([10.0, 20.0], Label::new("first", 10.0));
        assert!(figure.is_sound());
        figure.text([25.0, 25.0], Label::new("second", 10.0));
        assert!(!figure.is_sound());
        let mut figure = Figure::new([100.0, 50.0]);
        figure.text([80.0, 20.0], Label::new("too long", 10.0));
        assert!(!figure.is_sound());
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn texts_are_measured_as_they_are_drawn() {
        let mut figure = Figure::new([400.0, 100.0]);
        let room = figure.text([20.0, 60.0], Label::new("Wäg & <λ> 10^{−3}", 40.0));
        let picture = image::load_from_memory(&figure.png(1.0).unwrap())
            .unwrap()
            .to_luma8();
        let dark = picture.enumerate_pixels().filter(|(_, _, p)| p.0[0] < 128);
        let ink = dark.fold(Rect::new(400.0, 100.0, 0.0, 0.0), |r, (x, y, _)| {
            let (x, y) = (f64::from(x), f64::from(y));
            Rect::new(
                r.x0.min(x),
                r.y0.min(y),
                r.x1.max(x + 1.0),
                r.y1.max(y + 1.0),
            )
        });
        assert!(room.holds(ink), "{ink:?} in {room:?}");
        assert!(ink.width() > 0.93 * room.width(), "{ink:?} in {room:?}");
    }
}
