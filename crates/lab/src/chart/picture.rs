//! The work-precision diagram of the runs, and the style of each method, the same on every chart.
//!
//! The family of a method is shown by the hue, by the dash and by the kind of marker. The colours
//! are after Okabe and Ito and after Tol. If two methods on a chart have colours that look alike
//! to some kind of colour vision, one of them gets another colour there.

use std::fmt::Write;

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Method, Scene};
use a3_plot::{Curve, CurveStyle, Marker, Measurement, Problem, WorkPrecision};

use super::asked::{lasting, unit};
use super::measure::{Chart, Study};
use super::record::Record;
use super::table;

/// Largest error of a run that is drawn, over the error of a run in which nothing moves.
const MAX_ERROR_RATIO: f64 = 10.0;

/// Label of the vertical axis where work is shown, and not computing time.
pub const WORK: &str = "evaluations per simulated second, linear algebra included";

/// Creates the diagram of a chart, with a panel for each study.
pub fn chart(chart: &Chart) -> WorkPrecision {
    let Chart { studies, data, methods, metric, timed, .. } = chart;
    let (first, scope) = (&studies[0], studies[0].scope());
    let (model, until) = (&first.scene.model, first.frames.until);
    // The work of a second says nothing where time has another unit.
    let is_own = model.network().is_none();
    let problems = studies.iter().map(|study| {
        let records: Vec<_> = study.records(data).collect();
        let beside: Vec<_> = study.beside(data).collect();
        let mut problem = problem(&records, &beside, methods, *metric, *timed);
        if studies.len() > 1 || study.stiffness() != 1.0 {
            problem.title = format!("stiffness × {}", study.stiffness());
        }
        if is_own {
            // A run that blew up is drawn at the work that it took.
            for (curve, method) in problem.curves.iter_mut().zip(methods) {
                let drawn = drawn(&records, method, *metric);
                for (run, record) in curve.runs.iter_mut().zip(drawn) {
                    run.work *= record.lost_at.unwrap_or(until);
                }
            }
        }
        problem
    });
    let is_spread = |study: &Study| study.beside(data).next().is_some();
    let bands = studies.iter().any(is_spread);
    let bands = bands.then_some("; bands: errors at tolerances within 4 %");
    WorkPrecision {
        title: format!("Speed against accuracy: {}", chart.title),
        subtitle: format!(
            "{} of motion; each point is a run with another step or tolerance{}",
            lasting(model, until),
            bands.unwrap_or_default()
        ),
        x_label: x_label(*metric, scope),
        y_label: match (*timed, is_own) {
            (true, false) => "computing time per simulated second (s)",
            (true, true) => "computing time (s)",
            (false, false) => WORK,
            (false, true) => "work (evaluations of f, linear algebra included)",
        }
        .into(),
        problems: problems.collect(),
        foot: foot(methods) + turning(&first.scene, methods),
        held: "held by impulses".into(),
    }
}

/// Letters of the solvers whose steps turn rigid bodies by a composition of order 6.
const TURNING: [char; 3] = ['s', 'v', 'p'];

