//! What is plotted, as a chart, and in files: a table and a picture.

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use a3_files::failure::Failure;
use a3_files::output;
use a3_plot::{CurveStyle, Line, LineChart, LinePanel, Marker};

use super::super::words::{self, signed};
use crate::session::plotting::{self, kinds};
use crate::session::{IS_PAGE, Mode, Pane, Pick, PlotFile, Quantity, Row, Session};
use crate::session::{Trigger, Variable};

/// Colours of picks or, in a comparison, of panes, that every kind of colour vision tells apart
/// (Okabe and Ito, Tol).
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#332288", "#cc79a7", "#000000"];
/// Dashes of picks in a comparison, in widths of the line.
const DASHES: [&[f64]; 6] = [
    &[],
    &[5.0, 2.5],
    &[1.5, 1.8],
    &[7.0, 2.0, 1.5, 2.0],
    &[3.0, 3.0],
    &[9.0, 2.0, 1.5, 2.0, 1.5, 2.0],
];

/// What is on the axes of a panel; `None` for time.
pub type Axes = [Option<Quantity>; 2];

/// A chart, with where its curves come from.
pub struct Plotted {
    pub chart: LineChart,
    /// What is on the axes of each panel.
    pub axes: Vec<Axes>,
    /// The pane and the pick of each curve of each panel.
    pub sources: Vec<Vec<[usize; 2]>>,
}

/// Returns the style of a pick in a pane.
pub fn style(session: &Session, [pane, pick]: [usize; 2]) -> CurveStyle {
    let is_alone = session.runs.panes.len() == 1;
    let of = |k: usize| k % COLOURS.len();
    CurveStyle {
        colour: COLOURS[of(if is_alone { pick } else { pane })],
        dash: if is_alone { &[] } else { DASHES[of(pick)] },
        marker: Marker::Polygon(8, 0.0),
    }
}

/// Returns the name of the run of a pane: its method and its step or tolerance.
pub fn run_name(pane: &Pane) -> String {
    let run = &pane.simulation;
    format!("{} {}", run.method().name, run.control().value())
}

/// Returns whether anything that is plotted has a variable.
pub fn has(session: &Session, variable: Variable) -> bool {
    let kinds = kinds(&session.runs.panes);
    kinds.into_iter().any(|kind| variable.is_of(kind))
}

/// Returns the quantities on the axes of each panel.
fn axes(session: &Session) -> Vec<Axes> {
    let settings = &session.panel.plotting;
    if settings.mode != Mode::Time {
        return vec![plotting::axes(settings, &session.runs.panes).map(Some)];
    }
    let shown = Variable::all().filter(|it| settings.shown.contains(it) && has(session, *it));
    shown.map(|variable| [None, Some(Quantity::of_each(variable))]).collect()
}

/// Returns the time (s) at the end of the plots: the latest of any pane.
fn latest(session: &Session) -> f64 {
    let panes = session.runs.panes.iter();
    let series = panes.flat_map(|pane| pane.traces.iter());
    let last = series.filter_map(|(_, series)| series.rows().next_back());
    last.map(|row| row.time).fold(0.0, f64::max)
}

/// Returns the rows of a pick in a pane that are shown: those of the section, or of the last
/// seconds.
pub fn rows(session: &Session, [pane, pick]: [usize; 2]) -> Vec<&Row> {
    let settings = &session.panel.plotting;
    let from = latest(session) - settings.span;
    let Some((_, series)) = session.runs.panes[pane].traces.iter().nth(pick) else {
        return vec![];
    };
    match settings.mode {
        Mode::Section => series.section().collect(),
        _ => series.rows().filter(|row| row.time >= from).collect(),
    }
}

/// Returns the value of a quantity at a row of a pick in a pane; NaN if it is not known. In a
/// section, where it does not matter how often a thing has turned, an angle is within half a turn.
pub fn value(session: &Session, quantity: Quantity, source: [usize; 2], row: &Row) -> f64 {
    let value = value_at(session, quantity, source, row);
    if session.panel.plotting.mode == Mode::Section && quantity.variable == Variable::Angle {
        value - TAU * ((value - PI) / TAU).ceil()
    } else {
        value
    }
}

