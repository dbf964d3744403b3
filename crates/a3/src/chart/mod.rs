//! `a3 chart`: speed against accuracy, measured on the user's own scene.

pub mod data;
mod each;
pub mod measure;
pub mod picture;
pub mod record;
pub mod single;
pub mod style;
pub mod table;
pub mod text;
mod vision;

use std::path::Path;

use a3_core::accuracy::{Horizon, Metric, Scope, horizon};
use a3_core::{Method, Scene, integrators};
use a3_plot::Figure;

use crate::cli::{Chart, ErrorMeasure, ErrorScope, What, WorkMeasure};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{interrupt, output, setup};
use data::Data;
use each::Each;
use measure::{Measured, Study, stiffened};

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Chart) -> Result<(), Failure> {
    interrupt::listen();
    let scene = setup::scene(&options.what)?;
    let methods = methods(&scene, &options.solvers)?;
    let path = match &options.output {
        Some(path) => path.clone(),
        None => format!("a3-chart-{}.svg", output::part_of_name(&scene.name)).into(),
    };
    output::check(&path, PICTURES)?;
    let metric = metric(options.error, &scene)?;
    let scope = scope(&options.scope, &scene)?;
    let timed = options.work == WorkMeasure::Time;
    let measured = Measured {
        timed,
        spread: options.spread,
    };
    let mut data = Data::open(options.data.as_deref())?;
    data.each = options.each.as_deref().map(Each::new).transpose()?;
    let mut studies = vec![];
    let mut until = options.until;
    let bar = Bar::new(1.0);
    for &factor in &options.stiffness {
        bar.say("looking ahead  ".into());
        let scene = stiffened(&scene, factor)?;
        // All panels have the shortest horizon, which is that of the stiffest scene.
        let Some(found) = look_ahead(&scene, options.until, factor, &bar)? else {
            continue;
        };
        check_motion(&scene, &found)?;
        until = Some(until.map_or(found.until, |until: f64| until.min(found.until)));
        studies.push((factor, scene, found.motion));
    }
    let until = until.ok_or_else(|| Failure::run("interrupted before anything was measured"))?;
    let what = &options.what;
    let name = what.scene.fingerprint(&scene);
    let mut studies: Vec<_> = studies
        .into_iter()
        .map(|(factor, scene, motion)| {
            let of = (metric, scope, motion);
            Study::new(scene, (&name, what), factor, until, &methods, of, measured)
        })
        .collect();
    let mut expected = 0.0;
    for study in &studies {
        expected += study.expected()?;
    }
    bar.expect(expected);
    let mut complete = true;
    for study in &mut studies {
        if !study.run(&mut data, &bar)? {
            complete = false;
            break;
        }
    }
    bar.clear();
    interrupt::write_on();
    data.save()?;
    if let Some(each) = data.each.take() {
        each.finish()?;
    }
    let studies: Vec<_> = studies
        .iter()
        .filter(|study| study.records(&data).next().is_some())
        .collect();
    if studies.is_empty() {
        return Err(Failure::Interrupted(
            "interrupted before anything was measured".into(),
        ));
    }
    output::say(&table::text(&studies, &data, &methods, metric, timed))?;
    if metric == Metric::Position {
        for advice in studies.iter().filter_map(|study| table::advice(study)) {
            output::say(&advice)?;
        }
    }
    let mut chart = picture::chart(&studies, &data, &methods, metric, timed, &options.what);
    if options.solvers.is_empty() {
        picture::keep_best(&mut chart, &methods, &scene);
    }
    let figure = chart
        .draw(f64::from(options.size.0), f64::from(options.size.1))
        .map_err(|why| {
            if complete {
                Failure::usage(why)
            } else {
                Failure::Interrupted(format!("interrupted: {why}"))
            }
        })?;
    write_picture(&path, &figure)?;
    output::say(&format!("chart: {}\n", path.display()))?;
    if complete {
        Ok(())
    } else {
        Err(Failure::Interrupted(
            "interrupted: the chart has what was measured until then".into(),
        ))
    }
}

/// Extensions of the formats of charts.
pub const PICTURES: &[&str] = &["svg", "pdf", "png"];

/// Writes a figure as SVG, PDF or PNG, by the extension of the path.
pub fn write_picture(path: &Path, figure: &Figure) -> Result<(), Failure> {
    if output::ends_in(path, "png") {
        output::write(path, &figure.png(1.0).map_err(Failure::run)?)
    } else if output::ends_in(path, "pdf") {
        output::write(path, &figure.pdf())
    } else {
        output::write(path, figure.svg().as_bytes())
    }
}

/// The methods that were asked for, or else all that can integrate the scene, as where one of those
/// asked for is none in particular.
pub fn methods(
    scene: &Scene,
    asked: &[Option<&'static Method>],
) -> Result<Vec<&'static Method>, Failure> {
    if asked.iter().all(Option::is_none) {
        let all = integrators::METHODS.iter();
        return Ok(all
            .filter(|m| m.check(scene.model.system()).is_ok())
            .collect());
    }
    let mut methods: Vec<&'static Method> = vec![];
    for &method in asked.iter().flatten() {
        method
            .check(scene.model.system())
            .map_err(|e| Failure::usage(format!("scene {}: {e}", scene.name)))?;
        if !methods.iter().any(|m| std::ptr::eq(*m, method)) {
            methods.push(method);
        }
    }
    Ok(methods)
}

