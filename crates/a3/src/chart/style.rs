//! The style of each method, on every chart. The family of a method shows three times: in the hue,
//! the dash and the kind of marker. The colours, after Okabe and Ito and after Tol, are told apart
//! with any kind of colour vision.

use a3_plot::{CurveStyle, Marker};

const EXPLICIT: &[f64] = &[];
const EXPLICIT_2: &[f64] = &[4.0, 4.0];
const SYMPLECTIC: &[f64] = &[7.0, 2.5];
const ADAPTIVE: &[f64] = &[1.5, 1.8];
const IMPLICIT: &[f64] = &[7.0, 2.0, 1.5, 2.0];
/// Methods that solve spring by spring and stop before they have solved.
const UNSOLVED: &[f64] = &[3.5, 3.5];

/// The style of a method by its letter; grey for one without a style of its own.
pub fn of(letter: char) -> CurveStyle {
    use Marker::{Cross, Polygon, Star};
    let (colour, dash, marker) = match letter {
        'e' => ("#d55e00", EXPLICIT, Polygon(32, 0.0)),
        't' => ("#e69f00", EXPLICIT, Polygon(4, 0.125)),
        // On linear motion its errors are those of Heun, whose line shows through the gaps.
        'm' => ("#8c8a2b", EXPLICIT_2, Polygon(4, 0.0)),
        'r' => ("#882255", EXPLICIT, Polygon(5, 0.0)),
        's' => ("#3f9fdc", SYMPLECTIC, Polygon(3, 0.5)),
        'v' => ("#0072b2", SYMPLECTIC, Polygon(3, 0.0)),
        'p' => ("#332288", SYMPLECTIC, Polygon(3, 0.25)),
        'f' => ("#cc79a7", ADAPTIVE, Star(4, 0.4)),
        'a' => ("#a03494", ADAPTIVE, Star(5, 0.42)),
        'x' => ("#000000", ADAPTIVE, Star(6, 0.45)),
        'u' => ("#aa3377", ADAPTIVE, Star(5, 0.25)),
        'k' => ("#6699cc", SYMPLECTIC, Polygon(5, 0.5)),
        'd' => ("#ee6677", ADAPTIVE, Star(3, 0.35)),
        'g' => ("#997700", ADAPTIVE, Star(8, 0.5)),
        'i' => ("#8bc34a", IMPLICIT, Cross(0.0)),
        'b' => ("#009e73", IMPLICIT, Cross(0.125)),
        'n' => ("#117733", IMPLICIT, Polygon(6, 0.0)),
        'o' => ("#5a7f1e", IMPLICIT, Star(3, 0.4)),
        'c' => ("#b3703c", UNSOLVED, Polygon(8, 0.0)),
        'j' => ("#7a4419", UNSOLVED, Polygon(8, 0.0625)),
        'y' => ("#8a8d91", UNSOLVED, Star(3, 0.4)),
        _ => return CurveStyle::default(),
    };
    CurveStyle {
        colour,
        dash,
        marker,
    }
}
