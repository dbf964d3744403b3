//! What keys, clicks and requests do to the plots, and the files of a plot: a table and a picture.

use std::path::PathBuf;

use a3_files::failure::Failure;
use a3_files::output;
use egui::{Area, Context, Id, Rect, Sense, vec2};

use super::super::docked::Place;
use super::super::measure::chip;
use super::super::panel::{PanelKey, Request};
use super::chart::{plotted, rows, variables};
use crate::session::{
    Action, IS_PAGE, Pick, PlotFile, PlotRequest, RunAction, Session, Variable, plotting,
};

/// The place of the pane.
pub const PLACE: Place = Place {
    width: (380.0, 800.0, 0.4),
    min_width_beside: 700.0,
    share_below: 0.55,
    narrow: None,
};

/// Returns whether the plots are visible: they are open, and the help does not hide them.
pub fn is_shown(session: &Session) -> bool {
    session.panel.plotting.open && !session.readings.help
}

/// Returns the place of the plots, if they are visible.
pub fn place(session: &Session) -> Option<&'static Place> {
    is_shown(session).then_some(&PLACE)
}

/// Draws a button that plots the particle whose springs are listed, below that list, unless the
/// plots are open.
pub fn offer(ctx: &Context, session: &Session) -> Option<Request> {
    let is_free = !session.panel.plotting.open && !session.readings.help;
    let [pane] = &*session.runs.panes else {
        return None;
    };
    let i = pane.show.springs_of.filter(|_| is_free)?;
    let list = ctx.memory(|memory| memory.area_rect(Id::unique("run")))?;
    let at = list.left_bottom() + vec2(0.0, 6.0);
    let pick = Pick::at(session.runs.first(), i);
    let words = format!("plot {} (F3)", pick.name());
    let rect = Rect::from_min_size(at, vec2(14.0 + 7.5 * words.len() as f32, 26.0));
    let clicked = Area::new(Id::unique("plot it"))
        .fixed_pos(at)
        .constrain(false)
        .fade_in(false)
        .show(ctx, |ui| {
            let response = ui.allocate_rect(rect, Sense::click());
            chip(ui, rect, &response, &words, false);
            response.clicked()
        })
        .inner;
    clicked.then_some(Request::Act(Action::Run(RunAction::Plots)))
}

/// Plots the particle of a double click, or its body, or no longer, if the plots are open.
pub fn pick(session: &mut Session, particle: Option<usize>) {
    if let Some(i) = particle.filter(|_| is_shown(session)) {
        let pick = Pick::at(session.runs.first(), i);
        apply(session, PlotRequest::Toggle(pick));
    }
}

/// Removes the ruler of the former scene and, if the plots are open, plots what moves alone.
pub fn begin_scene(session: &mut Session) {
    session.panel.plotting.ruler = None;
    if session.panel.plotting.open {
        plotting::pick_first(&mut session.runs.panes);
    }
}

/// Handles a key, and returns whether the plots take it.
pub fn press(session: &mut Session, key: PanelKey) -> bool {
    let by = match key {
        PanelKey::Left => -1,
        PanelKey::Right => 1,
        _ => return false,
    };
    if !is_shown(session) {
        return false;
    }
    let next = session.panel.plotting.mode.neighbour(by);
    apply(session, PlotRequest::Mode(next));
    true
}

/// Carries out a request.
pub fn apply(session: &mut Session, request: PlotRequest) {
    let (settings, panes) = (&mut session.panel.plotting, &mut session.runs.panes);
    match request {
        PlotRequest::Close => settings.open = false,
        PlotRequest::Toggle(pick) => {
            if let Err(why) = plotting::toggle(panes, pick) {
                session.readings.say(why);
            }
        }
        PlotRequest::Mode(mode) => {
            settings.mode = mode;
            plotting::begin_section(panes, mode, settings.axes[0]);
        }
        PlotRequest::Show(variable) => {
            let before = settings.shown.len();
            settings.shown.retain(|it| *it != variable);
            if settings.shown.len() == before {
                settings.shown.push(variable);
            }
        }
        PlotRequest::Axis(axis, variable) => {
            // The velocity goes with its coordinate.
            let [across, up] = &mut settings.axes;
            if axis == 0 && *up == across.velocity() && variable.is_coordinate() {
                *up = variable.velocity();
            }
            settings.axes[axis] = variable;
        }
        PlotRequest::Trigger(trigger) => plotting::set_trigger(panes, trigger),
        PlotRequest::Span(span) => settings.span = span,
        PlotRequest::Clear => panes.iter_mut().for_each(|pane| pane.traces.forget()),
        PlotRequest::Ruler if settings.ruler.take().is_none() => {
            settings.ruler = Some(vec![]);
            session
                .readings
                .say("Drag from one point to another, or click on both.");
        }
        PlotRequest::Ruler => {}
        PlotRequest::Write(file) => {
            let said = match write_one(session, file) {
                Ok(path) => format!("Wrote {}.", path.display()),
                Err(failure) => failure.to_string(),
            };
            session.readings.say(said);
        }
    }
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
    Ok(format!(
        "Wrote {} and {}.",
        table.display(),
        picture.display()
    ))
}

