//! A work-precision diagram on the screen, and the values of the run under the pointer.

use a3_plot::{Figure, WorkPrecision};
use egui::{CursorIcon, Id, Pos2, Rect, Sense, Stroke, Ui};

use super::super::charts::{GROUND, Sheet, colour};
use super::super::style::{FAINT, TEXT};
use super::super::words::digits;
use crate::session::{Diagram, MeasureRequest, MethodSetting};

/// Smallest and largest size of text (points), and the width of a sheet over it between them.
const SIZE: (f64, f64, f64) = (9.0, 12.0, 42.0);
/// Largest distance of the pointer from the point that it shows (points).
const POINT_REACH: f64 = 12.0;
/// Largest distance of the pointer from the curve that it shows (points).
const CURVE_REACH: f64 = 7.0;

/// Draws a diagram with its legend in a room. Runs of the panes have rings. Returns the request of
/// the mouse.
pub fn show(
    ui: &Ui,
    room: Rect,
    diagram: &Diagram,
    shown: &[MethodSetting],
) -> Option<MeasureRequest> {
    let response = ui.interact(room, Id::unique("diagram"), Sense::click());
    let painter = ui.painter();
    let sheet = [room.width(), room.height()].map(f64::from);
    let (least, most, share) = SIZE;
    let text = (sheet[0] / share).clamp(least, most);
    let figure = diagram.chart.draw_bare(sheet, text)?;
    let pointer = response.hover_pos().map(|at| (at - room.min).into());
    let pointer = pointer.map(|at: [f32; 2]| at.map(f64::from));
    let pointed = pointer.and_then(|at| run_at(&figure, at));
    let curve = pointed.map(|([curve, _], _)| curve);
    let curve = curve.or_else(|| figure.curve_at(pointer?, CURVE_REACH));
    painter.rect_filled(room, 4.0, GROUND);
    let sheet = Sheet::new(painter, room, &figure);
    sheet.draw(curve);
    for ([curve, run], at) in &figure.runs {
        let (method, control) = diagram.runs[*curve][*run];
        let is_shown = |(m, c): &MethodSetting| {
            m.name == method.name && (c.value() / control.value() - 1.0).abs() < 0.02
        };
        if shown.iter().any(is_shown) {
            painter.circle_stroke(sheet.place(*at), 8.5, Stroke::new(1.8, TEXT));
        }
    }
    let ([curve, run], at) = pointed?;
    ui.set_cursor_icon(CursorIcon::PointingHand);
    note_run(&sheet, &diagram.chart, [curve, run], sheet.place(at));
    response
        .clicked()
        .then_some(MeasureRequest::RunBeside { curve, run })
}

/// Returns the run nearest to a point within reach, and its place.
fn run_at(figure: &Figure, at: [f64; 2]) -> Option<([usize; 2], [f64; 2])> {
    let distance = |[x, y]: [f64; 2]| (x - at[0]).hypot(y - at[1]);
    let near = figure.runs.iter().copied();
    let near = near.filter(|(_, place)| distance(*place) <= POINT_REACH);
    near.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
}

/// Draws a ring around the point of a run, and writes the method, the step, the error and the cost
/// beside it.
fn note_run(sheet: &Sheet, chart: &WorkPrecision, [curve, run]: [usize; 2], at: Pos2) {
    let curve = &chart.problems[0].curves[curve];
    let run = &curve.runs[run];
    let ink = colour(curve.style.colour);
    sheet.painter.circle_stroke(at, 8.0, Stroke::new(1.5, ink));
    let error = if run.is_lost() {
        "it blew up".into()
    } else {
        // The unit is between the last brackets of the label.
        let unit = chart.x_label.rsplit_once('(').map_or("", |(_, unit)| unit);
        format!("error {} {}", digits(run.error), unit.trim_end_matches(')'))
    };
    let is_timed = chart.y_label.starts_with("computing");
    let cost = if is_timed {
        format!("{} ms per simulated second", digits(1e3 * run.work))
    } else {
        format!("{} evaluations per simulated second", digits(run.work))
    };
    let setting = run.label.clone().unwrap_or_default();
    let lines = [
        (curve.name.clone(), 13.0, TEXT),
        (setting, 12.5, TEXT),
        (error, 12.5, TEXT),
        (cost, 12.5, TEXT),
        ("click: run it beside".into(), 11.5, FAINT),
    ];
    sheet.note(at, ink, lines.into());
}

