//! Figures as PDF, on a page of their own size.

use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect as Page, Ref};
use tiny_skia::{Path, PathSegment};

use crate::geometry::Point;
use crate::glyphs;
use crate::label::Label;
use crate::paint::{Paint, Pen, dashes, rgb};
use crate::shape::Shape;

/// Points (1/72 inch) in a unit of the sheet (1/96 inch).
const POINT: f32 = 0.75;
/// Level of compression, as in zlib.
const LEVEL: u8 = 6;

/// Returns a file with a sheet of this size and its shapes. Texts are outlines, so that they look
/// the same without the font.
pub fn file([w, h]: Point, shapes: &[Shape]) -> Vec<u8> {
    let [w, h] = [w, h].map(|length| length as f32 * POINT);
    let mut canvas = PdfCanvas { content: Content::new(), opacities: vec![] };
    // The y axis of a page points up.
    let turn = [POINT, 0.0, 0.0, -POINT, 0.0, h];
    canvas.content.save_state().transform(turn);
    canvas.content.set_line_join(LineJoinStyle::RoundJoin);
    canvas.draw(shapes);
    canvas.content.restore_state();
    let content = compress_to_vec_zlib(&canvas.content.finish(), LEVEL);
    let [catalog, pages, page, stream] = [1, 2, 3, 4].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut sheet = pdf.page(page);
    sheet.parent(pages).contents(stream);
    sheet.media_box(Page::new(0.0, 0.0, w, h));
    let mut resources = sheet.resources();
    let mut states = resources.ext_g_states();
    for (k, opacity) in canvas.opacities.iter().enumerate() {
        let mut state = states.insert(Name(&name(k))).start::<State>();
        state.non_stroking_alpha(*opacity);
    }
    states.finish();
    resources.finish();
    sheet.finish();
    pdf.stream(stream, &content).filter(Filter::FlateDecode);
    pdf.finish()
}

type State<'a> = pdf_writer::writers::ExtGraphicsState<'a>;

/// Rounds a length to digits that are visible.
fn rounded(length: f32) -> f32 {
    (100.0 * length).round() / 100.0
}

/// Returns the name of a graphics state by its index in a list.
fn name(place: usize) -> Vec<u8> {
    format!("G{place}").into_bytes()
}

/// A page in progress.
struct PdfCanvas {
    content: Content,
    /// The opacities of areas so far.
    opacities: Vec<f32>,
}

impl PdfCanvas {
    fn draw(&mut self, shapes: &[Shape]) {
        for shape in shapes {
            match shape {
                Shape::Line(points, pen) => {
                    self.lines(&[points], false);
                    self.stroke(pen);
                }
                Shape::Area(outlines, paint) => {
                    let trace = |canvas: &mut Self| canvas.lines(outlines, true);
                    self.paint(paint, trace, |content| content.fill_even_odd());
                }
                Shape::Text(at, text, look) => {
                    if let Some(path) = glyphs::outlines(*at, Label { text, look: *look }) {
                        let trace = |canvas: &mut Self| canvas.path(&path);
                        self.paint(&look.paint(), trace, |content| content.fill_nonzero());
                    }
                }
                Shape::Clipped(window, shapes) => {
                    self.content.save_state();
                    self.lines(&[window.corners()], true);
                    self.content.clip_nonzero().end_path();
                    self.draw(shapes);
                    self.content.restore_state();
                }
            }
        }
    }

    /// Paints the path that `trace` traces.
    fn paint(
        &mut self,
        paint: &Paint,
        trace: impl Fn(&mut Self),
        fill: impl Fn(&mut Content) -> &mut Content,
    ) {
        if let Some(colour) = paint.fill {
            let opacity = paint.opacity as f32;
            self.content.save_state();
            if opacity < 1.0 {
                let known = self.opacities.iter().position(|o| *o == opacity);
                let place = known.unwrap_or_else(|| {
                    self.opacities.push(opacity);
                    self.opacities.len() - 1
                });
                self.content.set_parameters(Name(&name(place)));
            }
            let [r, g, b] = rgb(colour).map(|part| f32::from(part) / 255.0);
            self.content.set_fill_rgb(r, g, b);
            trace(self);
            fill(&mut self.content).restore_state();
        }
        if let Some(pen) = &paint.pen {
            trace(self);
            self.stroke(pen);
        }
    }

