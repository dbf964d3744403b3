//! The style of each method, on every chart. The family of a method is shown by the hue, by the
//! dash and by the kind of marker. The colours are after Okabe and Ito and after Tol. If two
//! methods on a chart have colours that look alike to some kind of colour vision, one of them gets
//! another colour there.

use a3_core::Method;
use a3_plot::{CurveStyle, Marker};

use super::vision::difference;

const EXPLICIT: &[f64] = &[];
const EXPLICIT_2: &[f64] = &[4.0, 4.0];
const SYMPLECTIC: &[f64] = &[7.0, 2.5];
const ADAPTIVE: &[f64] = &[1.5, 1.8];
const IMPLICIT: &[f64] = &[7.0, 2.0, 1.5, 2.0];
/// Methods that solve spring by spring with a fixed number of iterations.
const ITERATED: &[f64] = &[3.5, 3.5];

/// Own methods.
const OWN: &[f64] = &[9.0, 2.0, 1.5, 2.0, 1.5, 2.0];
/// Colours and markers of own methods, one after the other.
const OWN_STYLES: [(&str, Marker); 4] = [
    ("#e6007e", Marker::Star(7, 0.6)),
    ("#00a3c7", Marker::Polygon(7, 0.0)),
    ("#7fae00", Marker::Star(4, 0.7)),
    ("#8f5bd1", Marker::Star(12, 0.6)),
];

/// Letters of the solvers that the course teaches, whose curves are always drawn.
const COURSE: [char; 4] = ['e', 't', 'r', 'i'];

/// Smallest [difference] of two colours on a chart, if there are enough colours.
const MIN_DIFFERENCE: f64 = 8.0;
/// Colours for methods whose own colours look like others, the most visible first.
const SPARE: [&str; 18] = [
    "#0072b2", "#009e73", "#cc79a7", "#332288", "#56b4e9", "#117733", "#000000", "#777777",
    "#5c3317", "#aa4499", "#0000cc", "#004d40", "#8bc34a", "#cc6677", "#999933", "#bb99ff",
    "#d55e00", "#e69f00",
];

/// Returns the styles of methods that are drawn together, in their order. The solvers of the course
/// keep their colours.
pub fn together(methods: &[&Method]) -> Vec<CurveStyle> {
    let mut styles = each(methods);
    let mut places: Vec<_> = (0..methods.len()).collect();
    places.sort_by_key(|k| !is_of_course(methods[*k]));
    let own_colours: Vec<_> = styles.iter().map(|style| style.colour).collect();
    let mut taken: Vec<&str> = vec![];
    for k in places {
        let nearest = |colour: &str| {
            let distances = taken.iter().map(|other| difference(colour, other));
            distances.fold(f64::INFINITY, f64::min)
        };
        let own = styles[k].colour;
        if nearest(own) < MIN_DIFFERENCE {
            let spare = || {
                SPARE
                    .into_iter()
                    .filter(|spare| !own_colours.contains(spare))
            };
            let farthest = || spare().max_by(|a, b| nearest(a).total_cmp(&nearest(b)));
            let apart = spare().find(|spare| nearest(spare) >= MIN_DIFFERENCE);
            styles[k].colour = apart.or_else(farthest).unwrap_or(own);
        }
        taken.push(styles[k].colour);
    }
    styles
}

/// Returns whether the course teaches a method.
pub fn is_of_course(method: &Method) -> bool {
    method.letter.is_some_and(|letter| COURSE.contains(&letter))
}

/// Returns the own style of each of these methods. Own methods get theirs in turn.
pub fn each(methods: &[&Method]) -> Vec<CurveStyle> {
    let mut own = OWN_STYLES.into_iter().cycle();
    let styles = methods.iter().map(|method| match method.letter {
        Some(letter) => of(letter),
        None => own
            .next()
            .map_or_else(CurveStyle::default, |(colour, marker)| CurveStyle {
                colour,
                dash: OWN,
                marker,
            }),
    });
    styles.collect()
}

/// Returns the style of a method of the table by its letter; the default style for any other
/// letter.
fn of(letter: char) -> CurveStyle {
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
        'i' => ("#44aa99", IMPLICIT, Cross(0.0)),
        'b' => ("#009e73", IMPLICIT, Cross(0.125)),
        'n' => ("#117733", IMPLICIT, Polygon(6, 0.0)),
        'o' => ("#5a7f1e", IMPLICIT, Star(3, 0.4)),
        'c' => ("#b3703c", ITERATED, Polygon(8, 0.0)),
        'j' => ("#7a4419", ITERATED, Polygon(8, 0.0625)),
        'h' => ("#1f4fa8", SYMPLECTIC, Polygon(6, 0.5)),
        'y' => ("#8a8d91", ITERATED, Star(3, 0.4)),
        _ => return CurveStyle::default(),
    };
    CurveStyle {
        colour,
        dash,
        marker,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::integrators::METHODS;

    /// The course's four and any four others, as they are drawn by default.
    #[test]
    fn no_two_colours_on_a_chart_look_alike() {
        let (course, others): (Vec<_>, Vec<_>) =
            METHODS.iter().partition(|method| is_of_course(method));
        let mut count = 0;
        for choice in (0..1_u32 << others.len()).filter(|set| set.count_ones() == 4) {
            count += 1;
            if count % 16 != 0 {
                continue;
            }
            let chosen = (0..others.len()).filter(|k| choice >> k & 1 == 1);
            let shown: Vec<_> = course
                .iter()
                .copied()
                .chain(chosen.map(|k| others[k]))
                .collect();
            let styles = together(&shown);
            for (k, style) in styles.iter().enumerate() {
                assert!(k > 3 || style.colour == of(shown[k].letter.unwrap()).colour);
                for other in &styles[..k] {
                    let apart = difference(style.colour, other.colour);
                    assert!(
                        apart >= MIN_DIFFERENCE,
                        "{} {} {apart}",
                        style.colour,
                        other.colour
                    );
                }
            }
        }
    }
}
