//! The library: charts, choices, limits and comparisons of built-in and own methods on built-in and
//! own systems, against exact answers and the command line.

use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use a3::{ChartOptions, ChooseOptions, Failure, Goal, Monitor};
use a3_core::accuracy::Metric;
use a3_core::integrators::find;
use a3_core::{Control, Error, Method, Ode, Scene, SecondOrder};

fn plus(y: &[f64], a: f64, k: &[f64]) -> Vec<f64> {
    y.iter().zip(k).map(|(y, k)| y + a * k).collect()
}

/// Own method of Heun.
fn heun(name: &str) -> &'static Method {
    let method = Method::from_step(name, 2, |f, t, y, h| {
        let a = f.at(t, y)?;
        let b = f.at(t + h, &plus(y, h, &a))?;
        Ok(plus(&plus(y, 0.5 * h, &a), 0.5 * h, &b))
    });
    method.unwrap().with_title("my Heun").register()
}

/// Own explicit Euler method.
fn euler(name: &str) -> &'static Method {
    let method = Method::from_step(name, 1, |f, t, y, h| Ok(plus(y, h, &f.at(t, y)?)));
    method.unwrap().register()
}

/// y' = -rate y from 1.
fn decay(rate: f64) -> Scene {
    let f = move |_t: f64, y: &[f64], dydt: &mut [f64]| dydt[0] = -rate * y[0];
    Scene::new("decay", Ode::new(1, f).unwrap(), vec![1.0])
}

/// Two coordinates on springs, x'' = -4 x and y'' = -9 y.
fn springs() -> Scene {
    let forces = |_t: f64, x: &[f64], _v: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[-4.0 * x[0], -9.0 * x[1]]);
    };
    let system = SecondOrder::of_coordinates(&[1.0, 1.0], forces).unwrap();
    let system = system.positional();
    let state = system.state(&[1.0, 0.5], &[0.0, 0.0]).unwrap();
    Scene::new("springs", system, state)
}

fn until(until: f64) -> ChartOptions {
    ChartOptions { until: Some(until), ..ChartOptions::default() }
}

fn usage<T>(result: Result<T, Failure>) -> String {
    match result {
        Err(Failure::Usage(why)) => why,
        Err(other) => panic!("{other:?}"),
        Ok(_) => panic!("accepted"),
    }
}

#[test]
fn an_own_heun_is_charted_like_the_built_in_one() {
    let own = heun("chart-heun");
    let built_in = find("heun").unwrap();
    for scene in [decay(2.0), springs()] {
        let chart = a3::chart(&scene, &[built_in, own], &until(1.0), &()).unwrap();
        assert!(chart.is_complete());
        let metric = chart.metric();
        let of = |name: &str| -> Vec<_> { chart.runs().filter(|r| r.solver == name).collect() };
        let (a, b) = (of(built_in.name), of(own.name));
        assert!(a.len() > 4 && a.len() == b.len(), "{}", a.len());
        for (a, b) in a.iter().zip(&b) {
            assert_eq!((a.setting, a.evaluations), (b.setting, b.evaluations));
            if a.lost_at.is_none() {
                let apart = (a.error(metric) - b.error(metric)).abs();
                assert!(apart < 1e-9 * a.error(metric) + 1e-14, "{apart:e}");
            }
        }
        let order = b.last().unwrap().order.unwrap();
        assert!((order - 2.0).abs() < 0.05, "{}: {order}", scene.name);
        let svg = chart.figure(900, 600).unwrap().svg();
        assert!(svg.contains("my Heun") && svg.contains("#e6007e") && svg.contains(&scene.name));
        assert!(chart.table().contains("chart-heun"));
        let csv = chart.csv().unwrap();
        assert_eq!(csv.lines().count(), 1 + chart.runs().count());
        assert!(chart.json().unwrap().contains("\"error_state\":"));
    }
    let of_decay = a3::chart(&decay(2.0), &[own], &until(1.0), &()).unwrap();
    assert_eq!(of_decay.metric(), Metric::State);
    let of_springs = a3::chart(&springs(), &[own], &until(1.0), &()).unwrap();
    assert_eq!(of_springs.metric(), Metric::Position);
}

