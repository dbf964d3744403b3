//! `a3 sweep`: scenes x solvers x steps or tolerances x keys of the scenes, in shares on any number
//! of machines. Each run has a file of its own, whose name is a hash of all that the run depends
//! on.

mod collect;
mod file;
mod folder;
mod plan;
mod values;
mod work;

use std::fmt::Write;

use a3_files::failure::Failure;
use a3_files::{interrupt, terminal};
use file::Sweep;
use folder::Folder;
use plan::Plan;

use crate::cli::{Sweep as Options, limit_threads};

/// Runs the command.
pub fn run(options: &Options) -> Result<(), Failure> {
    interrupt::listen();
    limit_threads(options.threads);
    let sweep = Sweep::read(&options.file)?;
    let plan = Plan::new(&sweep)?;
    if options.plan {
        return terminal::send(&lines(&sweep, &plan));
    }
    let path = options.output.clone().unwrap_or_else(|| {
        let stem = options.file.file_stem().unwrap_or_default();
        format!("a3-sweep-{}", stem.to_string_lossy()).into()
    });
    let folder = Folder::new(&path);
    if options.status {
        return status(&plan, &folder);
    }
    if options.collect {
        return collect::run(&sweep, &plan, &folder, options.size);
    }
    let share = match &options.only {
        Some(only) => {
            let ids: Vec<_> = plan.runs.iter().map(|run| run.id).collect();
            only.of(&ids).map_err(Failure::usage)?
        }
        None => (0..plan.runs.len()).collect(),
    };
    // Without a choice of solvers, all that can run the scene are meant, so refusals are expected.
    if !sweep.methods.is_empty() {
        for refusal in &plan.refusals {
            terminal::warn(&format!("left out: {refusal}"));
        }
    }
    folder.create()?;
    let left = work::run(&sweep, &plan, &share, &folder)?;
    if left > 0 {
        return Err(Failure::Interrupted(format!(
            "interrupted: {left} of {} runs are left; the same command continues with them",
            share.len()
        )));
    }
    if options.only.is_some() {
        status(&plan, &folder)
    } else {
        collect::run(&sweep, &plan, &folder, options.size)
    }
}

/// Returns the plan, a line for each run.
fn lines(sweep: &Sweep, plan: &Plan) -> String {
    let mut text = String::new();
    for run in &plan.runs {
        let variant = &plan.variants[run.variant];
        let (scene, method) = (terminal::visible(&variant.name), run.method.name);
        let _ = write!(text, "{}\t{scene}\t{method}\t{}\t{}", run.id, run.setting, variant.until);
        for (name, value) in sweep.names().iter().zip(&variant.values) {
            let value = terminal::visible(&value.to_string());
            let _ = write!(text, "\t{name}={value}");
        }
        text.push('\n');
    }
    text
}

/// Prints how many runs are done, on all machines that use the folder.
fn status(plan: &Plan, folder: &Folder) -> Result<(), Failure> {
    let (mut done, mut lost) = (0, 0);
    for run in &plan.runs {
        if let Some(record) = folder.read(run)? {
            done += 1;
            lost += usize::from(record.lost_at.is_some());
        }
    }
    folder.warn_of_others(plan);
    let (all, folder) = (plan.runs.len(), folder.path().display());
    terminal::say(&format!(
        "{folder}: {all} runs, {done} done ({lost} of them blew up), {} missing\n",
        all - done
    ))
}