/// Keeps the curves of the methods that are cheapest for some error in some panel, of those that
/// the course teaches, and of own methods.
pub fn keep_best(chart: &mut WorkPrecision, methods: &[&'static Method], scene: &Scene) {
    let is_kept = |m: &&'static Method| m.is_own() || is_of_course(m);
    let mut kept: Vec<_> = methods.iter().map(is_kept).collect();
    for problem in &chart.problems {
        for [curve, _] in problem.front() {
            kept[curve] = true;
        }
    }
    let left_out = kept.iter().filter(|kept| !**kept).count();
    if left_out == 0 {
        return;
    }
    let drawn = methods.iter().zip(&kept);
    let drawn: Vec<_> = drawn.filter_map(|(m, kept)| kept.then_some(*m)).collect();
    let styles = together(&drawn);
    for problem in &mut chart.problems {
        let mut kept = kept.iter();
        let is_kept = |_: &Curve| kept.next().is_some_and(|kept| *kept);
        problem.curves.retain(is_kept);
        for (curve, style) in problem.curves.iter_mut().zip(&styles) {
            curve.style = *style;
        }
    }
    chart.foot = foot(&drawn) + turning(scene, &drawn);
    let _ = write!(chart.subtitle, "; {left_out} more solvers, cheapest nowhere, are in the table");
}

/// Explains below the chart how errors are measured, and which methods soften the springs.
pub fn foot(methods: &[&'static Method]) -> String {
    let errors = "Errors are true ones, against DOP853, or Radau where the system is stiff, at two \
                  tolerances and a method of another family. Those below ten times their disagreement are shaded.";
    if methods.iter().any(|method| method.needs_springs()) {
        format!(
            "{errors} Methods with a number of iterations stop before implicit Euler is solved: \
             in long steps their springs are softer than the scene's."
        )
    } else {
        errors.into()
    }
}

/// Returns a note on the methods that turn rigid bodies more accurately than their order says, if
/// the chart has both.
fn turning(scene: &Scene, methods: &[&'static Method]) -> &'static str {
    let network = scene.model.network();
    let has_bodies = network.is_some_and(|network| !network.bodies().is_empty());
    let turns = |m: &&'static Method| m.letter.is_some_and(|it| TURNING.contains(&it));
    if has_bodies && methods.iter().any(turns) {
        " Symplectic Euler, Verlet and PEFRL turn bodies by a composition of order 6, whatever \
         their own order: in free flight their errors fall with it."
    } else {
        ""
    }
}

/// Returns the label of the horizontal axis.
pub fn x_label(metric: Metric, scope: Scope) -> String {
    let what = match (metric, scope.particle) {
        (Metric::Position, None) => "RMS error of the positions".to_owned(),
        (Metric::Position, Some(i)) => format!("error of the position of particle {i}"),
        (Metric::State, _) => "RMS error of the state".to_owned(),
        (Metric::Energy, _) => "error of the energy".to_owned(),
        (Metric::Strain, _) => "RMS error of the springs' stretch".to_owned(),
        (Metric::Momentum, _) => "error of the momentum".to_owned(),
        (Metric::Penetration, _) => "error of the penetration".to_owned(),
        (Metric::Impact, _) => "error of the times of the first impact".to_owned(),
        (Metric::Phase, None) => "error of the phase".to_owned(),
        (Metric::Phase, Some(i)) => format!("error of the phase of particle {i}"),
    };
    let unit = unit(metric);
    if scope.at_end {
        format!("{what} at the end ({unit})")
    } else {
        format!("largest {what} ({unit})")
    }
}

/// Returns the smallest and the largest error of a run and its neighbours in tolerance; `None`
/// without neighbours.
fn spread(run: &Record, beside: &[&Record], metric: Metric) -> Option<[f64; 2]> {
    let own = run.error(metric);
    let is_near = |r: &&&Record| r.solver == run.solver && r.beside == Some(run.setting);
    let errors = beside.iter().filter(is_near).map(|r| r.error(metric));
    errors.fold(None, |ends, error| {
        let [min, max] = ends.unwrap_or([own, own]);
        Some([min.min(error), max.max(error)])
    })
}

/// Returns the runs of a method that its curve has, in the order of the curve.
pub fn drawn<'a>(all: &[&'a Record], method: &Method, metric: Metric) -> Vec<&'a Record> {
    let mut records: Vec<_> = all
        .iter()
        .copied()
        .filter(|r| r.solver == method.name)
        .filter(|r| r.lost_at.is_some() || r.error(metric) <= MAX_ERROR_RATIO * r.still(metric))
        .collect();
    records.sort_by(|a, b| b.setting.total_cmp(&a.setting));
    records
}

/// Creates the panel of a scene's runs, without a title. The errors of the runs at neighbouring
/// tolerances become bands.
pub fn problem(
    all: &[&Record],
    beside: &[&Record],
    methods: &[&'static Method],
    metric: Metric,
    timed: bool,
) -> Problem {
    let styles = together(methods);
    let curves = methods.iter().zip(styles).map(|(method, style)| {
        let records = drawn(all, method, metric);
        // A run that blew up is drawn at the work that it would have taken until the end. It was
        // not timed: its computing time is estimated from the other runs of the method.
        let prices = records.iter().filter_map(|r| Some(r.seconds? / r.work));
        let price = prices.fold(f64::INFINITY, f64::min);
        let run = |r: &&Record| {
            let whole = |work: f64| r.lost_at.map_or(work, |at| work * r.until / at);
            let work =
                if timed { r.seconds.unwrap_or(whole(r.work) * price) } else { whole(r.work) };
            Measurement {
                error: r.error(metric),
                work: work / r.until,
                lost: r.lost_at.is_some(),
                held: r.is_held(),
                label: Some(table::words(method.control(r.setting))),
                spread: spread(r, beside, metric),
            }
        };
        Curve { style, name: method.title.to_owned(), runs: records.iter().map(run).collect() }
    });
    let resolved = all.iter().map(|r| r.resolved(metric)).reduce(f64::max);
    let still = all.iter().map(|r| r.still(metric));
    let still = still.fold(f64::INFINITY, f64::min);
    Problem {
        curves: curves.collect(),
        resolved,
        still: Some(still).filter(|still| still.is_finite()),
        ..Problem::default()
    }
}

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
            let is_free = |spare: &&str| !own_colours.contains(spare);
            let spare = || SPARE.into_iter().filter(is_free);
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
        None => own.next().map_or_else(CurveStyle::default, |(colour, marker)| {
            CurveStyle::new(colour, OWN, marker)
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
        'u' => ("#aa3377", ADAPTIVE, Star(2, 0.5)),
        'k' => ("#6699cc", SYMPLECTIC, Polygon(5, 0.5)),
        'd' => ("#ee6677", ADAPTIVE, Star(3, 0.35)),
        'g' => ("#997700", ADAPTIVE, Star(8, 0.5)),
        'i' => ("#44aa99", IMPLICIT, Cross(0.0)),
        'b' => ("#009e73", IMPLICIT, Cross(0.125)),
        'n' => ("#117733", IMPLICIT, Polygon(6, 0.0)),
        'o' => ("#5a7f1e", IMPLICIT, Star(3, 0.4)),
        'w' => ("#2f6b8f", IMPLICIT, Star(4, 0.3)),
        'c' => ("#b3703c", ITERATED, Polygon(8, 0.0)),
        'j' => ("#7a4419", ITERATED, Polygon(8, 0.0625)),
        'h' => ("#1f4fa8", SYMPLECTIC, Polygon(6, 0.5)),
        'y' => ("#8a8d91", ITERATED, Star(3, 0.4)),
        _ => return CurveStyle::default(),
    };
    CurveStyle::new(colour, dash, marker)
}

/// Matrix from red, green and blue in linear light to the responses of the three kinds of cones
/// (Oklab, Ottosson 2020).
const CONES: Matrix = [
    [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
    [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
    [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
];
/// Matrix from the cube roots of these responses to lightness, green to red, and blue to yellow.
const OKLAB: Matrix = [
    [0.210_454_255_3, 0.793_617_785, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766],
];
/// Matrices from colours in linear light to their appearance without long, middle or short cones
/// (Machado, Oliveira, Fernandes 2009).
const WITHOUT: [Matrix; 3] = [
    [
        [0.152_286, 1.052_583, -0.204_868],
        [0.114_503, 0.786_281, 0.099_216],
        [-0.003_882, -0.048_116, 1.051_998],
    ],
    [
        [0.367_322, 0.860_646, -0.227_968],
        [0.280_085, 0.672_501, 0.047_413],
        [-0.011_82, 0.042_94, 0.968_881],
    ],
    [
        [1.255_528, -0.076_749, -0.178_779],
        [-0.078_411, 0.930_809, 0.147_602],
        [0.004_733, 0.691_367, 0.303_9],
    ],
];
/// Weight of the difference that people with all cones see: thin lines need a larger difference to
/// be told apart at a glance.
const FULL_VISION: f64 = 0.6;

type Matrix = [[f64; 3]; 3];

/// Returns the difference of two colours, each `#` and six hexadecimal digits, to the kind of
/// colour vision to which it is smallest. Black and white differ by 60.
pub fn difference(a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(linear);
    let apart = |[a, b]: [[f64; 3]; 2]| {
        let [a, b] = [a, b].map(lab);
        100.0 * (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    let without = WITHOUT.iter().map(|m| apart([times(m, a), times(m, b)]));
    without.fold(FULL_VISION * apart([a, b]), f64::min)
}

/// Returns red, green and blue of a colour in linear light, from 0 to 1.
fn linear(colour: &str) -> [f64; 3] {
    [1, 3, 5].map(|k| {
        let digits = colour.get(k..k + 2).unwrap_or_default();
        let part = f64::from(u8::from_str_radix(digits, 16).unwrap_or(0)) / 255.0;
        if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    })
}

/// Returns the Oklab coordinates of a colour in linear light.
fn lab(colour: [f64; 3]) -> [f64; 3] {
    let inside = colour.map(|part| part.clamp(0.0, 1.0));
    times(&OKLAB, times(&CONES, inside).map(f64::cbrt))
}

/// Multiplies a vector by a matrix.
fn times(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| m[i][k] * v[k]).sum())
}

#[cfg(test)]
mod tests {
    use a3_core::integrators::METHODS;

    use super::*;

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
            let shown: Vec<_> = course.iter().copied().chain(chosen.map(|k| others[k])).collect();
            let styles = together(&shown);
            for (k, style) in styles.iter().enumerate() {
                assert!(k > 3 || style.colour == of(shown[k].letter.unwrap()).colour);
                for other in &styles[..k] {
                    let apart = difference(style.colour, other.colour);
                    assert!(apart >= MIN_DIFFERENCE, "{} {} {apart}", style.colour, other.colour);
                }
            }
        }
    }

    /// The area of each star, over the square of its radius: thinner ones are lost in their line.
    #[test]
    fn every_marker_is_seen() {
        for method in METHODS {
            let marker = of(method.letter.unwrap()).marker;
            if let Marker::Star(n, dent) = marker {
                let area = f64::from(n) * 1.35_f64.powi(2) * dent;
                let area = area * (std::f64::consts::PI / f64::from(n)).sin();
                assert!(area > 1.5, "{}: {area}", method.name);
            }
        }
    }

    #[test]
    fn known_differences_are_found() {
        assert!((difference("#000000", "#ffffff") - 60.0).abs() < 0.01);
        // Red and green of one lightness, which many people cannot tell apart, and blue and yellow.
        assert!(difference("#997700", "#5a7f1e") < 1.0);
        assert!(difference("#0072b2", "#e69f00") > 15.0);
    }
}