    /// Traces lines through points.
    fn lines(&mut self, lines: &[impl AsRef<[Point]>], closed: bool) {
        for line in lines {
            for (k, [x, y]) in line.as_ref().iter().enumerate() {
                let [x, y] = [*x as f32, *y as f32].map(rounded);
                if k == 0 {
                    self.content.move_to(x, y);
                } else {
                    self.content.line_to(x, y);
                }
            }
            if closed {
                self.content.close_path();
            }
        }
    }

    /// Traces a path; quadratic curves are converted to cubic ones.
    fn path(&mut self, path: &Path) {
        let mut last = [0.0; 2];
        let place = |p: tiny_skia::Point| [p.x, p.y].map(rounded);
        for segment in path.segments() {
            match segment {
                PathSegment::MoveTo(p) => {
                    last = place(p);
                    self.content.move_to(last[0], last[1]);
                }
                PathSegment::LineTo(p) => {
                    last = place(p);
                    self.content.line_to(last[0], last[1]);
                }
                PathSegment::QuadTo(c, p) => {
                    let (c, p) = ([c.x, c.y], place(p));
                    let near = |end: [f32; 2]| {
                        [0, 1].map(|k| rounded(end[k] + 2.0 / 3.0 * (c[k] - end[k])))
                    };
                    let (a, b) = (near(last), near(p));
                    self.content.cubic_to(a[0], a[1], b[0], b[1], p[0], p[1]);
                    last = p;
                }
                PathSegment::CubicTo(a, b, p) => {
                    let (a, b) = (place(a), place(b));
                    last = place(p);
                    self.content.cubic_to(a[0], a[1], b[0], b[1], last[0], last[1]);
                }
                PathSegment::Close => {
                    self.content.close_path();
                }
            }
        }
    }

    /// Draws along the path traced last.
    fn stroke(&mut self, pen: &Pen) {
        let [r, g, b] = rgb(pen.colour).map(|part| f32::from(part) / 255.0);
        let cap = if pen.round { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap };
        self.content
            .set_stroke_rgb(r, g, b)
            .set_line_width(pen.width as f32)
            .set_line_cap(cap)
            .set_dash_pattern(dashes(&pen.dash), 0.0)
            .stroke();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    /// The objects begin at the offsets in the table of references, and the page draws every shape.
    #[test]
    fn a_page_has_its_size_and_all_shapes() {
        let corners = Rect::new(10.0, 10.0, 50.0, 20.0).corners().to_vec();
        let area = |opacity| Paint::fill("#ff0000").opacity(opacity);
        let inside = vec![
            Shape::Line(vec![[0.0, 0.0], [10.0, 20.0]], Pen::new("#0000ff", 2.0)),
            Shape::Area(vec![corners.clone()], area(0.5)),
        ];
        let shapes = [
            Shape::Clipped(Rect::new(0.0, 0.0, 30.0, 30.0), inside),
            Shape::Area(vec![corners], area(1.0)),
            Shape::Text([10.0, 40.0], "o".into(), Label::new("o", 20.0).look),
        ];
        let file = file([400.0, 200.0], &shapes);
        let text = String::from_utf8_lossy(&file);
        assert!(text.starts_with("%PDF-1.") && text.trim_end().ends_with("%%EOF"));
        assert!(text.contains("/MediaBox [0 0 300 150]"), "{text}");
        assert!(text.contains("/ca 0.5"), "{text}");
        let find = |part: &[u8]| file.windows(part.len()).position(|window| window == part);
        let table = find(b"xref\n").unwrap();
        for (k, line) in String::from_utf8_lossy(&file[table..]).lines().skip(3).take(4).enumerate()
        {
            let begin: usize = line[..10].parse().unwrap();
            assert!(file[begin..].starts_with(format!("{} 0 obj", k + 1).as_bytes()));
        }
        let begin = find(b"stream\n").unwrap() + 7;
        let end = find(b"\nendstream").unwrap();
        let content = miniz_oxide::inflate::decompress_to_vec_zlib(&file[begin..end]).unwrap();
        let content = String::from_utf8(content).unwrap();
        let count =
            |operator: &str| content.lines().filter(|line| line.ends_with(operator)).count();
        // Areas, the letter, the line and the window; all saved states are restored.
        assert_eq!(["f*", "f", "S", "W"].map(count), [2, 1, 1, 1], "{content}");
        assert_eq!(count("q"), content.lines().filter(|line| *line == "Q").count());
        assert!(content.contains("/G0 gs") && content.contains("1 0 0 rg") && count(" c") > 8);
    }
}
