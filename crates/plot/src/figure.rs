//! A sheet to draw on that remembers where its texts are: SVG, and PNG from it.

use std::fmt::Write;
use std::sync::Arc;

use epaint_default_fonts::UBUNTU_LIGHT;
use resvg::{tiny_skia, usvg};

use super::rect::{Point, Rect};
use super::text::{Anchor, GREY, RAISED, Text, pieces};
use crate::Failure;

/// The first is the font that texts are measured with.
const FONTS: &str = "Ubuntu, 'Ubuntu Light', 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif";

/// A line's colour and width, as attributes of SVG.
pub fn stroke(colour: &str, width: f64) -> String {
    format!("stroke=\"{colour}\" stroke-width=\"{width:.2}\"")
}

/// What is drawn, in order.
#[derive(Debug)]
pub struct Figure {
    size: Point,
    body: String,
    texts: Vec<Rect>,
    clips: usize,
}

impl Figure {
    pub fn new(size: Point) -> Self {
        Self {
            size,
            body: String::new(),
            texts: vec![],
            clips: 0,
        }
    }

    pub fn sheet(&self) -> Rect {
        Rect::new(0.0, 0.0, self.size[0], self.size[1])
    }

    /// A line through points; `style` is attributes of SVG.
    pub fn line(&mut self, points: &[Point], style: &str) {
        self.path(&[points], "", &format!("fill=\"none\" {style}"));
    }

    /// The area inside outlines: holes are outlines inside outlines.
    pub fn area(&mut self, outlines: &[impl AsRef<[Point]>], style: &str) {
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

    pub fn rect(&mut self, r: Rect, style: &str) {
        self.area(&[r.corners()], style);
    }

    /// What `draw` draws is cut off at the edges of `window`.
    pub fn clipped(&mut self, window: Rect, draw: impl FnOnce(&mut Self)) {
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

    /// An arrow with its head at `to`.
    pub fn arrow(&mut self, from: Point, to: Point, width: f64) {
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

    pub fn text(&mut self, at: Point, text: Text) -> Rect {
        let room = text.room(at);
        if text.words.is_empty() {
            return room;
        }
        let [x, y] = at;
        let Text { size, colour, .. } = text;
        let _ = write!(
            self.body,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\" fill=\"{colour}\""
        );
        // Whatever font is there, the text keeps to its room. Superscripts are short, and stretched wrongly by some.
        if !text.words.contains("^{") {
            let length = if text.turned {
                room.height()
            } else {
                room.width()
            };
            let _ = write!(
                self.body,
                " textLength=\"{length:.2}\" lengthAdjust=\"spacingAndGlyphs\""
            );
        }
        match text.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.body.push_str(" text-anchor=\"middle\""),
            Anchor::End => self.body.push_str(" text-anchor=\"end\""),
        }
        if text.bold {
            // The font has no bold: its outline, drawn.
            let _ = write!(self.body, " {}", stroke(colour, 0.035 * size));
        }
        if text.turned {
            let _ = write!(self.body, " transform=\"rotate(-90 {x:.2} {y:.2})\"");
        }
        self.body.push('>');
        for (piece, raised) in pieces(text.words).filter(|(piece, _)| !piece.is_empty()) {
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
        self.texts.push(room);
        room
    }

    /// Keeps texts out of this room.
    pub fn reserve(&mut self, room: Rect) {
        self.texts.push(room);
    }

    /// Whether no text is in this room yet, and the sheet has it.
    pub fn free(&self, room: Rect) -> bool {
        self.sheet().holds(room) && !self.texts.iter().any(|text| text.overlaps(room))
    }

    /// Whether every text is on the sheet and clear of the others.
    pub fn is_sound(&self) -> bool {
        let free = |(k, text): (usize, &Rect)| {
            self.sheet().holds(*text) && !self.texts[..k].iter().any(|other| other.overlaps(*text))
        };
        self.texts.iter().enumerate().all(free)
    }

    /// The whole picture.
    pub fn svg(&self) -> String {
        let [w, h] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"{FONTS}\" font-weight=\"300\" stroke-linejoin=\"round\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// Text as XML has it. Control characters have no place there.
fn escape(text: &str) -> String {
    let clean: String = text.chars().filter(|c| !c.is_control()).collect();
    clean
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// A picture as PNG, with `scale` pixels for each of its units.
///
/// # Errors
/// It is no SVG, or too large for the memory.
pub fn png(svg: &str, scale: f64) -> Result<Vec<u8>, Failure> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_source(usvg::fontdb::Source::Binary(Arc::new(UBUNTU_LIGHT)));
    let options = usvg::Options {
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(svg, &options).map_err(Failure::run)?;
    let pixels = |length: f32| (f64::from(length) * scale).ceil() as u32;
    let size = (pixels(tree.size().width()), pixels(tree.size().height()));
    let mut map = tiny_skia::Pixmap::new(size.0, size.1)
        .ok_or_else(|| Failure::run(format!("no picture can be {} x {} pixels", size.0, size.1)))?;
    map.fill(tiny_skia::Color::WHITE);
    let zoom = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, zoom, &mut map.as_mut());
    crate::output::png(map.data(), size)
}
