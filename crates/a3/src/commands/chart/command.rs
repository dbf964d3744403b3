//! The command: measures, prints and draws.

use a3_core::accuracy::Metric;

use super::asked::{methods, metric, scope};
use super::data::Data;
use super::each::Each;
use super::files::{PICTURES, write_picture};
use super::horizon::{check_motion, look_ahead};
use super::measure::{Measured, Study, stiffened};
use super::{picture, table};
use crate::base::failure::Failure;
use crate::base::progress::Bar;
use crate::base::{interrupt, terminal};
use crate::cli::{Chart, WorkMeasure};
use crate::files::output;
use crate::files::setup::Request;

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Chart) -> Result<(), Failure> {
    interrupt::listen();
    let request = Request::read(&options.what)?;
    let scene = request.scene()?;
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
    let name = request.source.fingerprint(&scene);
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
    terminal::say(&table::text(&studies, &data, &methods, metric, timed))?;
    if metric == Metric::Position {
        for advice in studies.iter().filter_map(|study| table::advice(study)) {
            terminal::say(&advice)?;
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
    terminal::say(&format!("chart: {}\n", path.display()))?;
    if complete {
        Ok(())
    } else {
        Err(Failure::Interrupted(
            "interrupted: the chart has what was measured until then".into(),
        ))
    }
}