/// Returns the same, with angles that go on past a whole turn.
fn value_at(session: &Session, quantity: Quantity, [pane, pick]: [usize; 2], row: &Row) -> f64 {
    let mut traces = session.runs.panes[pane].traces.iter();
    let own = traces.as_slice().get(pick).map(|(own, _)| *own);
    let Some(of) = quantity.of.filter(|of| Some(*of) != own) else {
        let has = own.is_some_and(|own| quantity.variable.is_of(own.kind()));
        return if has { quantity.variable.of(row) } else { f64::NAN };
    };
    let series = traces.find(|(other, _)| *other == of);
    let row = series.and_then(|(_, series)| series.at(row.time));
    row.map_or(f64::NAN, |row| quantity.variable.of(&row))
}

/// Returns the place of a row of a pick in a pane, in a panel with some axes.
pub fn place(session: &Session, axes: Axes, source: [usize; 2], row: &Row) -> [f64; 2] {
    axes.map(|axis| axis.map_or(row.time, |it| value(session, it, source, row)))
}

/// Returns the picks with curves in a panel with some axes: those that have all variables which are
/// of each, or, if there is none, the thing across.
fn picks_of(axes: Axes, picks: &[Pick]) -> Vec<usize> {
    let all = 0..picks.len();
    let of_each = axes.into_iter().flatten().filter(|it| it.of.is_none());
    let of_each: Vec<_> = of_each.map(|it| it.variable).collect();
    if of_each.is_empty() {
        let across = axes[0].and_then(|it| it.of);
        return all.filter(|k| Some(picks[*k]) == across).collect();
    }
    let has = |k: &usize| of_each.iter().all(|it| it.is_of(picks[*k].kind()));
    all.filter(has).collect()
}

/// Returns the chart of all picks, with about `detail` points on a curve.
pub fn plotted(session: &Session, detail: usize) -> Plotted {
    let (settings, panes) = (&session.panel.plotting, &session.runs.panes);
    let all_axes = axes(session);
    let picks: Vec<Pick> = panes[0].traces.iter().map(|(pick, _)| *pick).collect();
    let sources = all_axes.iter().map(|axes| {
        let own = picks_of(*axes, &picks);
        let of_pane = |pane| own.iter().map(move |pick| [pane, *pick]);
        (0..panes.len()).flat_map(of_pane).collect::<Vec<_>>()
    });
    let sources: Vec<_> = sources.collect();
    let to = latest(session).max(settings.span);
    let label = |axis: Option<Quantity>| axis.map_or("time (s)".into(), Quantity::label);
    let panels = all_axes.iter().zip(&sources).map(|(axes, sources)| {
        let line = |source: &[usize; 2]| Line {
            name: name(session, *axes, *source, &picks),
            style: style(session, *source),
            pieces: pieces(session, *axes, *source, detail),
            dots: settings.mode == Mode::Section,
        };
        LinePanel {
            x_label: label(axes[0]),
            y_label: label(axes[1]),
            ends: (settings.mode == Mode::Time).then_some([to - settings.span, to]),
            lines: sources.iter().map(line).collect(),
        }
    });
    let first = &panes[0].simulation;
    let chart = LineChart {
        title: first.scene().name.clone(),
        subtitle: match panes.len() {
            1 => words::method(first),
            _ => String::new(),
        },
        panels: panels.collect(),
        foot: foot(session),
    };
    Plotted { chart, axes: all_axes, sources }
}

