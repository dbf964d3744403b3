//! Whole charts of made-up data at many sizes. With `A3_KEEP_CHARTS=folder` they are left there to be looked at.

use resvg::usvg::roxmltree;

use super::axis::Axis;
use super::figure::{Figure, png};
use super::rect::Rect;
use super::text::Text;
use super::{layout, precision, regions};

const SIZES: [[f64; 2]; 4] = [
    [480.0, 360.0],
    [800.0, 600.0],
    [1280.0, 720.0],
    [3000.0, 2000.0],
];

/// Letter, name, and evaluations for the errors 3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8 (0: never reached), for a cloth in one second.
const METHODS: [(char, &str, [f64; 6]); 13] = [
    (
        'v',
        "velocity Verlet",
        [541.0, 1081.0, 4201.0, 11_821.0, 0.0, 0.0],
    ),
    (
        'p',
        "PEFRL",
        [1440.0, 1440.0, 1440.0, 2880.0, 4080.0, 15_840.0],
    ),
    (
        'x',
        "DOP853",
        [2605.0, 2605.0, 3637.0, 5461.0, 6589.0, 11_197.0],
    ),
    (
        'r',
        "classical RK4",
        [1680.0, 1680.0, 6000.0, 12_000.0, 17_040.0, 47_760.0],
    ),
    (
        's',
        "symplectic Euler",
        [540.0, 2100.0, 16_740.0, 0.0, 0.0, 0.0],
    ),
    ('t', "Heun", [7080.0, 7080.0, 14_040.0, 55_800.0, 0.0, 0.0]),
    (
        'a',
        "Dormand-Prince 5(4)",
        [4105.0, 4105.0, 5083.0, 7789.0, 11_905.0, 29_341.0],
    ),
    (
        'e',
        "explicit Euler",
        [90_000.0, 200_000.0, 0.0, 0.0, 0.0, 0.0],
    ),
    (
        'm',
        "explicit midpoint",
        [6800.0, 7000.0, 13_000.0, 50_000.0, 0.0, 0.0],
    ),
    (
        'f',
        "Fehlberg 4(5)",
        [5000.0, 5300.0, 7000.0, 11_000.0, 18_000.0, 60_000.0],
    ),
    (
        'i',
        "implicit Euler",
        [3000.0, 9000.0, 80_000.0, 0.0, 0.0, 0.0],
    ),
    (
        'b',
        "TR-BDF2",
        [2500.0, 4200.0, 12_000.0, 39_000.0, 0.0, 0.0],
    ),
    (
        'n',
        "implicit midpoint",
        [3600.0, 5200.0, 16_000.0, 48_000.0, 0.0, 0.0],
    ),
];

fn curves(n: usize, slower: f64) -> Vec<precision::Curve> {
    let errors = [3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8];
    let run = |error, work, lost| precision::Run {
        error,
        work,
        lost,
        label: Some(format!("{:.3} ms", 2000.0 / work)),
    };
    let curve = |&(letter, name, works): &(char, &str, [f64; 6])| {
        let reached = errors
            .into_iter()
            .zip(works)
            .filter(|(_, work)| *work > 0.0);
        let mut wobble = 1.0;
        let mut runs: Vec<_> = reached
            .map(|(error, work)| {
                wobble *= 0.93;
                run(error * wobble, work * slower / wobble, false)
            })
            .collect();
        let lost = works[0] * slower * 0.6;
        runs.extend([lost, lost / 2.0].map(|work| run(f64::NAN, work, true)));
        precision::Curve {
            letter,
            name: name.to_owned(),
            runs,
        }
    };
    METHODS[..n].iter().map(curve).collect()
}

fn precision_chart(methods: usize, panels: usize) -> precision::Chart {
    let scenes = [
        "cloth 20 x 20, stiff",
        "elastic pendulum",
        "chain of 4",
        "course's cloth",
        "cloth with drag",
        "circle",
    ];
    let panel = |(k, title): (usize, &&str)| precision::Panel {
        title: (*title).to_owned(),
        curves: curves(methods, 1.0 + 0.7 * k as f64),
        floor: [Some(8e-10), Some(3e-8), None][k % 3],
    };
    precision::Chart {
        title: "Speed against accuracy".to_owned(),
        subtitle: "One second of each scene; every point is a whole run at one step or tolerance. <made-up & only a test>".to_owned(),
        x_label: "largest RMS position error over the run (m)".to_owned(),
        y_label: "force evaluations".to_owned(),
        panels: scenes[..panels].iter().enumerate().map(panel).collect(),
        foot: "Reference: DOP853 at two tolerances and PEFRL with its step halved; the floor is their largest disagreement.".to_owned(),
    }
}

type Radius = fn(f64, f64) -> f64;

