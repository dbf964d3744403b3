//! Whole charts of made-up data at many sizes. With `A3_KEEP_CHARTS=folder` they are kept in that
//! folder.

use crate::{
    Curve, CurveStyle, Error, Figure, Line, LineChart, LinePanel, Marker, Measurement, Problem,
    Region, StabilityRegions, WorkPrecision,
};

const SIZES: [[f64; 2]; 4] = [[480.0, 360.0], [800.0, 600.0], [1280.0, 720.0], [3000.0, 2000.0]];

/// Methods: letter, name, and evaluations for the errors 3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8 (0:
/// never reached), for a cloth in one second.
const METHODS: [(char, &str, [f64; 6]); 13] = [
    ('v', "velocity Verlet", [541.0, 1081.0, 4201.0, 11_821.0, 0.0, 0.0]),
    ('p', "PEFRL", [1440.0, 1440.0, 1440.0, 2880.0, 4080.0, 15_840.0]),
    ('x', "DOP853", [2605.0, 2605.0, 3637.0, 5461.0, 6589.0, 11_197.0]),
    ('r', "classical RK4", [1680.0, 1680.0, 6000.0, 12_000.0, 17_040.0, 47_760.0]),
    ('s', "symplectic Euler", [540.0, 2100.0, 16_740.0, 0.0, 0.0, 0.0]),
    ('t', "Heun", [7080.0, 7080.0, 14_040.0, 55_800.0, 0.0, 0.0]),
    ('a', "Dormand-Prince 5(4)", [4105.0, 4105.0, 5083.0, 7789.0, 11_905.0, 29_341.0]),
    ('e', "explicit Euler", [90_000.0, 200_000.0, 0.0, 0.0, 0.0, 0.0]),
    ('m', "explicit midpoint", [6800.0, 7000.0, 13_000.0, 50_000.0, 0.0, 0.0]),
    ('f', "Fehlberg 4(5)", [5000.0, 5300.0, 7000.0, 11_000.0, 18_000.0, 60_000.0]),
    ('i', "implicit Euler", [3000.0, 9000.0, 80_000.0, 0.0, 0.0, 0.0]),
    ('b', "TR-BDF2", [2500.0, 4200.0, 12_000.0, 39_000.0, 0.0, 0.0]),
    ('n', "implicit midpoint", [3600.0, 5200.0, 16_000.0, 48_000.0, 0.0, 0.0]),
];

/// Returns a style that differs between methods.
fn style(letter: char) -> CurveStyle {
    let k = letter as usize;
    let colours = ["#d55e00", "#0072b2", "#882255", "#117733"];
    let dashes: [&[f64]; 3] = [&[], &[7.0, 2.5], &[7.0, 2.0, 1.5, 2.0]];
    let markers = [
        Marker::Polygon(3 + k as u8 % 5, 0.0),
        Marker::Star(4 + k as u8 % 3, 0.4),
        Marker::Cross(0.125),
    ];
    CurveStyle { colour: colours[k % 4], dash: dashes[k % 3], marker: markers[k / 4 % 3] }
}

fn curves(n: usize, slower: f64) -> Vec<Curve> {
    let errors = [3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8];
    let run = |error, work, lost| Measurement {
        error,
        work,
        lost,
        held: error == 1e-3,
        label: Some(format!("{:.3} ms", 2000.0 / work)),
        spread: Some([0.8 * error, 1.3 * error]),
    };
    let curve = |&(letter, name, works): &(char, &str, [f64; 6])| {
        let reached = errors.into_iter().zip(works).filter(|(_, work)| *work > 0.0);
        let mut wobble = 1.0;
        let mut runs: Vec<_> = reached
            .map(|(error, work)| {
                wobble *= 0.93;
                run(error * wobble, work * slower / wobble, false)
            })
            .collect();
        let lost = works[0] * slower * 0.6;
        runs.extend([lost, lost / 2.0].map(|work| run(f64::NAN, work, true)));
        Curve { style: style(letter), name: name.to_owned(), runs }
    };
    METHODS[..n].iter().map(curve).collect()
}

