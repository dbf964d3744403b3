//! `a3 stability`: the largest stable step of each solver, predicted and observed, and a chart of
//! the stability regions that explain it.

use std::fmt::Write;
use std::path::PathBuf;

use a3_core::stability::{
    Growth, Limit, Mode, Observation, Truth, largest_step, modes_in_motion, observe_at_rest,
    observe_from_start, rest, spectrum,
};
use a3_core::{Method, Scene};
use a3_plot::{Region, StabilityRegions};

use crate::chart::{describe, methods, style, write_picture};
use crate::cli::Stability;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{interrupt, list, output, setup};

/// The limits of a method.
struct MethodLimits {
    method: &'static Method,
    /// The limit predicted from the modes of the scene as it starts.
    start: Option<Limit>,
    /// The limit as the scene moves from its start.
    motion: Comparison,
    /// The limit at rest, if the scene comes to rest.
    rest: Option<Comparison>,
}

/// A limit as it was predicted and as it was observed.
struct Comparison {
    predicted: Option<Limit>,
    observed: Option<Observation>,
}

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Stability) -> Result<(), Failure> {
    interrupt::listen();
    let scene = setup::scene(&options.what)?;
    let methods = methods(&scene, &options.solvers)?;
    let path = match &options.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("a3-stability-{}.svg", scene.name)),
    };
    output::check(&path, &["svg", "png"])?;
    let at_start = spectrum(scene.model.system(), 0.0, &scene.state);
    let in_motion = modes_in_motion(&scene).map_err(Failure::run)?;
    let truth = Truth::of(&scene).map_err(Failure::run)?;
    let hanging = rest(&scene).map_err(Failure::run)?;
    let bar = Bar::new(2.0 * methods.len() as f64);
    let mut rows = vec![];
    for method in methods {
        bar.say(format!("{:<10} ", method.name));
        let start = largest_step(method, &at_start).map_err(Failure::run)?;
        let motion = compare(method, &in_motion, |limit| {
            let guess = limit.map_or(1.0, |limit| limit.step);
            observe_from_start(&scene, &truth, method, guess, interrupt::go_on)
        })?;
        bar.advance(1.0);
        let rest = match &hanging {
            Some(rest) => Some(compare(method, &rest.modes, |limit| {
                observe_at_rest(rest, method, limit, interrupt::go_on)
            })?),
            None => None,
        };
        bar.advance(1.0);
        if !interrupt::go_on() {
            break;
        }
        rows.push(MethodLimits {
            method,
            start,
            motion,
            rest,
        });
    }
    bar.clear();
    if rows.is_empty() {
        return Err(Failure::Interrupted(
            "interrupted before anything was measured".into(),
        ));
    }
    output::say(&text(
        &scene,
        &rows,
        &at_start,
        hanging.as_ref().map(|rest| &rest.modes[..]),
    ))?;
    let title = format!("Where solvers fail: {}", describe(&options.what, &scene));
    // By default a step is one radian of the fastest motion.
    let fastest = at_start.first().map_or(1.0, Mode::frequency);
    let h = options
        .step
        .unwrap_or_else(|| format!("{:.1e}", 1.0 / fastest).parse().unwrap_or(1.0));
    let figure = chart(title, &rows, &at_start, h)
        .draw(f64::from(options.size.0), f64::from(options.size.1))
        .map_err(Failure::usage)?;
    write_picture(&path, &figure)?;
    output::say(&format!("chart: {}\n", path.display()))?;
    if interrupt::go_on() {
        Ok(())
    } else {
        Err(Failure::Interrupted(
            "interrupted: the chart has what was measured until then".into(),
        ))
    }
}

/// The limit predicted from modes, and the one that `observe` finds with that prediction.
fn compare(
    method: &'static Method,
    modes: &[Mode],
    observe: impl FnOnce(Option<&Limit>) -> Result<Option<Observation>, a3_core::Error>,
) -> Result<Comparison, Failure> {
    let predicted = largest_step(method, modes).map_err(Failure::run)?;
    let observed = observe(predicted.as_ref()).map_err(Failure::run)?;
    Ok(Comparison {
        predicted,
        observed,
    })
}

/// A step in words, to three digits (ms).
fn step(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    match ms {
        _ if ms.is_infinite() => "any".into(),
        _ if ms < 0.999_5 => format!("{ms:.3}"),
        _ if ms < 9.995 => format!("{ms:.2}"),
        _ if ms < 99.95 => format!("{ms:.1}"),
        _ => format!("{ms:.0}"),
    }
}

/// A predicted limit in words (ms), with a mark if shorter steps grow too.
fn prediction(limit: Option<Limit>) -> String {
    limit.map_or("-".into(), |limit| {
        step(limit.step) + if limit.strict { "" } else { "~" }
    })
}

