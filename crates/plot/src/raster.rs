//! Figures as PNG files.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Mask, Path, PathBuilder, Pixmap, Stroke, StrokeDash,
    Transform,
};

use crate::error::Error;
use crate::geometry::{Point, Rect};
use crate::glyphs;
use crate::label::Label;
use crate::paint::{Paint, Pen, dashes, rgb};
use crate::shape::Shape;

/// Returns a PNG file with a sheet of this size and its shapes, with `scale` pixels per unit of the
/// sheet.
///
/// # Errors
/// [`Error::Pixels`] if the picture would be too large.
pub fn file(size: Point, shapes: &[Shape], scale: f64) -> Result<Vec<u8>, Error> {
    let [w, h] = size.map(|length| (length * scale).ceil() as u32);
    let mut pixels = Pixmap::new(w, h)
        .ok_or_else(|| Error::Pixels(format!("no picture can be {w} x {h} pixels")))?;
    pixels.fill(Color::WHITE);
    let mut canvas =
        Canvas { pixels, zoom: Transform::from_scale(scale as f32, scale as f32), mask: None };
    canvas.draw(shapes);
    encode(&canvas.pixels).map_err(|why| Error::Pixels(why.to_string()))
}

/// Encodes pixels as a PNG file without opacity: the sheet is opaque.
fn encode(pixels: &Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let colours: Vec<u8> =
        (pixels.data().chunks_exact(4)).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut file = vec![];
    let mut encoder = png::Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colours)?;
    writer.finish()?;
    Ok(file)
}

/// A picture in progress.
struct Canvas {
    pixels: Pixmap,
    /// Transform from units of the sheet to pixels.
    zoom: Transform,
    /// Mask of the visible area, if it is limited.
    mask: Option<Mask>,
}

impl Canvas {
    fn draw(&mut self, shapes: &[Shape]) {
        for shape in shapes {
            match shape {
                Shape::Line(points, pen) => {
                    if let Some(path) = path(&[points], false) {
                        self.stroke(&path, pen);
                    }
                }
                Shape::Area(outlines, paint) => {
                    if let Some(path) = path(outlines, true) {
                        self.paint(&path, paint, FillRule::EvenOdd);
                    }
                }
                Shape::Text(at, text, look) => {
                    if let Some(path) = glyphs::outlines(*at, Label { text, look: *look }) {
                        self.paint(&path, &look.paint(), FillRule::Winding);
                    }
                }
                Shape::Clipped(window, shapes) => {
                    let inside = self.window(*window);
                    let outside = std::mem::replace(&mut self.mask, inside);
                    self.draw(shapes);
                    self.mask = outside;
                }
            }
        }
    }

    /// Returns the mask of a window, which may be within another mask.
    fn window(&self, window: Rect) -> Option<Mask> {
        let path = path(&[window.corners()], true)?;
        let mut mask = if let Some(mask) = &self.mask {
            let mut mask = mask.clone();
            mask.intersect_path(&path, FillRule::Winding, true, self.zoom);
            return Some(mask);
        } else {
            Mask::new(self.pixels.width(), self.pixels.height())?
        };
        mask.fill_path(&path, FillRule::Winding, true, self.zoom);
        Some(mask)
    }

    fn paint(&mut self, path: &Path, paint: &Paint, rule: FillRule) {
        if let Some(fill) = paint.fill {
            let colour = colour(fill, paint.opacity);
            let (zoom, mask) = (self.zoom, self.mask.as_ref());
            self.pixels.fill_path(path, &colour, rule, zoom, mask);
        }
        if let Some(pen) = &paint.pen {
            self.stroke(path, pen);
        }
    }

    fn stroke(&mut self, path: &Path, pen: &Pen) {
        let stroke = Stroke {
            width: pen.width as f32,
            line_join: LineJoin::Round,
            line_cap: if pen.round { LineCap::Round } else { LineCap::Butt },
            dash: StrokeDash::new(dashes(&pen.dash), 0.0),
            ..Stroke::default()
        };
        let colour = colour(pen.colour, 1.0);
        let (zoom, mask) = (self.zoom, self.mask.as_ref());
        self.pixels.stroke_path(path, &colour, &stroke, zoom, mask);
    }
}

/// Returns lines through points as a path, if there is anything to draw.
fn path(lines: &[impl AsRef<[Point]>], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for line in lines {
        for (k, [x, y]) in line.as_ref().iter().enumerate() {
            let (x, y) = (*x as f32, *y as f32);
            if k == 0 {
                path.move_to(x, y);
            } else {
                path.line_to(x, y);
            }
        }
        if closed {
            path.close();
        }
    }
    path.finish()
}

/// Returns the paint of a colour.
fn colour(code: &str, opacity: f64) -> tiny_skia::Paint<'static> {
    let [r, g, b] = rgb(code);
    let mut paint = tiny_skia::Paint::default();
    paint.set_color_rgba8(r, g, b, (255.0 * opacity).round() as u8);
    paint
}