fn precision_chart(methods: usize, panels: usize) -> WorkPrecision {
    let scenes = [
        "cloth 20 x 20, stiff",
        "elastic pendulum",
        "chain of 4",
        "course's cloth",
        "cloth with drag",
        "circle",
    ];
    let problem = |(k, title): (usize, &&str)| Problem {
        title: (*title).to_owned(),
        curves: curves(methods, 1.0 + 0.7 * k as f64),
        resolved: [Some(8e-9), Some(3e-7), None][k % 3],
        ..Problem::default()
    };
    WorkPrecision {
        title: "Speed against accuracy".to_owned(),
        subtitle: "One second of each scene; every point is a whole run at one step or tolerance. <made-up & only a test>".to_owned(),
        x_label: "largest RMS position error over the run (m)".to_owned(),
        y_label: "force evaluations".to_owned(),
        problems: scenes[..panels].iter().enumerate().map(problem).collect(),
        foot: "Reference: DOP853 at two tolerances and PEFRL with its step halved; the floor is their largest disagreement.".to_owned(),
        held: "held by something else".to_owned(),
    }
}

type Radius = fn(f64, f64) -> f64;

/// Returns |1 + z + ... + z^n / n!| with z = x + i y.
fn taylor(order: i32, x: f64, y: f64) -> f64 {
    let (mut sum, mut term) = ([1.0, 0.0], [1.0, 0.0]);
    for k in 1..=order {
        let k = f64::from(k);
        term = [(term[0] * x - term[1] * y) / k, (term[0] * y + term[1] * x) / k];
        sum = [sum[0] + term[0], sum[1] + term[1]];
    }
    sum[0].hypot(sum[1])
}

fn region_chart(n: usize) -> StabilityRegions {
    let radii: [Radius; 5] = [
        |x, y| taylor(1, x, y),
        |x, y| taylor(2, x, y),
        |x, y| taylor(4, x, y),
        |x, y| 1.0 / (1.0 - x).hypot(y),
        |x, y| (1.0 + x / 2.0).hypot(y / 2.0) / (1.0 - x / 2.0).hypot(y / 2.0),
    ];
    let methods = [
        ('e', "explicit Euler", 0, 1.0),
        ('t', "Heun", 1, 5.0),
        ('r', "classical RK4", 2, 6.0),
        ('i', "implicit Euler", 3, 12.0),
        ('n', "implicit midpoint", 4, 10.0),
    ];
    let region = |k: usize| {
        let (letter, name, radius, step) = methods[k % 5];
        // A damped cloth: frequencies up to 500 rad/s, decay like frequency squared.
        let eigenvalues = (1..=40).flat_map(|k| {
            let omega = 12.5 * f64::from(k);
            let [re, im] = [-0.0006 * omega * omega, omega];
            [[re, im], [re, -im]].map(|z| z.map(|part| part * step * 1e-3))
        });
        let far = (letter == 'i').then_some([-50.0, 0.0]);
        Region {
            style: style(letter),
            title: format!("{name}, h\u{a0}=\u{a0}{step}\u{a0}ms"),
            subtitle: format!(
                "largest stable step: predicted\u{a0}{:.2}\u{a0}ms, observed\u{a0}{:.1}\u{a0}ms",
                step * 1.042,
                step * 1.06
            ),
            radius: Box::new(radii[radius]),
            slow: 1.001,
            eigenvalues: eigenvalues.chain(far).collect(),
        }
    };
    StabilityRegions {
        title: "Where each method is stable".to_owned(),
        subtitle: "Eigenvalues of the default cloth hanging at rest, times the step".to_owned(),
        note: "A note on the titles, which is longer than a line of a narrow sheet.".to_owned(),
        regions: (0..n).map(region).collect(),
    }
}

fn check(name: &str, chart: &dyn Fn(f64, f64) -> Result<Figure, Error>) {
    for [w, h] in SIZES {
        let figure = chart(w, h).unwrap();
        assert!(figure.is_sound(), "{name} at {w} x {h}: texts overlap, or leave the sheet");
        let svg = figure.svg();
        let tree = roxmltree::Document::parse(&svg).unwrap();
        assert!(tree.descendants().any(|node| node.has_tag_name("text")));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name} at {w} x {h}");
        if let Some(folder) = std::env::var_os("A3_KEEP_CHARTS") {
            let path = std::path::Path::new(&folder).join(format!("{name}-{w}x{h}"));
            std::fs::write(path.with_extension("svg"), &svg).unwrap();
            let scale = if w < 1000.0 { 2.0 } else { 1.0 };
            std::fs::write(path.with_extension("png"), figure.png(scale).unwrap()).unwrap();
        }
    }
}

#[test]
fn no_text_of_a_precision_chart_covers_another() {
    for methods in [1, 4, 13] {
        for panels in [1, 2, 6] {
            let chart = precision_chart(methods, panels);
            check(&format!("precision-{methods}-{panels}"), &|w, h| chart.draw(w, h));
        }
    }
}

