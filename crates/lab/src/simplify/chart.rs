//! The chart of models: the error of runs against their cost, with the grid and the step both
//! varied. Errors are taken from the motion that the two finest grids extrapolate to.

use a3_core::accuracy::{coarser, ladder};
use a3_core::integrators::find;
use a3_core::stability::spectrum;
use a3_core::{Method, Scene};
use a3_files::failure::Failure;
use a3_files::quantity::Quantity;
use a3_plot::{Curve, CurveStyle, Guide, Marker, Measurement, Problem, WorkPrecision};
use a3_scenes::{Regridded, regridded};

use super::lean::Solved;
use super::models::{FACTORS, Models};
use crate::chart::measure::time;
use crate::chart::table::words;
use crate::motion::{GridError, Places, Track, grid};

/// Styles of the grids, from the coarsest to the finest.
const STYLES: [(&str, Marker); 5] = [
    ("#e69f00", Marker::Polygon(3, 0.0)),
    ("#d55e00", Marker::Polygon(4, 0.125)),
    ("#cc79a7", Marker::Polygon(5, 0.0)),
    ("#0072b2", Marker::Polygon(32, 0.0)),
    ("#332288", Marker::Polygon(6, 0.0)),
];

/// Largest number of runs on a grid.
const MAX_RUNS: usize = 7;
/// Ratio of the error of a run to that of its grid, above which the time steps make more of it.
const BALANCE: f64 = std::f64::consts::SQRT_2;
/// Largest number of particles of a grid in the chart, and largest work of a run (evaluations).
const MAX_WORK: u64 = 200_000;

/// Least error of a run in the chart, over that of an accurate run on its grid.
const LEAST_SHARE: f64 = 0.95;

/// Grid of the chart.
struct ChartGrid {
    name: String,
    scene: Scene,
    places: Option<Vec<Vec<(usize, f64)>>>,
    /// Motion of an accurate run.
    motion: Track,
}

/// Solvers of the chart, besides the cheapest of the whole scene: implicit ones, whose steps are
/// not limited by the grid.
const LONG_STEPS: [&str; 2] = ["implicit", "tr-bdf2"];

/// Measures the runs of the chart. `None` if the scene has one grid only, or if grids differ by
/// more than the motion.
pub fn chart(
    models: &Models,
    whole: &Solved,
    title: String,
) -> Result<Option<WorkPrecision>, Failure> {
    let Some(mut grids) = grids(models)? else {
        return Ok(None);
    };
    let [.., own, finest] = &grids[..] else {
        return Ok(None);
    };
    let difference = |grid: &ChartGrid| models.compared.distance(&own.motion, &grid.motion);
    let half =
        grids.iter().find(|grid| 2 * grid.scene.model.particles() < own.scene.model.particles());
    let estimate = GridError::new(String::new(), half.map(difference), difference(finest));
    // The finest grid errs by 2^-p of what the grid in use does.
    let share = estimate.order().map_or(0.0, |order| 1.0 / (order.exp2() - 1.0));
    let truth = Track::extrapolated(&own.motion, &finest.motion, share);
    if estimate.order().is_none() {
        // The finest grid cannot be compared with itself.
        grids.pop();
    }
    let long = LONG_STEPS.iter().filter_map(|name| find(name));
    let long = long.filter(|method| *method != whole.method);
    let supports = |method: &&Method| method.check(models.scene.model.system()).is_ok();
    let methods: Vec<_> = [whole.method].into_iter().chain(long.filter(supports)).collect();
    let monitor = models.monitor;
    monitor.expect((grids.len() * methods.len() * MAX_RUNS) as f64);
    let motion = models.compared.way(&models.whole);
    let (mut curves, mut balance) = (vec![], vec![]);
    let styles = STYLES.iter().skip(STYLES.len() - grids.len());
    for (grid, (colour, marker)) in grids.iter().zip(styles) {
        monitor.stage(&grid.name);
        let least = models.compared.distance(&truth, &grid.motion);
        let mut runs = vec![];
        for method in &methods {
            runs.extend(measured(models, grid, method, (&truth, least))?);
        }
        // Long steps that err less than short ones do so because their errors and those of the grid
        // cancel by chance.
        runs.retain(|run| run.error > LEAST_SHARE * least && run.error < motion);
        let mut curve =
            Curve { style: CurveStyle::new(colour, &[], *marker), name: grid.name.clone(), runs };
        curve.runs = curve.joined().into_iter().cloned().collect();
        balance.extend(balanced(&curve.runs, BALANCE * least));
        curves.push(curve);
    }
    if curves.iter().all(|curve| curve.runs.is_empty()) {
        return Ok(None);
    }
    let guide = (balance.len() > 1)
        .then(|| Guide { name: "errors of grid and time steps are equal".into(), points: balance });
    let foot = foot(guide.is_some(), estimate.order().is_some());
    let solvers = methods.iter().map(|it| format!("{} {}", short(it), it.title));
    let solvers: Vec<_> = solvers.collect();
    let until = models.compared.frames.until;
    Ok(Some(WorkPrecision {
        title,
        subtitle: format!("{until} s of motion on different grids; {}", solvers.join("; ")),
        x_label: format!(
            "error {}, of grid and time steps together ({})",
            match models.compared.quantity {
                Quantity::Position => "of positions, largest RMS",
                Quantity::Centre => "of the centre of mass",
                Quantity::Energy => "of the energy",
            },
            models.compared.unit()
        ),
        y_label: "computing time per simulated second (s)".into(),
        problems: vec![Problem { curves, still: Some(motion), guide, ..Problem::default() }],
        foot,
        held: "the time steps err more than the grid".into(),
    }))
}

