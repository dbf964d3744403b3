//! The table of the models, and the leanest scene in words.

use a3_files::quantity::Quantity;
use a3_files::report::{Report, headings};
use a3_scenes::Description;

use super::lean::{Answer, LeanModel, Solved};
use super::models::{Model, Models};
use crate::chart::table::words;
use crate::motion::{GridError, grid};

/// Change of the motion, over the error that is asked for, above which a part is barely needed.
const BARELY_NEEDED: f64 = 0.1;

/// Describes the models, the error of the grid, and the leanest scene in words.
pub fn report(
    title: &str,
    error: f64,
    models: &Models,
    all: &[Model],
    why: Option<&str>,
    answer: Option<&Answer>,
) -> Report {
    let compared = models.compared;
    let (motion, unit) = (compared.way(&models.whole), compared.unit());
    let (method, control) = models.accurate;
    let head = format!(
        "{title} for {} s, an error of {error:e} {unit}; {} by {motion:.1e} {unit}:\n\
         each model is run by {} at {}, which is accurate to {:.0e} {unit} on the whole scene\n",
        compared.frames.until,
        changing(compared.quantity),
        method.title,
        words(control),
        models.uncertainty
    );
    let lean = answer.map(|answer| &answer.model);
    let rows = if all.is_empty() { vec![] } else { rows(all, (motion, unit), error, lean) };
    let mut foot = String::new();
    let of_grid = of_grid(all, &models.request.source.description);
    if let Some(of_grid) = of_grid.filter(|_| compared.quantity == Quantity::Position) {
        foot += &of_grid.sentence();
    }
    if let Some(why) = why {
        foot += "the grid is not varied: ";
        foot += why;
        foot += "\n";
    }
    if let Some(answer) = answer {
        foot += &of_lean(answer, unit);
    }
    Report { head, rows, foot }
}

/// Returns the quantity and its verb, as the subject of a sentence.
pub fn changing(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position => "the particles move",
        Quantity::Centre => "the centre of mass moves",
        Quantity::Energy => "the energy changes",
    }
}

/// Returns the rows of the table of all models, with a verdict on each. `motion` is the change in
/// the run of the whole scene, with its unit, and `error` the error that is asked for.
fn rows(
    models: &[Model],
    (motion, unit): (f64, &str),
    error: f64,
    lean: Option<&LeanModel>,
) -> Vec<Vec<String>> {
    let columns = format!("left out or changed| changes ({unit})| of motion| saves|verdict");
    let mut rows = headings(&columns);
    for model in models {
        let numbers = match &model.effect {
            Err(_) => ["-"; 3].map(String::from),
            Ok(effect) => {
                [number(effect.change), percent(effect.change / motion), percent(1.0 - effect.time)]
            }
        };
        let verdict = verdict(model, error, lean).into();
        let name = [model.name.clone()].into_iter();
        rows.push(name.chain(numbers).chain([verdict]).collect());
    }
    rows
}

/// Returns the verdict on a model, or the reason why it was not measured. `error` is the error that
/// is asked for.
pub fn verdict<'a>(model: &'a Model, error: f64, lean: Option<&LeanModel>) -> &'a str {
    let share = match &model.effect {
        Ok(effect) => effect.change / error,
        Err(why) => return why,
    };
    let is_out = lean.is_some_and(|lean| lean.has(model));
    match (&model.part, share <= 1.0) {
        (Some(_), _) if is_out => "leave it out",
        (Some(_), false) => "needed",
        (Some(_), true) if share > BARELY_NEEDED => "barely needed",
        (Some(_), true) => "changes little, saves little",
        (None, _) if is_out => "take it",
        (None, true) => "fine enough",
        (None, false) if model.factor < 1.0 => "too coarse",
        (None, false) => "the scene's grid errs by more than --error",
    }
}

/// Estimates the error of the scene's grid from a coarser and a finer one. `None` if no
/// finer grid was measured.
pub fn of_grid(models: &[Model], description: &Description) -> Option<GridError> {
    let change = |factor: f64| {
        let model = models.iter().find(|m| m.part.is_none() && m.factor == factor)?;
        model.effect.as_ref().ok().map(|effect| effect.change)
    };
    Some(GridError::new(grid(description), change(0.5), change(2.0)?))
}

/// Describes the leanest scene in words, beside the whole scene.
fn of_lean(answer: &Answer, unit: &str) -> String {
    let (lean, whole) = (&answer.model, &answer.whole);
    let said = |solved: &Solved| {
        let error = number(solved.error);
        format!("{}, {}: error {error} {unit}", solved.method.title, words(solved.control))
    };
    let lasts = |solved: &Solved| format!("{:.3} ms a simulated second", 1e3 * solved.time);
    let of_whole = format!("  whole  {}, {}\n", said(whole), lasts(whole));
    let mut changes = vec![];
    if !lean.parts.is_empty() {
        let names: Vec<_> = lean.parts.iter().map(|part| &*part.name).collect();
        changes.push(format!("without {}", names.join(", ")));
    }
    if lean.factor < 1.0 {
        changes.push(format!("on a grid of {}", grid(&lean.description)));
    }
    if changes.is_empty() {
        return format!("nothing can be left out that would save time\n{of_whole}");
    }
    let times = whole.time / answer.solved.time;
    let times = if times < 1.05 {
        "no cheaper in this measurement".into()
    } else {
        format!("{times:.1} times cheaper")
    };
    let (changes, error) = (changes.join("; "), number(lean.error));
    let (said, lasts) = (said(&answer.solved), lasts(&answer.solved));
    format!(
        "leanest scene, {times}: {changes}\n{of_whole}  lean   {said} in all, {error} {unit} of it \
         the model's, {lasts}\n"
    )
}

/// Writes a number with two digits.
fn number(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Writes a share in percent.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 999.0 {
        "> 999 %".into()
    } else if percent.abs() >= 9.95 {
        format!("{percent:.0} %")
    } else if percent.abs() >= 0.095 {
        format!("{percent:.1} %")
    } else if percent == 0.0 {
        "0 %".into()
    } else {
        format!("{percent:.0e} %")
    }
}