/// Returns the name of a curve.
fn name(session: &Session, axes: Axes, [pane, pick]: [usize; 2], picks: &[Pick]) -> String {
    let panes = &session.runs.panes;
    let what = match axes.map(|axis| axis.and_then(|it| it.of)) {
        [Some(across), Some(up)] if across != up => {
            format!("{} over {}", up.name(), across.name())
        }
        _ => picks[pick].name(),
    };
    match (panes.len(), picks.len()) {
        (1, _) => what,
        (_, 1) => run_name(&panes[pane]),
        _ => format!("{}: {what}", run_name(&panes[pane])),
    }
}

/// Returns what the chart shows, in a line below it.
fn foot(session: &Session) -> String {
    let picks = session.runs.panes[0].traces.iter();
    let names: Vec<_> = picks.map(|(pick, _)| pick.name()).collect();
    let what = names.join(", ");
    match session.panel.plotting.mode {
        Mode::Section => format!("{what}, {}", when(session)),
        _ => what,
    }
}

/// Says when points of the section are taken.
fn when(session: &Session) -> String {
    match session.runs.panes[0].traces.trigger {
        Trigger::Off => String::new(),
        Trigger::Period(period) => format!("once in {} s", signed(period)),
        Trigger::Rises(variable, value) => {
            let [name, unit] = [variable.name(), variable.unit()];
            format!("whenever {name} rises through {} {unit}", signed(value))
        }
    }
}

/// Returns the points of a curve, with a gap where a value is not known. Of many points, those are
/// left out that could not be told apart: in each of `detail` parts of the time, the lowest and the
/// highest stay, or in a phase plane the first four.
fn pieces(session: &Session, axes: Axes, source: [usize; 2], detail: usize) -> Vec<Vec<[f64; 2]>> {
    let settings = &session.panel.plotting;
    let width = settings.span / detail as f64;
    let mut pieces = vec![vec![]];
    let rows = rows(session, source);
    let places = rows.iter();
    let places = places.map(|row| (row.time, place(session, axes, source, row)));
    let places: Vec<_> = places.collect();
    let part = |time: f64| match settings.mode {
        Mode::Section => time,
        Mode::Time => (time / width).floor(),
        Mode::Phase => (4.0 * time / width).floor(),
    };
    for near in places.chunk_by(|a, b| part(a.0) == part(b.0)) {
        let by_height = |a: &&(f64, [f64; 2]), b: &&(f64, [f64; 2])| a.1[1].total_cmp(&b.1[1]);
        let lowest = near.iter().min_by(by_height);
        let highest = near.iter().max_by(by_height);
        let mut ends = match settings.mode {
            Mode::Time => [lowest, highest],
            _ => [near.first(), None],
        };
        if let [Some(low), Some(high)] = ends {
            if low.0 > high.0 {
                ends.swap(0, 1);
            } else if low.0 == high.0 {
                ends[1] = None;
            }
        }
        for (_, point) in ends.into_iter().flatten() {
            if point.iter().all(|part| part.is_finite()) {
                pieces.last_mut().into_iter().for_each(|it| it.push(*point));
            } else if pieces.last().is_some_and(|it| !it.is_empty()) {
                pieces.push(vec![]);
            }
        }
    }
    pieces
}

/// Width of a picture, height of a panel, and height of all else (units of a sheet).
const SIZES: [f64; 3] = [960.0, 230.0, 170.0];
/// Number of pixels for each unit.
const SCALE: f64 = 2.0;
/// Number of parts of the time in which a picture has a point.
const DETAIL: usize = 2000;

/// Writes the table and the picture under the first free names, and says so. Fails if nothing is
/// plotted, or if a file cannot be written.
pub fn write(session: &Session) -> Result<String, Failure> {
    let [table, picture] = [PlotFile::Table, PlotFile::Picture].map(|it| write_one(session, it));
    let (table, picture) = (table?, picture?);
    Ok(format!("Wrote {} and {}.", table.display(), picture.display()))
}