/// An observed limit in words (ms).
fn observation(seen: Option<Observation>) -> String {
    seen.map_or("-".into(), |seen| step(seen.step))
}

/// The ratio of the observed to the predicted limit, in words.
fn ratio(pair: &Comparison) -> String {
    match (pair.predicted, pair.observed) {
        (Some(limit), Some(seen)) if limit.step.is_finite() && seen.step.is_finite() => {
            format!("{:.3}", seen.step / limit.step)
        }
        _ => "-".into(),
    }
}

/// The table of all limits, with the fastest motion above it.
fn text(scene: &Scene, rows: &[MethodLimits], start: &[Mode], rest: Option<&[Mode]>) -> String {
    let heading = [
        "solver",
        " start: predicted",
        " moving: predicted",
        " observed",
        " ratio",
        " at rest: predicted",
        " observed",
        " ratio",
    ];
    let mut cells = vec![heading.map(String::from).to_vec()];
    for row in rows {
        let mut line = vec![
            row.method.name.to_owned(),
            prediction(row.start),
            prediction(row.motion.predicted),
            observation(row.motion.observed),
            ratio(&row.motion),
        ];
        line.extend(
            row.rest
                .as_ref()
                .map_or(["-", "-", "-"].map(String::from), |pair| {
                    [
                        prediction(pair.predicted),
                        observation(pair.observed),
                        ratio(pair),
                    ]
                }),
        );
        cells.push(line);
    }
    let frequency = |modes: &[Mode]| {
        modes.first().map_or("-".to_owned(), |mode| {
            let damping = 0.5 * (mode.drag + mode.damping) / mode.frequency();
            format!("{:.1} rad/s, damping ratio {damping:.3}", mode.frequency())
        })
    };
    let mut text = format!(
        "{}: fastest motion {} at the start",
        scene.name,
        frequency(start)
    );
    if let Some(rest) = rest {
        let _ = write!(text, ", {} at rest", frequency(rest));
    }
    let _ = write!(
        text,
        "\n\nlargest stable step (ms), that of the fixed step for adaptive solvers\n{}",
        list::table(&cells)
    );
    if rows.iter().any(|row| {
        let rest = row.rest.as_ref().and_then(|pair| pair.predicted);
        let limits = [row.start, row.motion.predicted, rest];
        limits.into_iter().flatten().any(|limit| !limit.strict)
    }) {
        text += "~ shorter steps grow too, but less than tenfold in 10 s or 1000 steps\n";
    }
    text
}

/// The chart of stability regions, with the eigenvalues of the modes times the step h (s).
fn chart(title: String, rows: &[MethodLimits], modes: &[Mode], h: f64) -> StabilityRegions {
    StabilityRegions {
        title,
        subtitle: format!(
            "Where the eigenvalues of the scene as it starts, times a step of {}\u{a0}ms, lie in each solver's stable region",
            step(h)
        ),
        regions: rows.iter().map(|row| region(row, modes, h)).collect(),
    }
}

/// The stability region of a method.
fn region(row: &MethodLimits, modes: &[Mode], h: f64) -> Region {
    let limit = row
        .motion
        .predicted
        .map_or(f64::INFINITY, |limit| limit.step);
    let method = row.method;
    let subtitle = if limit.is_finite() {
        format!(
            "stable up to {}\u{a0}ms, {}",
            prediction(row.motion.predicted),
            match row.motion.observed {
                Some(seen) => format!("observed {}\u{a0}ms", step(seen.step)),
                None => "not observed".into(),
            }
        )
    } else {
        "stable at any step".to_owned()
    };
    // The growth of a Runge-Kutta step depends on the eigenvalues only. That of a splitting method
    // also depends on how the damping is divided between drag and springs, which is taken from the
    // fastest mode.
    let share = modes
        .first()
        .map_or(0.0, |m| m.damping / (m.drag + m.damping).max(1e-300));
    let radius = move |re: f64, im: f64| {
        let mode = Mode::of_eigenvalue(re, im);
        let mode = Mode {
            drag: (1.0 - share) * mode.drag,
            damping: share * mode.drag,
            ..mode
        };
        Growth::new(method, mode).map_or(f64::INFINITY, |mut growth| growth.of_step(1.0))
    };
    Region {
        style: style::of(method.letter),
        title: method.title.to_owned(),
        subtitle,
        radius: Box::new(radius),
        eigenvalues: modes
            .iter()
            .filter(|mode| mode.stiffness > 0.0)
            .flat_map(Mode::eigenvalues)
            .map(|[re, im]| [h * re, h * im])
            .collect(),
    }
}
