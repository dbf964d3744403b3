//! `a3 scenes`: the built-in scenes, and the materials.

use a3_core::Rounded;
use a3_files::failure::Failure;
use a3_files::report::{headings, table};
use a3_files::setup::find;
use a3_files::terminal;
use a3_scenes::{Description, List, MATERIALS, Stuff};

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
    if options.materials {
        return terminal::say(&materials());
    }
    let mut rows = headings("scene|grid| particles| springs| state|forces|what it is");
    for entry in a3_scenes::SCENES {
        let scene = entry.build(None).map_err(Failure::run)?.scene;
        let (network, grid) = (scene.model.network(), scene.grid());
        let summary = entry.description().ok().and_then(|it| it.summary);
        rows.push(vec![
            entry.name.into(),
            grid.map_or("-".into(), |grid| format!("{}x{}", grid.rows(), grid.cols())),
            scene.model.particles().to_string(),
            network.map_or(0, |n| n.springs().count()).to_string(),
            scene.model.system().dim().to_string(),
            network.map_or("-".into(), |n| n.forces_in_use().join(", ")),
            summary.unwrap_or_default(),
        ]);
    }
    terminal::say(&table(&rows))
}

/// Returns the tables of the materials: fabrics, and solids.
fn materials() -> String {
    let mut fabrics = headings("fabric| kg/m2| stretch N/m| shear N/m| bending N m|what it is");
    let mut solids = headings("solid| kg/m3| Young Pa| Poisson| loss|what it is");
    for material in &MATERIALS {
        let (rows, numbers) = match material.stuff {
            Stuff::Fabric { density, stretch, shear, bending } => {
                (&mut fabrics, [density, stretch, shear, bending])
            }
            Stuff::Matter { density, young, poisson, loss } => {
                (&mut solids, [density, young, poisson, loss])
            }
        };
        let numbers = numbers.iter().map(|number| Rounded(*number).to_string());
        let name = std::iter::once(material.name.to_owned());
        rows.push(name.chain(numbers).chain([material.about.into()]).collect());
    }
    format!("{}\n{}", table(&fabrics), table(&solids))
}