/// The library and the command line measure the same runs.
#[test]
fn a_chart_has_the_runs_of_the_command() {
    let data = std::env::temp_dir().join(format!("a3-library-{}.csv", std::process::id()));
    let picture = data.with_extension("svg");
    let command = Command::new(env!("CARGO_BIN_EXE_a3"))
        .args(["chart", "--scene", "pendulum", "--solvers", "e,r,f"])
        .args(["--until", "0.5", "--work", "evaluations", "--no-model", "--data"])
        .arg(&data)
        .arg("--output")
        .arg(&picture)
        .output()
        .unwrap();
    assert!(command.status.success(), "{command:?}");
    let written = std::fs::read_to_string(&data).unwrap();
    std::fs::remove_file(data).unwrap();
    std::fs::remove_file(picture).unwrap();

    let methods = ["e", "r", "f"].map(|name| find(name).unwrap());
    let scene = a3::scene("pendulum").unwrap();
    let chart = a3::chart(&scene, &methods, &until(0.5), &()).unwrap();
    assert_eq!(chart.csv().unwrap(), written);
    // What the table says in words, the winners are as values.
    let (table, winners) = (chart.table(), chart.winners().collect::<Vec<_>>());
    let (_, words) = table.split_once("* cheapest:\n").unwrap();
    for method in methods {
        let wins = winners.iter().any(|(_, run)| run.solver == method.name);
        assert_eq!(words.contains(method.title), wins, "{}", method.name);
    }
    let is_cheapest = |(error, best): &(f64, &a3::Record)| {
        let keeps = |run: &&a3::Record| run.error(chart.metric()) <= *error;
        let works = chart.runs().filter(keeps).map(|run| run.work);
        keeps(best) && best.work == works.fold(f64::INFINITY, f64::min)
    };
    assert!(winners.len() > 2 && winners.iter().all(is_cheapest), "{words}");
    assert!(String::from_utf8_lossy(&command.stdout).starts_with(&chart.table()));
}

/// Explicit Euler multiplies a decay of rate r by 1 - h r.
#[test]
fn limits_of_an_own_euler_are_exact() {
    let own = euler("limits-euler");
    let found = a3::stability(&decay(50.0), &[own, find("rk4").unwrap()], &()).unwrap();
    assert!(found.complete);
    let limits = found.limits[0];
    assert_eq!(limits.method, own);
    let seen = limits.bounded.unwrap();
    assert!(seen.held <= 0.0401 && seen.held > 0.039, "{seen:?}");
    for (h, growth) in [(0.01, 0.5), (0.03, 0.5), (0.05, 1.5)] {
        assert!((found.growth(own, h).unwrap() - growth).abs() < 1e-6);
    }
    assert!(
        found.table().contains("limits-euler") && found.json().unwrap().contains("limits-euler")
    );
    let svg = found.figure(None, 1000, 700).unwrap().svg();
    assert!(svg.contains("limits-euler") && svg.contains("#e6007e"));
}

#[test]
fn own_methods_are_chosen_where_they_are_the_cheapest() {
    let methods = [euler("choose-euler"), heun("choose-heun")];
    let mut options = ChooseOptions::new(Goal::Error(1e-4));
    options.until = Some(1.0);
    for scene in [decay(2.0), springs()] {
        let choice = a3::choose(&scene, &methods, &options, &()).unwrap();
        assert_eq!(choice.best().method.name, "choose-heun");
        assert!(choice.best().error <= 1e-4 && choice.until == 1.0);
        let h = choice.best().control.step().unwrap();
        assert!((choice.best().work - 2.0 / h).abs() < 1e-6);
    }
    options.goal = Goal::Budget(1e4);
    let choice = a3::choose(&decay(2.0), &methods, &options, &()).unwrap();
    assert!(choice.best().milliseconds <= 1e4);
    options.goal = Goal::Budget(0.0);
    let why = usage(a3::choose(&decay(2.0), &methods, &options, &()));
    assert!(why.contains("a budget is a number of milliseconds"), "{why}");
}

