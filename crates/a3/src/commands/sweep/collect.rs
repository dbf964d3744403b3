//! The table of all runs of a sweep, and its chart.

use a3_core::Method;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::rows;
use a3_files::terminal;
use a3_lab::chart::picture;
use a3_lab::chart::record::Record;
use a3_plot::WorkPrecision;
use serde_json::Value;

use super::file::Sweep;
use super::folder::Folder;
use super::plan::{Plan, Variant};

/// Largest number of panels of a chart.
const MAX_PANELS: usize = 25;

/// Joins the finished runs, in the order of the plan, into a table and a chart. Fails after that if
/// some are missing.
pub fn run(sweep: &Sweep, plan: &Plan, folder: &Folder, size: (u32, u32)) -> Result<(), Failure> {
    let mut records: Vec<(usize, Record)> = vec![];
    for (place, run) in plan.runs.iter().enumerate() {
        if let Some(record) = folder.read(run)? {
            records.push((place, record));
        }
    }
    folder.warn_of_others(plan);
    let (all, count, panels) = (plan.runs.len(), records.len(), plan.variants.len());
    let missing = all - count;
    let why = format!(
        "{missing} of {all} runs are missing; `a3 sweep` makes them, or --only a share of them"
    );
    if records.is_empty() {
        return Err(Failure::run(why));
    }
    let beside = |ending: &str| {
        let mut path = folder.path().as_os_str().to_owned();
        path.push(ending);
        std::path::PathBuf::from(path)
    };
    let (table, chart) = (beside(".csv"), beside(".svg"));
    output::write(&table, lines(sweep, plan, &records)?.as_bytes())?;
    let lost = records.iter().filter(|(_, r)| r.lost_at.is_some()).count();
    let table = table.display();
    terminal::say(&format!("{count} runs, of which {lost} blew up: {table}\n"))?;
    if panels > MAX_PANELS {
        terminal::say(&format!(
            "no chart: it would have {panels} panels, and at most {MAX_PANELS} can be read\n"
        ))?;
    } else {
        let figure = diagram(sweep, plan, &records).draw(f64::from(size.0), f64::from(size.1));
        let figure = figure.map_err(Failure::usage)?;
        output::write(&chart, figure.svg().as_bytes())?;
        terminal::say(&format!("chart: {}\n", chart.display()))?;
    }
    if missing > 0 {
        return Err(Failure::run(why));
    }
    Ok(())
}

/// Returns the table: ids, values of the swept keys, and records.
fn lines(sweep: &Sweep, plan: &Plan, records: &[(usize, Record)]) -> Result<String, Failure> {
    let row = |fields: Vec<String>| -> Result<String, Failure> {
        let mut writer = csv::Writer::from_writer(vec![]);
        writer.write_record(fields).map_err(Failure::run)?;
        let bytes = writer.into_inner().map_err(Failure::run)?;
        Ok(String::from_utf8_lossy(&bytes).trim_end().to_owned())
    };
    let mut all = String::new();
    for (k, (place, record)) in records.iter().enumerate() {
        let run = &plan.runs[*place];
        let written = rows::csv_lines(record, k == 0).map_err(Failure::run)?;
        let mut written = written.as_str();
        if let Some((head, line)) = written.split_once('\n').filter(|_| k == 0) {
            let names = sweep.names().into_iter().map(str::to_owned);
            let names = ["id".to_owned()].into_iter().chain(names);
            all.extend([&row(names.collect())?, ",", head, "\n"]);
            written = line;
        }
        let values = plan.variants[run.variant].values.iter().map(short);
        let values = [run.id.to_string()].into_iter().chain(values);
        all.extend([&row(values.collect())?, ",", written, "\n"]);
    }
    Ok(all)
}

/// Returns a value as it is written in the table.
fn short(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

/// Returns the work-precision diagram, with a panel for each scene with its values.
fn diagram(sweep: &Sweep, plan: &Plan, records: &[(usize, Record)]) -> WorkPrecision {
    let mut methods: Vec<&'static Method> = vec![];
    for run in &plan.runs {
        if !methods.iter().any(|m| std::ptr::eq(*m, run.method)) {
            methods.push(run.method);
        }
    }
    let problems = plan.variants.iter().enumerate().map(|(number, variant)| {
        let of = records.iter().filter(|(place, _)| plan.runs[*place].variant == number);
        let records: Vec<_> = of.map(|(_, record)| record).collect();
        let mut problem = picture::problem(&records, &[], &methods, variant.metric, false);
        problem.title = title(sweep, variant);
        problem
    });
    let first = &plan.variants[0];
    WorkPrecision {
        title: format!("Speed against accuracy: {}", sweep.name),
        subtitle: "Each point is a run with another step or tolerance".into(),
        x_label: picture::x_label(first.metric, first.scope),
        y_label: picture::WORK.into(),
        problems: problems.collect(),
        foot: picture::foot(&methods),
        held: "held by impulses".into(),
    }
}

/// Returns the title of a panel: the scene and the values in which panels differ.
fn title(sweep: &Sweep, variant: &Variant) -> String {
    let mut parts = vec![];
    if sweep.scenes.len() > 1 || variant.values.is_empty() {
        let name = variant.name.split(' ').next().unwrap_or_default();
        parts.push(name.to_owned());
    }
    let counts = sweep.keys.iter().map(|(_, values)| values.len());
    let counts = counts.chain(sweep.stiffness.as_ref().map(Vec::len));
    for ((name, value), count) in sweep.names().iter().zip(&variant.values).zip(counts) {
        if count > 1 {
            parts.push(format!("{name} = {}", short(value)));
        }
    }
    parts.join(", ")
}
