//! Paints of shapes: fill colours, and pens of outlines.

use std::fmt;

/// A pen: its colour, width, dashes and line ends.
#[derive(Clone, Debug)]
pub struct Pen {
    /// The colour, as `#` and six hexadecimal digits.
    pub colour: &'static str,
    /// The width, in units of the sheet.
    pub width: f64,
    /// The lengths of dashes and gaps in turn, in units of the sheet; empty for a solid line.
    pub dash: Vec<f64>,
    /// Whether lines end in half a circle instead of a straight edge.
    pub round: bool,
}

impl Pen {
    /// Creates a pen for solid lines.
    pub(crate) fn new(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dash: vec![], round: false }
    }

    /// Gives the pen dashes.
    pub(crate) fn dashed(self, dash: Vec<f64>) -> Self {
        Self { dash, ..self }
    }

    /// Gives the pen round ends.
    pub(crate) fn round(self) -> Self {
        Self { round: true, ..self }
    }
}

/// The pen as attributes of SVG.
impl fmt::Display for Pen {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (colour, width) = (self.colour, self.width);
        write!(f, "stroke=\"{colour}\" stroke-width=\"{width:.2}\"")?;
        if !self.dash.is_empty() {
            let lengths: Vec<_> = self.dash.iter().map(|d| format!("{d:.2}")).collect();
            write!(f, " stroke-dasharray=\"{}\"", lengths.join(" "))?;
        }
        if self.round {
            f.write_str(" stroke-linecap=\"round\"")?;
        }
        Ok(())
    }
}

/// The fill of a shape, and the pen of its outline.
#[derive(Clone, Debug)]
pub struct Paint {
    /// The colour inside, as `#` and six hexadecimal digits, if there is one.
    pub fill: Option<&'static str>,
    /// The opacity of the fill, from 0 to 1.
    pub opacity: f64,
    /// The pen of the outline, if it is drawn.
    pub pen: Option<Pen>,
}

impl Paint {
    /// Creates a paint that fills a shape.
    pub(crate) fn fill(colour: &'static str) -> Self {
        Self { fill: Some(colour), opacity: 1.0, pen: None }
    }

    /// Gives the paint another opacity.
    pub(crate) fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    /// Gives the paint a pen for the outline.
    pub(crate) fn outlined(self, pen: Pen) -> Self {
        Self { pen: Some(pen), ..self }
    }
}

impl From<Pen> for Paint {
    fn from(pen: Pen) -> Self {
        Self { fill: None, opacity: 1.0, pen: Some(pen) }
    }
}

/// The paint as attributes of SVG.
impl fmt::Display for Paint {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "fill=\"{}\"", self.fill.unwrap_or("none"))?;
        if self.opacity < 1.0 {
            write!(f, " fill-opacity=\"{}\"", self.opacity)?;
        }
        match &self.pen {
            Some(pen) => write!(f, " {pen}"),
            None => Ok(()),
        }
    }
}

/// Returns the red, green and blue of `#` and six hexadecimal digits; black if the code is invalid.
pub fn rgb(code: &str) -> [u8; 3] {
    let number = code.strip_prefix('#').filter(|digits| digits.len() == 6);
    let number = number.and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let [_, r, g, b] = number.unwrap_or(0).to_be_bytes();
    [r, g, b]
}

/// Returns dashes and gaps. Like SVG, it repeats an odd number of lengths.
pub fn dashes(lengths: &[f64]) -> Vec<f32> {
    let mut lengths: Vec<_> = lengths.iter().map(|d| *d as f32).collect();
    if lengths.len() % 2 == 1 {
        lengths.extend_from_within(..);
    }
    lengths
}
