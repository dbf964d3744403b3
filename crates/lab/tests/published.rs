//! Charts and choices of systems with published states at their ends: true, and of few calls of f.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use a3_core::accuracy::Metric;
use a3_core::{Ode, Scene, Simulation, integrators};
use a3_lab::chart::{Chart, ChartOptions, Record, chart};
use a3_lab::choose::{ChooseOptions, Goal, choose};

#[path = "../../core/tests/numerics/problems.rs"]
mod problems;

use problems::{Problem, arenstorf, hires, oregonator, pleiades, robertson, van_der_pol};

fn all() -> [(&'static str, Problem); 6] {
    [
        ("Robertson", robertson()),
        ("van der Pol", van_der_pol()),
        ("HIRES", hires()),
        ("Oregonator", oregonator()),
        ("Arenstorf", arenstorf()),
        ("Pleiades", pleiades()),
    ]
}

/// Returns the distance of a run of a chart from the published end: the root mean square over the
/// numbers, each relative to the largest size that it has had at the times of the chart.
fn distance(scene: &Scene, chart: &Chart, record: &Record, end: &[f64]) -> f64 {
    let method = integrators::find(&record.solver).unwrap();
    let mut run = Simulation::new(scene.clone(), method, method.control(record.setting)).unwrap();
    let mut sizes: Vec<f64> = scene.state.iter().map(|y| y.abs()).collect();
    let frames = chart.frames();
    for k in 1..=frames.count {
        run.advance_to(frames.time(k)).unwrap();
        for (size, y) in sizes.iter_mut().zip(run.state()) {
            *size = size.max(y.abs());
        }
    }
    let apart = run.state().iter().zip(end).zip(sizes);
    let squares = apart.map(|((y, end), size)| ((y - end) / size).powi(2));
    (squares.sum::<f64>() / end.len() as f64).sqrt()
}

/// What a chart says of its most accurate run is its distance from the published end, to ten times
/// the floor, and no chart takes three million calls of f.
#[test]
fn charts_are_true_and_cheap() {
    for (what, problem) in all() {
        let (end, calls) = (problem.end.clone(), problem.calls.clone());
        let options =
            ChartOptions { until: Some(problem.until), at_end: true, ..ChartOptions::default() };
        let scene = problem.scene();
        let chart = chart(&scene, &[], &options, &()).unwrap();
        let count = calls.load(Ordering::Relaxed);
        let runs = chart.runs().filter(|run| run.lost_at.is_none());
        let error = |run: &&Record| run.error(Metric::State);
        let best = runs.min_by(|a, b| error(a).total_cmp(&error(b))).unwrap();
        let (told, floor) = (best.error(Metric::State), best.floor(Metric::State));
        let found = distance(&scene, &chart, best, &end);
        let costly: Vec<_> = chart.too_costly().iter().map(|m| m.name).collect();
        println!(
            "{what}: {count} calls, floor {floor:.1e}; {} {:e}: told {told:.1e}, found {found:.1e}; \
             too costly: {costly:?}",
            best.solver, best.setting
        );
        assert!(count < 3_000_000, "{what}: {count}");
        assert!((found - told).abs() <= 10.0 * floor, "{what}");
        assert!(floor < 1e-6 && told < 1e-6, "{what}: {floor:e} {told:e}");
    }
}

/// The chosen run keeps the error that was asked for at the published end.
#[test]
fn choices_are_true_and_cheap() {
    for (what, problem) in all() {
        let (end, calls, until) = (problem.end.clone(), problem.calls.clone(), problem.until);
        let options = ChooseOptions {
            until: Some(until),
            at_end: true,
            ..ChooseOptions::new(Goal::Error(1e-5))
        };
        let scene = problem.scene();
        let choice = choose(&scene, &[], &options, &()).unwrap();
        let (best, count) = (choice.best(), calls.load(Ordering::Relaxed));
        println!(
            "{what}: {} {}, error {:.1e}, work {:.0}; {count} calls",
            best.method.name, best.control, best.error, best.work
        );
        let mut run = Simulation::new(scene, best.method, best.control).unwrap();
        run.advance_to(until).unwrap();
        let largest = end.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let apart = run.state().iter().zip(&end).map(|(y, end)| (y - end).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-4 * largest, "{what}");
        assert!(count < 3_000_000, "{what}: {count}");
    }
}

/// On a number that follows a cosine, a choice costs no more than 50,000 calls, however stiff the
/// number is, also where explicit methods would do.
#[test]
fn choices_are_cheap_at_any_stiffness() {
    for k in [0.1, 1.0, 10.0, 30.0, 100.0, 1e3, 1e5, 1e8] {
        let calls = Arc::new(AtomicU64::new(0));
        let counter = calls.clone();
        let system = Ode::new(1, move |t: f64, y: &[f64], dydt: &mut [f64]| {
            counter.fetch_add(1, Ordering::Relaxed);
            dydt[0] = -k * (y[0] - t.cos());
        });
        let scene = Scene::new("follower", system.unwrap(), vec![0.0]);
        let options = ChooseOptions::new(Goal::Error(1e-4));
        let choice = choose(&scene, &[], &options, &()).unwrap();
        let (best, count) = (choice.best(), calls.load(Ordering::Relaxed));
        println!("{k:e}: {} {}, {count} calls", best.method.name, best.control);
        assert!(count < 50_000, "{k:e}: {count}");
    }
}
