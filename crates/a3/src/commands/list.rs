//! `a3 scenes`: the built-in scenes.

use a3_files::failure::Failure;
use a3_files::report::table;
use a3_files::setup::find;
use a3_files::terminal;
use a3_scenes::{Description, List};

use crate::cli::Scenes;

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