#[test]
fn runs_are_compared_at_the_same_times() {
    let own = euler("compare-euler");
    let step = Control::Step(0.125);
    let runs = [(own, step), (find("euler").unwrap(), step), (own, Control::Step(0.25))];
    let found = a3::compare(&decay(1.0), &runs, 1.0, 4, &()).unwrap();
    assert_eq!(found.times, [0.0, 0.25, 0.5, 0.75, 1.0]);
    for (k, state) in found.runs[0].states.iter().enumerate() {
        assert!((state[0] - 0.875f64.powi(2 * k as i32)).abs() < 1e-15);
    }
    assert_eq!(found.runs[0].work, 8.0);
    assert_eq!(found.distance(0, 1), [0.0; 5]);
    let last = found.distance(0, 2)[4];
    assert!((last - (0.875f64.powi(8) - 0.75f64.powi(4))).abs() < 1e-15);
    assert!(found.distance(0, 3).is_empty());

    let cloth = a3::scene("cloth").unwrap();
    let runs = [(own, Control::Step(0.1)), (find("verlet").unwrap(), Control::Step(1e-3))];
    let found = a3::compare(&cloth, &runs, 10.0, 10, &()).unwrap();
    assert!(found.runs[0].blow_up.is_some() && found.runs[0].states.len() < 11);
    assert!(found.runs[1].blow_up.is_none() && found.runs[1].energies.len() == 11);
    assert_eq!(found.distance(0, 1).len(), found.runs[0].states.len());

    let why = usage(a3::compare(&decay(1.0), &[(own, Control::Tolerance(1e-3))], 1.0, 4, &()));
    assert!(why.contains("step"), "{why}");
    usage(a3::compare(&decay(1.0), &[(own, Control::Step(-1.0))], 1.0, 4, &()));
    usage(a3::compare(&decay(1.0), &[(own, step)], f64::NAN, 4, &()));
    usage(a3::compare(&decay(1.0), &[(own, step)], 1.0, 0, &()));
}

#[test]
fn wrong_requests_are_refused_with_one_line() {
    let own = heun("wrong-heun");
    let scene = decay(1.0);
    let refused =
        |scene: &Scene, options: ChartOptions| usage(a3::chart(scene, &[own], &options, &()));
    let of = |error| ChartOptions { error: Some(error), ..until(1.0) };
    for (options, word) in [
        (until(0.0), "the end of"),
        (until(f64::NAN), "the end of"),
        (of(Metric::Energy), "energy"),
        (of(Metric::Position), "state"),
        (ChartOptions { particle: Some(9), ..until(1.0) }, "has no number 9"),
        (ChartOptions { stiffness: vec![2.0], ..until(1.0) }, "no springs"),
        (ChartOptions { stiffness: vec![-1.0], ..until(1.0) }, "factor"),
    ] {
        let why = refused(&scene, options);
        assert!(why.contains(word) && !why.contains('\n'), "{why}");
    }
    assert!(refused(&springs(), of(Metric::State)).contains("position"));
    let short = Scene { state: vec![], ..decay(1.0) };
    assert!(refused(&short, until(1.0)).contains("the system needs 1"));
    let nan = Scene { state: vec![f64::NAN], ..decay(1.0) };
    assert!(refused(&nan, until(1.0)).contains("not finite"));
    assert!(refused(&decay(0.0), until(1.0)).contains("nothing moves"));

    let other = heun("wrong-heun");
    let why = usage(a3::chart(&scene, &[own, other], &until(1.0), &()));
    assert!(why.contains("two methods are called wrong-heun"), "{why}");
    let why = usage(a3::stability(&scene, &[find("verlet").unwrap()], &()));
    assert!(why.contains("needs forces and masses"), "{why}");
    assert!(a3::scene("no such scene").is_err());
}

