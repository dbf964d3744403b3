//! Execution of the runs of a share.

use std::sync::atomic::{AtomicUsize, Ordering};

use a3_core::accuracy::{Frames, horizon};
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::interrupt;
use a3_lab::chart::measure::{compared, precision, reference};
use a3_lab::chart::record::{Record, VERSION};
use a3_lab::motion::words;
use rayon::prelude::*;

use super::file::Sweep;
use super::folder::Folder;
use super::plan::{Plan, Run, Variant};

/// Makes the missing runs among those at these indices of the plan. Returns how many are left,
/// which is not 0 after an interrupt.
pub fn run(sweep: &Sweep, plan: &Plan, share: &[usize], folder: &Folder) -> Result<usize, Failure> {
    let mut missing: Vec<&Run> = vec![];
    for place in share {
        let run = &plan.runs[*place];
        if folder.read(run)?.is_none() {
            missing.push(run);
        }
    }
    let left = AtomicUsize::new(missing.len());
    let bar = Bar::new(missing.len() as f64);
    bar.say("runs  ");
    let groups: Vec<&[&Run]> = missing.chunk_by(|a, b| a.variant == b.variant).collect();
    let done = groups.into_par_iter().try_for_each(|runs| {
        let variant = &plan.variants[runs[0].variant];
        let done = run_variant(sweep, variant, runs, folder, &|| {
            left.fetch_sub(1, Ordering::Relaxed);
            bar.advance(1.0);
        });
        Failure::unless_stopped(done).map(drop)
    });
    bar.clear();
    done.map(|()| left.into_inner())
}

/// Makes runs of one scene, which share a reference.
fn run_variant(
    sweep: &Sweep,
    variant: &Variant,
    runs: &[&Run],
    folder: &Folder,
    done: &(dyn Fn() + Sync),
) -> Result<(), Failure> {
    let scene = variant.scene(sweep)?;
    let (until, scope) = (variant.until, variant.scope);
    let ahead = horizon(&scene, until, &interrupt::go_on).map_err(Failure::run)?;
    let Some(ahead) = ahead else { return Ok(()) };
    let precision = precision(&scene, ahead.motion);
    let frames = Frames::new(until);
    let reference = reference(&interrupt::go_on, &scene, frames, scope, precision)?;
    let grid = scene.grid();
    let blank = Record {
        version: VERSION.into(),
        scene: variant.name.clone(),
        rows: grid.map_or(0, |grid| grid.rows()),
        cols: grid.map_or(0, |grid| grid.cols()),
        stiffness: variant.stiffness,
        until,
        scope: words(scope, &scene.model),
        ..Record::default()
    };
    runs.par_iter().try_for_each(|run| {
        let like = Record { solver: run.method.name.into(), setting: run.setting, ..blank.clone() };
        let go_on = &interrupt::go_on;
        let (record, _) = compared(like, &scene, run.method, &reference, &mut [], go_on)?;
        folder.write(run.id, record)?;
        done();
        Ok(())
    })
}
