//! Figures as SVG.

use std::fmt::Write;

use crate::geometry::Point;
use crate::label::{Anchor, Label, Look, RAISED, pieces};
use crate::paint::Pen;
use crate::shape::Shape;

/// Fonts in order of preference. Labels are measured with the first one.
const FONTS: &str = "Ubuntu, 'Ubuntu Light', 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif";

/// Returns a file with a sheet of this size and its shapes.
pub fn file([w, h]: Point, shapes: &[Shape]) -> String {
    let mut file = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"{FONTS}\" font-weight=\"300\" stroke-linejoin=\"round\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"
    );
    write(&mut file, shapes, &mut 0);
    file.push_str("</svg>\n");
    file
}

/// Writes shapes; `clips` is the number of clip paths so far.
fn write(file: &mut String, shapes: &[Shape], clips: &mut usize) {
    for shape in shapes {
        match shape {
            Shape::Line(points, pen) => path(file, &[points], "", &format!("fill=\"none\" {pen}")),
            Shape::Area(outlines, paint) => {
                path(file, outlines, "Z", &format!("fill-rule=\"evenodd\" {paint}"));
            }
            Shape::Text(at, text, look) => label(file, *at, Label { text, look: *look }),
            Shape::Clipped(window, shapes) => {
                *clips += 1;
                let _ = writeln!(
                    file,
                    "<clipPath id=\"c{0}\"><rect x=\"{1:.2}\" y=\"{2:.2}\" width=\"{3:.2}\" height=\"{4:.2}\"/></clipPath>\n<g clip-path=\"url(#c{0})\">",
                    clips,
                    window.x0,
                    window.y0,
                    window.width(),
                    window.height()
                );
                write(file, shapes, clips);
                file.push_str("</g>\n");
            }
        }
    }
}

fn path(file: &mut String, lines: &[impl AsRef<[Point]>], end: &str, style: &str) {
    file.push_str("<path d=\"");
    for line in lines {
        for (k, [x, y]) in line.as_ref().iter().enumerate() {
            let _ = write!(file, "{}{x:.2} {y:.2}", if k == 0 { 'M' } else { 'L' });
        }
        file.push_str(end);
    }
    let _ = writeln!(file, "\" {style}/>");
}

fn label(file: &mut String, at: Point, label: Label) {
    let [x, y] = at;
    let Look { size, colour, anchor, bold, turned } = label.look;
    let _ =
        write!(file, "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\" fill=\"{colour}\"");
    // The text keeps its length with any font. Some programs stretch superscripts wrongly, and
    // texts with superscripts are short.
    if let Some(length) = label.fixed_length() {
        let _ = write!(file, " textLength=\"{length:.2}\" lengthAdjust=\"spacingAndGlyphs\"");
    }
    match anchor {
        Anchor::Start => {}
        Anchor::Middle => file.push_str(" text-anchor=\"middle\""),
        Anchor::End => file.push_str(" text-anchor=\"end\""),
    }
    if bold {
        // The font has no bold face; its outlines are drawn instead.
        let _ = write!(file, " {}", Pen::new(colour, label.look.weight()));
    }
    if turned {
        let _ = write!(file, " transform=\"rotate(-90 {x:.2} {y:.2})\"");
    }
    file.push('>');
    for (piece, raised) in pieces(label.text).filter(|(piece, _)| !piece.is_empty()) {
        if raised {
            let (rise, small) = (label.look.rise(), RAISED * size);
            let _ = write!(
                file,
                "<tspan dy=\"-{rise:.2}\" font-size=\"{small:.2}\">{}</tspan>",
                escape(piece)
            );
        } else {
            file.push_str(&escape(piece));
        }
    }
    file.push_str("</text>\n");
}

/// Escapes a text for XML, without control characters, which XML forbids.
fn escape(text: &str) -> String {
    let clean: String = text.chars().filter(|c| !c.is_control()).collect();
    clean.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