#[test]
fn failures_of_callbacks_come_out_in_their_own_words() {
    let scene = |from: f64| {
        let f = move |t: f64, y: &[f64], dydt: &mut [f64]| {
            dydt[0] = -y[0];
            if t > from { Err("no data") } else { Ok(()) }
        };
        Scene::new("failing", Ode::new(1, f).unwrap(), vec![1.0])
    };
    let failing = Method::from_step("failing-step", 1, |f, t, y, h| {
        if t > 0.2 {
            return Err(Error::Callback("the step gave up".into()));
        }
        Ok(plus(y, h, &f.at(t, y)?))
    });
    let failing = failing.unwrap().register();
    let own = heun("failing-heun");
    let options = ChooseOptions { until: Some(1.0), ..ChooseOptions::new(Goal::Error(1e-3)) };
    let words = |failure: Option<Failure>| failure.unwrap().to_string();
    for from in [-1.0, 0.5] {
        let all = [
            words(a3::chart(&scene(from), &[own], &until(1.0), &()).err()),
            words(a3::choose(&scene(from), &[own], &options, &()).err()),
            words(a3::stability(&scene(from), &[own], &()).err()),
            words(a3::compare(&scene(from), &[(own, Control::Step(0.1))], 1.0, 2, &()).err()),
        ];
        for why in all {
            assert!(why.ends_with("no data"), "{why}");
        }
    }
    let all = [
        words(a3::chart(&decay(1.0), &[failing], &until(1.0), &()).err()),
        words(a3::choose(&decay(1.0), &[failing], &options, &()).err()),
        words(a3::stability(&decay(1.0), &[failing], &()).err()),
    ];
    for why in all {
        assert_eq!(why, "the step gave up");
    }
    let nan = Method::from_step("nan-step", 1, |_, _, y, _| Ok(vec![f64::NAN; y.len()]));
    let nan = nan.unwrap().register();
    let chart = a3::chart(&decay(1.0), &[nan, own], &until(1.0), &()).unwrap();
    assert!(chart.runs().filter(|run| run.solver == "nan-step").all(|run| run.lost_at.is_some()));
    let why = a3::choose(&decay(1.0), &[nan], &options, &()).err().unwrap();
    assert!(why.to_string().contains("no solver meets"), "{why}");
}

/// Monitor that stops the work after a number of runs.
struct Counting {
    left: AtomicUsize,
    told: AtomicBool,
}

impl Monitor for Counting {
    fn go_on(&self) -> bool {
        self.left.load(Ordering::Relaxed) > 0
    }

    fn advance(&self, _work: f64) {
        let left = self.left.load(Ordering::Relaxed);
        self.left.store(left.saturating_sub(1), Ordering::Relaxed);
    }

    fn stage(&self, _what: &str) {
        self.told.store(true, Ordering::Relaxed);
    }
}

#[test]
fn a_monitor_stops_the_work() {
    let (scene, methods) = (springs(), [heun("monitor-heun"), find("rk4").unwrap()]);
    let no = &|| false;
    let interrupted = |failure: Option<Failure>| matches!(failure, Some(Failure::Interrupted(_)));
    assert!(interrupted(a3::chart(&scene, &methods, &until(1.0), no).err()));
    assert!(interrupted(a3::stability(&scene, &methods, no).err()));
    let options = ChooseOptions::new(Goal::Error(1e-3));
    assert!(interrupted(a3::choose(&scene, &methods, &options, no).err()));
    let runs = methods.map(|method| (method, Control::Step(0.01)));
    let found = a3::compare(&scene, &runs, 1.0, 10, no).unwrap();
    assert!(found.runs.iter().all(|run| run.states.is_empty()));

    let monitor = Counting { left: AtomicUsize::new(3), told: AtomicBool::new(false) };
    let chart = a3::chart(&scene, &methods, &until(1.0), &monitor).unwrap();
    assert!(!chart.is_complete() && monitor.told.into_inner());
    assert!((1..=4).contains(&chart.runs().count()));
    assert!(chart.figure(900, 600).is_ok());
}