/// Refuses a scene in which nothing moves.
pub fn check_motion(scene: &Scene, horizon: &Horizon) -> Result<(), Failure> {
    if horizon.motion > 0.0 {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "nothing moves in {} within {} s, so there are no errors to measure: give something a velocity or a force, or \
         ask for a longer --until",
        scene.name, horizon.until
    )))
}

/// Refuses a metric of contact whose error is 0 for a run in which nothing moves: then there is no
/// impact, or nothing within a thickness.
pub fn check_contact(metric: Metric, still: f64, until: f64) -> Result<(), Failure> {
    match metric {
        Metric::Impact if still == 0.0 => Err(Failure::usage(format!(
            "no impact begins or ends in {until} s: ask for penetration, or for a longer --until"
        ))),
        Metric::Penetration if still == 0.0 => Err(Failure::usage(format!(
            "no surfaces come nearer than their thickness in {until} s: ask for a longer --until"
        ))),
        _ => Ok(()),
    }
}

/// The metric that was asked for. Refuses one that the scene does not have.
pub fn metric(error: ErrorMeasure, scene: &Scene) -> Result<Metric, Failure> {
    let metric = match error {
        ErrorMeasure::Position => Metric::Position,
        ErrorMeasure::Energy => Metric::Energy,
        ErrorMeasure::Strain => Metric::Strain,
        ErrorMeasure::Momentum => Metric::Momentum,
        ErrorMeasure::Phase => Metric::Phase,
        ErrorMeasure::Penetration => Metric::Penetration,
        ErrorMeasure::Impact => Metric::Impact,
    };
    let of_contact = matches!(metric, Metric::Penetration | Metric::Impact);
    let network = scene.model.network();
    if of_contact && network.is_none_or(|network| network.contact_layer().is_none()) {
        return Err(Failure::usage(format!(
            "no surfaces touch in the scene {}: ask for another error, or give it self_collision = true",
            scene.name
        )));
    }
    let of_motion = matches!(metric, Metric::Position | Metric::Phase);
    if of_motion || network.is_some() {
        Ok(metric)
    } else {
        Err(Failure::usage(format!(
            "the scene {} has neither energy nor momentum nor springs: ask for position or phase",
            scene.name
        )))
    }
}

/// Where errors were asked to be taken.
pub fn scope(asked: &ErrorScope, scene: &Scene) -> Result<Scope, Failure> {
    let particles = scene.model.particles();
    match asked.particle {
        Some(i) if i >= particles => Err(Failure::usage(format!(
            "the scene {} has no particle {i}: its particles are 0 to {}",
            scene.name,
            particles.max(1) - 1
        ))),
        particle => Ok(Scope {
            particle,
            at_end: asked.at_end,
        }),
    }
}

/// Unit of a metric, in words.
pub fn unit(metric: Metric) -> &'static str {
    match metric {
        Metric::Position => "m",
        Metric::Energy => "J",
        Metric::Strain => "of length",
        Metric::Momentum => "kg m/s",
        Metric::Penetration => "of thickness",
        Metric::Phase | Metric::Impact => "s",
    }
}

/// How far the motion of a scene can be predicted, with the end of its runs: the one that was asked
/// for, or else the predicted one. Prints that time and the reason. `None` if it was interrupted.
pub fn look_ahead(
    scene: &Scene,
    asked: Option<f64>,
    stiffness: f64,
    bar: &Bar,
) -> Result<Option<Horizon>, Failure> {
    let longest = asked.unwrap_or(f64::INFINITY);
    let Some(found) = horizon(scene, longest, &interrupt::go_on).map_err(Failure::run)? else {
        return Ok(None);
    };
    let Horizon {
        until,
        lyapunov,
        buckles,
        ..
    } = found;
    let of = if stiffness == 1.0 {
        scene.name.clone()
    } else {
        format!("{} at {stiffness} times its stiffness", scene.name)
    };
    let why = if buckles {
        format!(
            "compressed springs buckle out of the plane of the motion, and errors grow e-fold every {lyapunov:.2} s"
        )
    } else if lyapunov.is_finite() {
        format!("errors grow by themselves e-fold every {lyapunov:.2} s (Lyapunov time)")
    } else {
        "small differences hardly grow by themselves".to_owned()
    };
    match asked {
        Some(asked) if asked > until * (1.0 + 1e-9) && lyapunov.is_finite() => bar.warn(&format!(
            "warning: {of}: {why}: past {until} s an error in position says little; compare \
             --error energy or strain, or leave out --until"
        )),
        Some(_) => {}
        None => bar.pause(|| output::say(&format!("{of}: {why}; runs of {until} s\n")))?,
    }
    Ok(Some(Horizon {
        until: asked.unwrap_or(until),
        ..found
    }))
}

/// The scene in words: its name, its grid, and what is switched on.
pub fn describe(what: &What, scene: &Scene) -> String {
    let grid = scene
        .grid()
        .map_or(String::new(), |g| format!(" {} × {}", g.rows(), g.cols()));
    let wind = if what.wind { ", wind" } else { "" };
    let swing = if what.swing { ", swing" } else { "" };
    let touch = if what.self_collision {
        ", self-collision"
    } else {
        ""
    };
    format!("{}{grid}{wind}{swing}{touch}", scene.name)
}