/// |z + ... + z^n / n!|
fn taylor(order: i32, x: f64, y: f64) -> f64 {
    let (mut sum, mut term) = ([1.0, 0.0], [1.0, 0.0]);
    for k in 1..=order {
        let k = f64::from(k);
        term = [
            (term[0] * x - term[1] * y) / k,
            (term[0] * y + term[1] * x) / k,
        ];
        sum = [sum[0] + term[0], sum[1] + term[1]];
    }
    sum[0].hypot(sum[1])
}

fn region_chart(n: usize) -> regions::Chart {
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
    let panel = |k: usize| {
        let (letter, name, radius, step) = methods[k % 5];
        // A damped cloth: frequencies up to 500 rad/s, decay like frequency squared.
        let eigenvalues = (1..=40).flat_map(|k| {
            let omega = 12.5 * f64::from(k);
            let [re, im] = [-0.0006 * omega * omega, omega];
            [[re, im], [re, -im]].map(|z| z.map(|part| part * step * 1e-3))
        });
        let far = (letter == 'i').then_some([-50.0, 0.0]);
        regions::Panel {
            letter,
            title: format!("{name}, h\u{a0}=\u{a0}{step}\u{a0}ms"),
            subtitle: format!(
                "largest stable step: predicted\u{a0}{:.2}\u{a0}ms, observed\u{a0}{:.1}\u{a0}ms",
                step * 1.042,
                step * 1.06
            ),
            radius: Box::new(radii[radius]),
            eigenvalues: eigenvalues.chain(far).collect(),
        }
    };
    regions::Chart {
        title: "Where each method is stable".to_owned(),
        subtitle: "Eigenvalues of the default cloth hanging at rest, times the step".to_owned(),
        panels: (0..n).map(panel).collect(),
    }
}

fn check(name: &str, chart: &dyn Fn(f64, f64) -> Result<Figure, String>) {
    for [w, h] in SIZES {
        let figure = chart(w, h).unwrap();
        assert!(
            figure.is_sound(),
            "{name} at {w} x {h}: texts overlap, or leave the sheet"
        );
        let svg = figure.svg();
        let tree = roxmltree::Document::parse(&svg).unwrap();
        assert!(tree.descendants().any(|node| node.has_tag_name("text")));
        assert!(
            !svg.contains("NaN") && !svg.contains("inf"),
            "{name} at {w} x {h}"
        );
        if let Some(folder) = std::env::var_os("A3_KEEP_CHARTS") {
            let path = std::path::Path::new(&folder).join(format!("{name}-{w}x{h}"));
            std::fs::write(path.with_extension("svg"), &svg).unwrap();
            let scale = if w < 1000.0 { 2.0 } else { 1.0 };
            let Ok(bytes) = png(&svg, scale) else {
                panic!("no PNG of {name}")
            };
            std::fs::write(path.with_extension("png"), bytes).unwrap();
        }
    }
}

#[test]
fn no_text_of_a_precision_chart_covers_another() {
    for methods in [1, 4, 13] {
        for panels in [1, 2, 6] {
            let chart = precision_chart(methods, panels);
            check(&format!("precision-{methods}-{panels}"), &|w, h| {
                chart.draw(w, h)
            });
        }
    }
}

