//! The table of solvers and kinds of scenes, in Markdown.

use a3_core::integrators::METHODS;
use a3_core::{Method, Refusal};
use a3_scenes::Fault;

use super::kinds::{Kind, kinds};

/// Solvers that serve the same kinds of scenes.
struct Family {
    letters: Vec<String>,
    /// For each kind, why the solvers do not serve it.
    refusals: Vec<Option<Refusal>>,
}

/// Returns the table: a row for each kind and a column for each family of solvers, with numbered
/// reasons below.
pub fn table() -> Result<String, Fault> {
    let kinds = kinds();
    let families = families(&kinds)?;
    let mut reasons: Vec<Refusal> = Vec::new();
    let mut cell = |refusal: Option<Refusal>| {
        let Some(why) = refusal else {
            return "yes".to_owned();
        };
        let known = reasons.iter().position(|known| same(*known, why));
        let number = known.unwrap_or_else(|| {
            reasons.push(why);
            reasons.len() - 1
        });
        format!("no, {}", number + 1)
    };
    let mut rows = vec![
        ["scenes with".to_owned()]
            .into_iter()
            .chain(families.iter().map(|family| family.letters.join(" ")))
            .collect::<Vec<_>>(),
    ];
    for (k, kind) in kinds.iter().enumerate() {
        let answers = families.iter().map(|family| cell(family.refusals[k]));
        rows.push([kind.words.to_owned()].into_iter().chain(answers).collect());
    }
    let reason = |(number, why): (usize, Refusal)| format!("{number}. The solver {why}.\n");
    let reasons: String = (1..).zip(reasons).map(reason).collect();
    Ok(format!("{}\n{reasons}", laid_out(&rows)))
}

/// Sorts the solvers into families, in the order of the table of solvers.
fn families(kinds: &[Kind]) -> Result<Vec<Family>, Fault> {
    let scenes = kinds
        .iter()
        .map(Kind::scene)
        .collect::<Result<Vec<_>, _>>()?;
    let mut families: Vec<Family> = Vec::new();
    for method in METHODS {
        let refusal = |scene: &a3_core::Scene| method.refusal(scene.model.system());
        let refusals: Vec<_> = scenes.iter().map(refusal).collect();
        let letter = letter(method);
        match families
            .iter_mut()
            .find(|family| family.refusals == refusals)
        {
            Some(family) => family.letters.push(letter),
            None => families.push(Family {
                letters: vec![letter],
                refusals,
            }),
        }
    }
    Ok(families)
}

/// Returns the letter of a solver, or its name, as code.
fn letter(method: &Method) -> String {
    let name = method.name.to_owned();
    format!("`{}`", method.letter.map_or(name, String::from))
}

/// Returns whether two reasons are of the same kind; the sizes of scenes in them may differ.
fn same(a: Refusal, b: Refusal) -> bool {
    std::mem::discriminant(&a) == std::mem::discriminant(&b)
}

/// Lays out rows, the heading first, as a table in Markdown.
fn laid_out(rows: &[Vec<String>]) -> String {
    let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max();
    let widths: Vec<_> = (0..rows[0].len()).filter_map(width).collect();
    let line = |cells: &[String]| {
        let cells = cells.iter().zip(&widths);
        let padded: Vec<_> = cells
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        format!("| {} |\n", padded.join(" | "))
    };
    let rule: Vec<_> = widths.iter().map(|width| "-".repeat(*width)).collect();
    line(&rows[0]) + &line(&rule) + &rows[1..].iter().map(|row| line(row)).collect::<String>()
}