/// Writes one file under the first free name, and returns its path. Fails as [`write`] does.
pub fn write_one(session: &Session, file: PlotFile) -> Result<PathBuf, Failure> {
    if session.runs.panes[0].traces.is_empty() {
        return Err(Failure::usage(
            "nothing is plotted: double click on a particle",
        ));
    }
    let (ending, bytes) = match file {
        PlotFile::Table => ("csv", table(session).map_err(Failure::run)?),
        PlotFile::Picture => (if IS_PAGE { "svg" } else { "png" }, picture(session)?),
    };
    let scene = &session.runs.first().scene().name;
    output::write_new("".as_ref(), scene, ending, &bytes)
}

/// Returns the picture: as PNG, or on a page as SVG, without the code that draws pixels.
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

/// Returns the table: a row for each value of each pick of each pane, with the variables that are
/// shown.
fn table(session: &Session) -> Result<Vec<u8>, csv::Error> {
    let mut columns: Vec<Variable> = vec![];
    for variable in variables(session).into_iter().flatten().flatten() {
        if !columns.contains(&variable) {
            columns.push(variable);
        }
    }
    let mut writer = csv::Writer::from_writer(vec![]);
    let first = ["scene", "solver", "step or tolerance", "of", "time (s)"];
    let first = first.into_iter().map(String::from);
    writer.write_record(first.chain(columns.iter().map(|it| it.label())))?;
    for (k, pane) in session.runs.panes.iter().enumerate() {
        let run = &pane.simulation;
        let control = run.control().value().to_string();
        for (n, (pick, _)) in pane.traces.iter().enumerate() {
            for row in rows(session, [k, n]) {
                let first = [
                    run.scene().name.clone(),
                    run.method().name.into(),
                    control.clone(),
                    pick.name(),
                    row.time.to_string(),
                ];
                let values = columns.iter().map(|variable| {
                    let value = Some(variable.of(row)).filter(|value| value.is_finite());
                    let value = value.filter(|_| variable.is_of(pick.kind()));
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
    use super::{apply, *};
    use crate::session::{Pick, PlotRequest, RunAction, compared, frames, session};

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
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], y| {
                [a.min(y), b.max(y)]
            })
        };
        let right = extremes(&mut y.clone());
        let plotted = plotted(&session, 100);
        let panel = &plotted.chart.panels[1];
        assert_eq!((&*panel.x_label, &*panel.y_label), ("time (s)", "y (m)"));
        let points = || panel.lines[0].points();
        assert_eq!(extremes(&mut points().map(|point| point[1])), right);
        let count = points().count();
        assert!((100..202).contains(&count), "{count}");
        assert!(
            points()
                .collect::<Vec<_>>()
                .is_sorted_by(|a, b| a[0] < b[0])
        );
    }

    #[test]
    fn a_table_has_the_values_of_each_pane_with_their_units() {
        let mut session = compared(&["r:0.01", "v:0.02", "--scene", "pendulum"], 0.0);
        session.act(RunAction::Plots, 0);
        frames(&mut session, 1.0);
        apply(&mut session, PlotRequest::Toggle(Pick::Spring(0, 1)));
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
        apply(&mut session, PlotRequest::Clear);
        assert_eq!(written(&session).lines().count(), 1);
        assert!(write_one(&session, PlotFile::Picture).is_err());
    }
}