#[test]
fn long_names_are_cut_and_change_nothing_else() {
    let long = "name".repeat(60);
    let mut chart = precision_chart(13, 2);
    for text in [
        &mut chart.title,
        &mut chart.subtitle,
        &mut chart.x_label,
        &mut chart.y_label,
    ] {
        text.clone_from(&long);
    }
    for panel in &mut chart.panels {
        panel.title.clone_from(&long);
        for curve in &mut panel.curves {
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
fn eigenvalues_outside_the_region_are_crosses() {
    let chart = |radius: Radius, eigenvalues| regions::Chart {
        title: String::new(),
        subtitle: String::new(),
        panels: vec![regions::Panel {
            letter: 'e',
            title: String::new(),
            subtitle: String::new(),
            radius: Box::new(radius),
            eigenvalues,
        }],
    };
    let crosses = |radius, eigenvalues| {
        let figure = chart(radius, eigenvalues).draw(800.0, 600.0).unwrap();
        // Two lines each, and those of the legend.
        figure.svg().matches("#d0021b").count() / 2 - 1
    };
    let z = || {
        vec![
            [-1.0, 0.9],
            [-1.0, 1.1],
            [0.1, 0.0],
            [f64::NAN, 0.0],
            [2.5, 0.0],
        ]
    };
    assert_eq!(crosses(|x, y| taylor(1, x, y), z()), 3);
    assert_eq!(crosses(|x, y| 1.0 / (1.0 - x).hypot(y), z()), 1);
    assert_eq!(crosses(|_, _| f64::NAN, z()), 4);
}

#[test]
fn a_sheet_too_small_is_refused_with_one_that_is_not() {
    let why = precision_chart(13, 6).draw(200.0, 100.0).unwrap_err();
    let enough = why
        .split("; ")
        .nth(1)
        .unwrap()
        .split(' ')
        .filter_map(|word| word.parse().ok());
    let [w, h] = enough.collect::<Vec<f64>>().try_into().unwrap();
    assert!(precision_chart(13, 6).draw(w, h).is_ok(), "{why}");
    assert!(precision_chart(1, 1).draw(f64::NAN, 100.0).is_err());
    assert!(
        precision::Chart {
            panels: vec![],
            ..precision_chart(1, 1)
        }
        .draw(800.0, 600.0)
        .is_err()
    );
}

#[test]
fn the_front_is_what_nothing_beats() {
    let run = |error, work, lost| precision::Run {
        error,
        work,
        lost,
        label: None,
    };
    let curve = |letter, runs| precision::Curve {
        letter,
        name: String::new(),
        runs,
    };
    let panel = precision::Panel {
        title: String::new(),
        // The fourth of a is below ten times the floor, its last was lost.
        curves: vec![
            curve(
                'a',
                vec![
                    run(1e-2, 10.0, false),
                    run(1e-3, 40.0, false),
                    run(1e-4, 500.0, false),
                    run(1e-9, 600.0, false),
                    run(1e-5, 1.0, true),
                ],
            ),
            curve(
                'b',
                vec![
                    run(2e-2, 11.0, false),
                    run(1e-3, 30.0, false),
                    run(1e-5, 400.0, false),
                    run(f64::NAN, 1.0, false),
                ],
            ),
        ],
        floor: Some(1e-9),
    };
    assert_eq!(panel.front(), [[1, 2], [1, 1], [0, 0]]);
}

#[test]
fn ticks_are_round_and_apart() {
    let linear = Axis::linear([-3.3, 1.2]).between(0.0, 300.0);
    let labels: Vec<_> = linear
        .ticks(40.0)
        .into_iter()
        .map(|tick| tick.label)
        .collect();
    assert_eq!(labels, ["−3", "−2", "−1", "0", "1"]);
    let log = Axis::log(3e-4, 0.7).between(0.0, 400.0);
    let ticks = log.ticks(40.0);
    let labels: Vec<_> = ticks
        .iter()
        .filter(|tick| !tick.label.is_empty())
        .map(|tick| &*tick.label)
        .collect();
    assert_eq!(labels, ["10^{−3}", "10^{−2}", "10^{−1}", "10^{0}"]);
    assert!(ticks.len() > 25, "no minor ticks");
    assert!((log.at(1e-2) - f64::midpoint(log.at(1e-3), log.at(1e-1))).abs() < 1e-9);
    // The ends of what numbers can be.
    let all = Axis::log(0.0, f64::MAX).between(0.0, 200.0);
    assert!(
        all.ticks(40.0)
            .iter()
            .all(|tick| all.at(tick.value).is_finite())
    );
    // Many decades in little room: fewer numbers.
    let long = Axis::log(1e-12, 1.0).between(0.0, 200.0);
    let labels = long
        .ticks(40.0)
        .into_iter()
        .filter(|tick| !tick.label.is_empty())
        .count();
    assert!((3..=5).contains(&labels), "{labels}");
}

#[test]
fn the_sheet_sees_texts_that_overlap() {
    let mut figure = Figure::new([100.0, 50.0]);
    figure.text([10.0, 20.0], Text::new("first", 10.0));
    assert!(figure.is_sound());
    figure.text([25.0, 25.0], Text::new("second", 10.0));
    assert!(!figure.is_sound());
    let mut figure = Figure::new([100.0, 50.0]);
    figure.text([80.0, 20.0], Text::new("too long", 10.0));
    assert!(!figure.is_sound());
}

#[test]
fn texts_are_measured_as_they_are_drawn() {
    let mut figure = Figure::new([400.0, 100.0]);
    let room = figure.text([20.0, 60.0], Text::new("Wäg & <λ> 10^{−3}", 40.0));
    let svg = figure.svg();
    let Ok(bytes) = png(&svg, 1.0) else {
        panic!("no PNG")
    };
    let picture = image::load_from_memory(&bytes).unwrap().to_luma8();
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

#[test]
fn long_texts_are_wrapped_or_cut() {
    assert_eq!(
        layout::wrap("one two three", 10.0, 40.0),
        ["one two", "three"]
    );
    assert!(layout::elide("a very long name", 10.0, 40.0).ends_with('…'));
    assert_eq!(layout::elide("short", 10.0, 40.0), "short");
}

#[test]
fn panels_fill_the_sheet() {
    let wide = Rect::new(0.0, 0.0, 1200.0, 600.0);
    let columns = |n| {
        let (rooms, columns) = layout::grid(n, wide, 10.0, |[w, h]| (w / 1.2).min(h));
        assert_eq!(rooms.len(), n);
        assert!(rooms.iter().all(|room| wide.holds(*room)));
        columns
    };
    assert_eq!([1, 2, 6, 8].map(columns), [1, 2, 3, 4]);
}