/// Writes one file under the first free name, and returns its path. Fails as [`write`] does.
pub fn write_one(session: &Session, file: PlotFile) -> Result<PathBuf, Failure> {
    if session.runs.panes[0].traces.is_empty() {
        return Err(Failure::usage(
            "nothing is plotted: double click on a particle, a body, a spring or a rod",
        ));
    }
    let (ending, bytes) = match file {
        PlotFile::Table => ("csv", table(session).map_err(Failure::run)?),
        PlotFile::Picture => (if IS_PAGE { "svg" } else { "png" }, picture(session)?),
    };
    let scene = &session.runs.first().scene().name;
    output::write_new("".as_ref(), scene, ending, &bytes)
}

/// Returns the picture.
fn picture(session: &Session) -> Result<Vec<u8>, Failure> {
    let chart = plotted(session, DETAIL).chart;
    let [width, panel, rest] = SIZES;
    let height = match chart.panels.len() {
        1 => 3.0 * panel,
        count => count as f64 * panel,
    };
    let figure = chart.draw(width, height + rest).map_err(Failure::run)?;
    if IS_PAGE {
        return Ok(figure.svg().into_bytes());
    }
    figure.png(SCALE).map_err(Failure::run)
}

/// Returns the plotted curves as a table in CSV: a row for each point, with the values of the
/// quantities on the axes.
fn table(session: &Session) -> Result<Vec<u8>, csv::Error> {
    let all_axes = axes(session);
    let traces = session.runs.panes[0].traces.iter();
    let picks: Vec<Pick> = traces.map(|(pick, _)| *pick).collect();
    let is_shown = |n: usize| all_axes.iter().any(|it| picks_of(*it, &picks).contains(&n));
    let mut columns: Vec<Quantity> = vec![];
    for quantity in all_axes.iter().copied().flatten().flatten() {
        if !columns.contains(&quantity) {
            columns.push(quantity);
        }
    }
    let mut writer = csv::Writer::from_writer(vec![]);
    let first = ["scene", "solver", "step or tolerance", "of", "time (s)"];
    let first = first.into_iter().map(String::from);
    writer.write_record(first.chain(columns.iter().map(|it| it.label())))?;
    for (k, pane) in session.runs.panes.iter().enumerate() {
        let run = &pane.simulation;
        let control = run.control().value().to_string();
        for (n, pick) in picks.iter().enumerate().filter(|(n, _)| is_shown(*n)) {
            for row in rows(session, [k, n]) {
                let first = [
                    run.scene().name.clone(),
                    run.method().name.into(),
                    control.clone(),
                    pick.name(),
                    row.time.to_string(),
                ];
                let values = columns.iter().map(|it| {
                    let value = value(session, *it, [k, n], row);
                    let value = Some(value).filter(|value| value.is_finite());
                    value.map_or(String::new(), |value| value.to_string())
                });
                writer.write_record(first.into_iter().chain(values))?;
            }
        }
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{PlotRequest, RunAction, apply, compared, frames, session};

    fn written(session: &Session) -> String {
        String::from_utf8(table(session).unwrap()).unwrap()
    }

    #[test]
    fn a_chart_has_the_extremes_of_all_values_and_gaps_where_there_are_none() {
        let mut session = session(&["r", "0.005", "--scene", "pendulum"]);
        session.act(RunAction::Plots, 0);
        frames(&mut session, 12.0);
        let rows = session.runs.panes[0].traces.iter().as_slice()[0].1.rows();
        let y = rows.map(|row| row.values[1]);
        let extremes = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], y| [a.min(y), b.max(y)])
        };
        let right = extremes(&mut y.clone());
        let plotted = plotted(&session, 100);
        let panel = &plotted.chart.panels[1];
        assert_eq!((&*panel.x_label, &*panel.y_label), ("time (s)", "y (m)"));
        let points = || panel.lines[0].points();
        assert_eq!(extremes(&mut points().map(|point| point[1])), right);
        let count = points().count();
        assert!((100..202).contains(&count), "{count}");
        assert!(points().collect::<Vec<_>>().is_sorted_by(|a, b| a[0] < b[0]));
    }

    #[test]
    fn a_table_has_the_values_of_each_pane_with_their_units() {
        let mut session = compared(&["r:0.01", "v:0.02", "--scene", "pendulum"], 0.0);
        session.act(RunAction::Plots, 0);
        frames(&mut session, 1.0);
        apply(&mut session, PlotRequest::Toggle(Pick::Spring(0, 1)), 0);
        frames(&mut session, 1.0);
        let text = written(&session);
        let rows: Vec<Vec<_>> = text.lines().map(|line| line.split(',').collect()).collect();
        let heading = "scene,solver,step or tolerance,of,time (s),x (m),y (m),length (m),force (N)";
        assert_eq!(rows[0].join(","), heading);
        let panes = &session.runs.panes;
        let all = panes.iter().flat_map(|pane| pane.traces.iter());
        let count: usize = all.map(|(_, series)| series.rows().len()).sum();
        assert_eq!(rows.len(), count + 1);
        let run = &panes[1].simulation;
        let last = rows.last().unwrap();
        assert_eq!(last[..4], ["pendulum", "verlet", "0.02", "spring 0 to 1"]);
        assert_eq!(last[4].parse(), Ok(run.time()));
        let length = (run.position(1) - run.position(0)).norm();
        assert_eq!((last[5], last[7].parse()), ("", Ok(length)));
        let names = plotted(&session, 10).chart.panels[0]
            .lines
            .iter()
            .map(|it| it.name.clone())
            .collect::<Vec<_>>();
        assert_eq!(names, ["rk4 0.01: particle 1", "verlet 0.02: particle 1"]);
        apply(&mut session, PlotRequest::Clear, 0);
        assert_eq!(written(&session).lines().count(), 1);
        assert!(write_one(&session, PlotFile::Picture).is_err());
    }

    /// The angles of both rods of a double pendulum, one over the other, and in a table.
    #[test]
    fn quantities_of_two_things_are_on_the_axes_of_one_chart() {
        let mut session = session(&["r", "0.005", "--scene", "double-pendulum"]);
        let rods = [Pick::Rod(0, 1), Pick::Rod(1, 2)];
        let begun = [PlotRequest::Toggle(rods[0]), PlotRequest::Toggle(rods[1])];
        let axes = rods.map(|rod| Quantity { of: Some(rod), variable: Variable::Angle });
        let axes = [PlotRequest::Axis(0, axes[0]), PlotRequest::Axis(1, axes[1])];
        for request in begun.into_iter().chain([PlotRequest::Mode(Mode::Phase)]) {
            apply(&mut session, request, 0);
        }
        frames(&mut session, 0.5);
        let lines = |session: &Session| plotted(session, 1000).chart.panels[0].lines.len();
        // Each rod has its own phase plane at first.
        assert_eq!(lines(&session), 2);
        for request in axes {
            apply(&mut session, request, 0);
        }
        assert_eq!(lines(&session), 1);
        let plotted = plotted(&session, 1000);
        let panel = &plotted.chart.panels[0];
        assert_eq!(panel.x_label, "angle of rod 0 to 1 (rad)");
        assert_eq!(panel.y_label, "angle of rod 1 to 2 (rad)");
        assert_eq!(panel.lines[0].name, "rod 1 to 2 over rod 0 to 1");
        let run = session.runs.first();
        let angle = |i: usize| {
            let way = run.position(i + 1) - run.position(i);
            way.x.atan2(-way.y)
        };
        let last = panel.lines[0].points().last().copied();
        assert_eq!(last, Some([angle(0), angle(1)]));
        let text = written(&session);
        let ends = |line: Option<&str>| line.unwrap().splitn(4, ',').nth(3).unwrap().to_owned();
        let heading = "of,time (s),angle of rod 0 to 1 (rad),angle of rod 1 to 2 (rad)";
        assert_eq!(ends(text.lines().next()), heading);
        let last = format!("rod 0 to 1,{},{},{}", run.time(), angle(0), angle(1));
        assert_eq!(ends(text.lines().last()), last);
        // Without the second rod, the axis shows the first one.
        apply(&mut session, PlotRequest::Toggle(rods[1]), 0);
        let panel = &super::plotted(&session, 1000).chart.panels[0];
        assert_eq!((&*panel.y_label, panel.lines.len()), ("angle (rad)", 1));
    }

    /// The velocity goes with its coordinate also where what the vertical axis is of lacks it.
    #[test]
    fn every_chart_after_a_choice_of_a_coordinate_has_a_curve() {
        let mut session = session(&["r", "0.005", "--scene", "double-pendulum"]);
        session.act(RunAction::Plots, 0);
        let (rod, particle) = (Pick::Rod(0, 1), Pick::Particle(1));
        let of = |of, variable| Quantity { of, variable };
        for request in [PlotRequest::Toggle(rod), PlotRequest::Mode(Mode::Phase)] {
            apply(&mut session, request, 0);
        }
        frames(&mut session, 0.5);
        for (up, across) in [
            (of(Some(particle), Variable::VelocityX), Variable::Angle),
            (of(Some(rod), Variable::SpinZ), Variable::X),
        ] {
            apply(&mut session, PlotRequest::Axis(1, up), 0);
            apply(&mut session, PlotRequest::Axis(0, of(None, across)), 0);
            let plotted = plotted(&session, 10_000);
            let variables = plotted.axes[0].map(|it| it.unwrap().variable);
            assert_eq!(variables, [across, across.velocity()]);
            let lines = &plotted.chart.panels[0].lines;
            assert!(lines.iter().any(|line| line.points().count() > 50));
        }
    }

    /// The second rod of a double pendulum turns over and over.
    #[test]
    fn angles_of_sections_are_within_half_a_turn() {
        let mut session = session(&["r", "0.002", "--scene", "double-pendulum"]);
        let rod = Pick::Rod(1, 2);
        for request in [
            PlotRequest::Toggle(rod),
            PlotRequest::Mode(Mode::Section),
            PlotRequest::Trigger(Trigger::Rises(Variable::SpinZ, 0.0)),
        ] {
            apply(&mut session, request, 0);
        }
        frames(&mut session, 40.0);
        let rows = rows(&session, [0, 0]);
        let whole = |row: &&Row| Variable::Angle.of(row);
        assert!(rows.iter().map(whole).any(|angle| angle.abs() > PI));
        let across = Quantity::of_each(Variable::Angle);
        for row in &rows {
            let angle = value(&session, across, [0, 0], row);
            let turns = (whole(row) - angle) / TAU;
            assert!(-PI < angle && angle <= PI && (turns - turns.round()).abs() < 1e-9);
        }
    }

    /// The strain of a spring over the height of a particle: what nothing has both of.
    #[test]
    fn an_axis_that_nothing_else_has_is_of_the_first_thing_that_has_it() {
        let mut session = session(&["r", "0.005", "--scene", "pendulum"]);
        session.act(RunAction::Plots, 0);
        let across = Quantity::of_each(Variable::Y);
        let up = Quantity::of_each(Variable::Elastic);
        for request in [
            PlotRequest::Toggle(Pick::Spring(0, 1)),
            PlotRequest::Mode(Mode::Phase),
            PlotRequest::Axis(0, across),
            PlotRequest::Axis(1, Quantity::of_each(Variable::Strain)),
        ] {
            apply(&mut session, request, 0);
        }
        frames(&mut session, 1.0);
        let panel = &plotted(&session, 100).chart.panels[0];
        assert_eq!(panel.y_label, "strain of spring 0 to 1");
        let run = session.runs.first();
        let last = panel.lines[0].points().last().copied().unwrap();
        assert_eq!(last, [run.position(1).y, run.position(1).norm() - 1.0]);
        apply(&mut session, PlotRequest::Axis(1, up), 0);
        let panel = &plotted(&session, 100).chart.panels[0];
        assert_eq!((&*panel.y_label, panel.lines.len()), ("elastic energy (J)", 1));
    }
}