/// Explains the chart: whether it has the line of balance, and whether grids converge.
fn foot(is_balanced: bool, converges: bool) -> String {
    let balance = if is_balanced {
        "On the dashed line, the time steps err as much as the grid. Left of it, where markers are filled, a shorter \
         step is wasted, and a finer grid helps. Right of it, a shorter step helps."
    } else {
        "Where a marker is filled, the grid errs more than the time steps: a shorter step is wasted, and a finer grid \
         helps."
    };
    let truth = if converges {
        "the motion that the two finest grids extrapolate to"
    } else {
        "the motion on a grid twice as fine: grids do not converge yet"
    };
    format!("{balance} Errors are differences from {truth}.")
}

/// Returns the letter of a method, or its name if it has none.
fn short(method: &Method) -> String {
    let name = || method.name.to_owned();
    method.letter.map_or_else(name, String::from)
}

/// Returns the point of a curve, an error and its work, at which the error is this: between the
/// runs that enclose it, on logarithmic scales. `None` if none do.
fn balanced(runs: &[Measurement], error: f64) -> Option<[f64; 2]> {
    runs.windows(2).find_map(|pair| {
        let [a, b] = [&pair[0], &pair[1]];
        let share = (error / a.error).ln() / (b.error / a.error).ln();
        let work = a.work * (b.work / a.work).powf(share);
        (0.0..=1.0).contains(&share).then_some([error, work])
    })
}

/// Returns the grids from the coarsest to one twice as fine, with their accurate motions.
fn grids(models: &Models) -> Result<Option<Vec<ChartGrid>>, Failure> {
    let own = &*models.request.source.description;
    let particles = models.scene.model.particles();
    let mut all: Vec<ChartGrid> = vec![];
    for factor in FACTORS.into_iter().chain([1.0]) {
        let regridded = regridded(own, factor, particles).ok().filter(|_| factor != 1.0);
        let (description, places) = match regridded {
            Some(Regridded { description, places }) => (description, Some(places)),
            None if factor == 1.0 => (own.clone(), None),
            None => continue,
        };
        let Ok(motion) = models.follow(&description, places.as_deref())? else {
            continue;
        };
        let name = format!("grid of {}", grid(&description));
        if all.iter().all(|grid| grid.name != name) {
            all.push(ChartGrid { name, scene: models.build(&description)?, places, motion });
        }
    }
    all.sort_by_key(|grid| grid.scene.model.particles());
    let has_finer = all.last().is_some_and(|last| last.scene.model.particles() > particles);
    Ok((all.len() > 1 && has_finer).then_some(all))
}

/// Measures runs on a grid by a method at several steps or tolerances, from the coarsest on, until
/// the grid makes nearly all of the error. `least` is the error of its accurate run.
fn measured(
    models: &Models,
    grid: &ChartGrid,
    method: &'static Method,
    (truth, least): (&Track, f64),
) -> Result<Vec<Measurement>, Failure> {
    let (scene, compared) = (&grid.scene, models.compared);
    let go_on = &|| models.monitor.go_on();
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let rungs = ladder(&modes, method, &compared.frames, MAX_WORK).map_err(Failure::run)?;
    // The limit of stability is that of the start, and may be longer in motion.
    let first = rungs.first().and_then(|control| coarser(*control, &compared.frames));
    let mut found = vec![];
    let places: Option<&Places> = grid.places.as_deref();
    for control in first.into_iter().chain(rungs).take(MAX_RUNS) {
        let run = compared.follow(scene, (method, control), places, go_on);
        let Some(track) = run? else {
            models.monitor.advance(1.0);
            continue;
        };
        let (frames, before) = (&compared.frames, Some(track.time));
        let time = time(go_on, scene, method, control, frames, before)?;
        let error = compared.distance(truth, &track);
        models.monitor.advance(1.0);
        found.push(Measurement {
            error,
            work: time.as_secs_f64() / compared.frames.until,
            held: error > BALANCE * least,
            label: Some(format!("{} {}", short(method), words(control))),
            ..Measurement::default()
        });
        if error < 1.01 * least && found.len() > 2 {
            break;
        }
    }
    Ok(found)
}
