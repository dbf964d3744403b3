//! Files of the plots: a table and a picture.

use std::path::PathBuf;

use super::chart::{plotted, rows, variables};
use crate::base::failure::Failure;
use crate::files::output;
use crate::window::session::{PlotFile, Session, Variable};

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
        PlotFile::Picture => ("png", picture(session)?),
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
    use super::super::request::apply;
    use super::*;
    use crate::window::session::{Pick, PlotRequest, RunAction, compared, frames, session};

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
