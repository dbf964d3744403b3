//! A reader of command lines for tests, which trusts them to be right.

use a3_core::{Disturbances, Grid, Method, StepLimits, integrators};
use a3_files::failure::Failure;
use a3_files::setup::SceneOptions;
use a3_media::show::{Arrows, Manner, Quantity};
use a3_render::Style;

use super::opening::Opening;

/// Reads the words that follow the name of the program, as far as windows have them.
pub fn read(words: &[String]) -> Result<Opening, Failure> {
    let mut opening = Opening {
        scene: "cloth".into(),
        options: SceneOptions::default(),
        methods: vec![],
        limits: StepLimits::default(),
        no_contact: false,
        manner: Manner::default(),
        light: false,
        paused: false,
        no_settings: true,
        watch: false,
        resume: None,
        status: false,
    };
    let mut words = words.iter().map(String::as_str).peekable();
    if words.next_if_eq(&"compare").is_some() {
        while let Some(word) = words.next_if(|word| !word.starts_with("--")) {
            let (solver, step) = word
                .split_once(':')
                .map_or((word, None), |(solver, step)| (solver, Some(number(step))));
            opening.methods.push((Some(method(solver)), step));
        }
    } else {
        let solver = words.next_if(|word| !word.starts_with("--")).map(method);
        let step = words.next_if(|word| !word.starts_with("--")).map(number);
        opening.methods.push((solver, step));
    }
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap();
        let Opening {
            options: SceneOptions { grid, on },
            manner,
            limits,
            ..
        } = &mut opening;
        let Disturbances {
            wind,
            swing,
            contact,
        } = on;
        match word {
            "--scene" => opening.scene = value().into(),
            "--grid" => {
                let (rows, cols) = value().split_once('x').unwrap();
                let grid_of = Grid::new(rows.parse().unwrap(), cols.parse().unwrap());
                *grid = Some(grid_of.map_err(Failure::usage)?);
            }
            "--colour" => {
                let name = value();
                manner.colour = Quantity::ALL.into_iter().find(|it| it.name() == name);
            }
            "--arrows" => {
                let name = value();
                manner.arrows = Arrows::ALL.into_iter().find(|it| it.name() == name);
            }
            "--springs-of" => manner.springs_of = value().parse().ok(),
            "--absolute" => limits.absolute = Some(number(value())),
            "--max-step" => limits.max_step = Some(number(value())),
            "--wireframe" => manner.style = Style::Wireframe,
            "--springs" => manner.style = Style::Springs,
            "--orthographic" => manner.orthographic = true,
            "--dark" => manner.dark = true,
            "--wind" => *wind = true,
            "--swing" => *swing = true,
            "--self-collision" => *contact = true,
            "--no-self-collision" => opening.no_contact = true,
            "--paused" => opening.paused = true,
            _ => panic!("{word}: no option of a test"),
        }
    }
    Ok(opening)
}

fn method(name: &str) -> &'static Method {
    integrators::find(name).unwrap_or_else(|| panic!("{name}: no solver"))
}

fn number(text: &str) -> f64 {
    match text.split_once('/') {
        Some((above, below)) => number(above) / number(below),
        None => text.parse().unwrap(),
    }
}
