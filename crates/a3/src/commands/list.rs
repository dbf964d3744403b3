//! `a3 scenes` and `a3 solvers`: lists of the built-in scenes and of the solvers.

use a3_core::{Control, integrators};
use a3_scenes::{Description, List};

use crate::base::failure::Failure;
use crate::base::report::table;
use crate::base::terminal;
use crate::cli::Scenes;
use crate::files::setup::find;

/// Lists the scenes, or prints the file of one, its list or the schema.
pub fn scenes(options: &Scenes) -> Result<(), Failure> {
    if let Some(name) = &options.print {
        let source = find(name, "--print")?;
        if options.list {
            let scene = source.build(options.grid)?.scene;
            let text = List::of(&scene).and_then(|list| list.text());
            return terminal::send(&text.map_err(Failure::usage)?);
        }
        return terminal::send(source.text());
    }
    if options.schema {
        return terminal::send(&(Description::schema() + "\n"));
    }
    let heading = [
        "scene",
        "grid",
        " particles",
        " springs",
        " state",
        "forces",
        "what it is",
    ];
    let mut rows = vec![heading.map(String::from).to_vec()];
    for entry in a3_scenes::SCENES {
        let scene = entry.build(None).map_err(Failure::run)?.scene;
        let network = scene.model.network();
        rows.push(vec![
            entry.name.into(),
            scene.grid().map_or("-".into(), |grid| {
                format!("{}x{}", grid.rows(), grid.cols())
            }),
            scene.model.particles().to_string(),
            network.map_or(0, |n| n.springs().count()).to_string(),
            scene.model.system().dim().to_string(),
            network.map_or("-".into(), |n| n.forces_in_use().join(", ")),
            entry
                .description()
                .ok()
                .and_then(|d| d.summary)
                .unwrap_or_default(),
        ]);
    }
    terminal::say(&table(&rows))
}

/// Lists the solvers.
pub fn solvers() -> Result<(), Failure> {
    let heading = [
        "",
        "solver",
        " order",
        " evaluations/step",
        " default",
        "serves",
        "method",
    ];
    let mut rows = vec![heading.map(String::from).to_vec()];
    for m in integrators::METHODS {
        rows.push(vec![
            m.letter.map(String::from).unwrap_or_default(),
            m.name.into(),
            m.order.to_string(),
            if m.is_implicit() && !m.needs_springs() {
                format!("{} and linear solves", m.evaluations)
            } else if m.damped_evaluations == m.evaluations {
                m.evaluations.to_string()
            } else {
                format!(
                    "{} ({} if springs are damped)",
                    m.evaluations, m.damped_evaluations
                )
            },
            match m.default_control {
                Control::Step(step) => format!("{step} s"),
                Control::Tolerance(tolerance) => format!("tolerance {tolerance:.0e}"),
            },
            if m.needs_springs() {
                "springs"
            } else if m.needs_mechanics() {
                "masses"
            } else {
                "any system"
            }
            .into(),
            m.title.into(),
        ]);
    }
    terminal::say(&table(&rows))
}