#[cfg(test)]
mod tests {
    use a3_plot::{Curve, CurveStyle, Measurement, Problem};

    use super::*;

    /// Returns two curves: one of two runs, a decade apart in error and two in work; the other of
    /// one run, and one that blew up.
    fn chart() -> WorkPrecision {
        let run = |error, work, lost| Measurement {
            error,
            work,
            lost,
            ..Measurement::default()
        };
        let curve = |runs| Curve {
            style: CurveStyle::default(),
            name: "name".into(),
            runs,
        };
        WorkPrecision {
            problems: vec![Problem {
                curves: vec![
                    curve(vec![run(1e-2, 1e3, false), run(1e-3, 1e5, false)]),
                    curve(vec![run(1e-1, 1e5, false), run(f64::INFINITY, 1e4, true)]),
                ],
                ..Problem::default()
            }],
            ..WorkPrecision::default()
        }
    }

    #[test]
    fn points_are_where_their_errors_and_their_work_are() {
        let figure = chart().draw_bare([500.0, 400.0], 12.0).unwrap();
        let (area, _) = figure.panels[0];
        let (indices, at): (Vec<_>, Vec<_>) = figure.runs.iter().copied().unzip();
        assert_eq!(indices, [[0, 0], [0, 1], [1, 0], [1, 1]]);
        // Equal factors are equal distances; accurate runs are on the left, fast ones below.
        let decade = at[2][0] - at[0][0];
        assert!(decade > 50.0 && (at[0][0] - at[1][0] - decade).abs() < 1e-3);
        assert!(at[0][1] > at[1][1] && (at[1][1] - at[2][1]).abs() < 1e-3);
        let middle = f64::midpoint(at[0][1], at[1][1]);
        assert!(at[3][0] > area.x1 && (at[3][1] - middle).abs() < 1e-3);
        assert!(chart().draw_bare([90.0, 90.0], 12.0).is_none());
        let nothing = WorkPrecision::default();
        assert!(nothing.draw_bare([500.0, 400.0], 12.0).is_none());
    }

    #[test]
    fn the_nearest_point_and_curve_are_under_the_pointer() {
        let figure = chart().draw_bare([500.0, 400.0], 12.0).unwrap();
        for (run, [x, y]) in figure.runs.iter().copied() {
            for [dx, dy] in [[0.0, 0.0], [8.0, 0.0], [-5.0, 8.0]] {
                let found = run_at(&figure, [x + dx, y + dy]);
                assert_eq!(found, Some((run, [x, y])));
            }
            assert_eq!(run_at(&figure, [x, y - 13.0]), None);
        }
        // On the line, and beside it.
        let [a, b] = [0, 1].map(|k| figure.runs[k].1);
        let way = egui::vec2((b[0] - a[0]) as f32, (b[1] - a[1]) as f32);
        for (distance, found) in [(0.0, true), (6.0, true), (-6.0, true), (9.0, false)] {
            let across = distance * way.rot90().normalized() + 0.5 * way;
            let at = [a[0] + f64::from(across.x), a[1] + f64::from(across.y)];
            assert_eq!(run_at(&figure, at), None);
            assert_eq!(figure.curve_at(at, CURVE_REACH), found.then_some(0));
        }
        // The name in the legend.
        let name = figure.parts[0].0.end - 1;
        let a3_plot::Shape::Text(at, ..) = figure.shapes[name] else {
            panic!("{:?}", figure.shapes);
        };
        assert_eq!(figure.curve_at(at, CURVE_REACH), Some(0));
    }
}
