//! `a3 solvers`: the solvers, those that serve a scene, and the kinds of scenes that each serves.

mod table;
#[cfg(test)]
mod tests;

use a3_core::{Control, Method, ParticleSystem, Refusal, StepLength, integrators};
use a3_files::failure::Failure;
use a3_files::report;
use a3_files::setup::find;
use a3_files::terminal;

use crate::cli::Solvers;

/// Largest order of the backward differentiation formulas.
const BDF_ORDER: u32 = 5;

/// Lists the solvers, says which serve a scene, or prints the table of solvers and kinds of scenes.
pub fn run(options: &Solvers) -> Result<(), Failure> {
    let text = if options.kinds {
        table::table().map_err(Failure::run)?
    } else if let Some(name) = &options.scene {
        serving(find(name, "--scene")?.build(None)?.scene.model.system())
    } else {
        all()
    };
    terminal::say(&text)
}

/// Lists the solvers that serve a system, and why the others do not.
fn serving(system: &dyn ParticleSystem) -> String {
    let mut groups: Vec<(Option<Refusal>, Vec<&str>)> = vec![(None, Vec::new())];
    for method in integrators::METHODS {
        let why = method.refusal(system);
        match groups.iter_mut().find(|(of, _)| *of == why) {
            Some((_, names)) => names.push(method.name),
            None => groups.push((why, vec![method.name])),
        }
    }
    let line = |(why, names): &(Option<Refusal>, Vec<&str>)| {
        let names = names.join(", ");
        match why {
            None => format!("These solvers serve the scene: {names}.\n"),
            Some(why) => format!("These do not: {names}. Such a solver {why}.\n"),
        }
    };
    groups.iter().map(line).collect()
}

/// Returns the order of a solver, or its orders if it changes them.
fn order(method: &Method) -> String {
    match method.name {
        "bdf" => format!("1 to {BDF_ORDER}"),
        _ => method.order.to_string(),
    }
}

/// Lists all solvers.
fn all() -> String {
    let mut rows = report::headings("|solver| order| evaluations/step| default|serves|method");
    for m in integrators::METHODS {
        rows.push(vec![
            m.letter.map(String::from).unwrap_or_default(),
            m.name.into(),
            order(m),
            if m.is_implicit() && !m.needs_springs() {
                format!("{} and linear solves", m.evaluations)
            } else if m.solves_linear_systems() {
                format!(
                    "{} ({} and linear solves if springs are damped)",
                    m.evaluations, m.damped_evaluations
                )
            } else if m.damped_evaluations == m.evaluations {
                m.evaluations.to_string()
            } else {
                format!("{} ({} if springs are damped)", m.evaluations, m.damped_evaluations)
            },
            match m.default_control {
                Control::Step(step) => StepLength(step).to_string(),
                Control::Tolerance(tolerance) => format!("tolerance {tolerance:.0e}"),
            },
            if m.needs_springs() {
                "springs"
            } else if m.needs_mechanics() {
                "masses"
            } else if m.plain_only() {
                "plain numbers"
            } else {
                "any system"
            }
            .into(),
            m.title.into(),
        ]);
    }
    report::table(&rows)
}