#[test]
fn long_names_are_cut_and_change_nothing_else() {
    let long = "name".repeat(60);
    let mut chart = precision_chart(13, 2);
    for text in [&mut chart.title, &mut chart.subtitle, &mut chart.x_label, &mut chart.y_label] {
        text.clone_from(&long);
    }
    for problem in &mut chart.problems {
        problem.title.clone_from(&long);
        for curve in &mut problem.curves {
            curve.name.clone_from(&long);
        }
    }
    check("long", &|w, h| chart.draw(w, h.max(600.0)));
}

#[test]
fn no_text_of_a_stability_chart_covers_another() {
    for panels in [1, 4, 13] {
        let chart = region_chart(panels);
        check(&format!("regions-{panels}"), &|w, h| chart.draw(w, h));
    }
}

#[test]
fn eigenvalues_outside_the_region_are_crosses_or_rings() {
    let chart = |radius: Radius, eigenvalues| StabilityRegions {
        title: String::new(),
        subtitle: String::new(),
        note: String::new(),
        regions: vec![Region {
            style: CurveStyle::default(),
            title: String::new(),
            subtitle: String::new(),
            radius: Box::new(radius),
            slow: 1.01,
            eigenvalues,
        }],
    };
    let crosses = |radius, eigenvalues| {
        let figure = chart(radius, eigenvalues).draw(800.0, 600.0).unwrap();
        // Two lines each, plus those of the legend.
        figure.svg().matches("#d0021b").count() / 2 - 1
    };
    let z = || vec![[-1.0, 0.9], [-1.0, 1.1], [0.1, 0.0], [f64::NAN, 0.0], [2.5, 0.0]];
    assert_eq!(crosses(|x, y| taylor(1, x, y), z()), 3);
    assert_eq!(crosses(|x, y| 1.0 / (1.0 - x).hypot(y), z()), 1);
    assert_eq!(crosses(|_, _| f64::NAN, z()), 4);
    let rings = |z| {
        let figure = chart(|x, y| taylor(2, x, y), z).draw(800.0, 600.0).unwrap();
        // One line each, plus that of the legend.
        figure.svg().matches("#c77700").count() - 1
    };
    // The growth by Heun's method is the root of 1 + y^4 / 4: at 0.5 it is 1.0078, at 0.6 it is
    // 1.016.
    assert_eq!(rings(vec![[0.0, 0.5], [0.0, 0.6], [-0.5, 0.5]]), 1);
}

/// Creates a chart of sines in panels below one another.
fn line_chart(panels: usize, lines: usize) -> LineChart {
    let line = |k: usize| Line {
        name: format!("particle {k} by the classical Runge-Kutta method"),
        pieces: vec![
            (0..200)
                .map(|n| 0.1 * f64::from(n))
                .map(|t| [t, 1e-3 * (t + k as f64).sin() - 7.0])
                .collect(),
        ],
        dots: k % 3 == 2,
        ..Line::default()
    };
    let panel = |k: usize| LinePanel {
        x_label: "time (s)".into(),
        y_label: format!("kinetic energy of part {k} (J)"),
        ends: k.is_multiple_of(2).then_some([0.0, 20.0]),
        lines: (0..lines).map(line).collect(),
    };
    LineChart {
        title: "double-pendulum".into(),
        subtitle: "explicit trapezoid (Heun), step 0.01 s".into(),
        panels: (0..panels).map(panel).collect(),
        foot: "Positions are measured from the origin of the scene.".into(),
    }
}

#[test]
fn no_text_of_a_line_chart_covers_another() {
    for (panels, lines) in [(1, 1), (1, 8), (3, 6)] {
        let chart = line_chart(panels, lines);
        check(&format!("lines-{panels}-{lines}"), &|w, h| chart.draw(w, h));
    }
    let svg = line_chart(3, 6).draw(1280.0, 720.0).unwrap().svg();
    assert_eq!(svg.matches("time (s)").count(), 1);
    assert!(LineChart::default().draw(800.0, 600.0).is_err());
}

#[test]
fn a_sheet_too_small_is_refused_with_one_that_is_not() {
    let why = precision_chart(13, 6).draw(200.0, 100.0).unwrap_err().to_string();
    let enough = why.split("; ").nth(1).unwrap().split(' ').filter_map(|word| word.parse().ok());
    let [w, h] = enough.collect::<Vec<f64>>().try_into().unwrap();
    assert!(precision_chart(13, 6).draw(w, h).is_ok(), "{why}");
    assert!(precision_chart(1, 1).draw(f64::NAN, 100.0).is_err());
    assert!(
        WorkPrecision { problems: vec![], ..precision_chart(1, 1) }.draw(800.0, 600.0).is_err()
    );
}
