//! The documented scenes of contact, with fewer particles: nothing crosses in a run of any method,
//! and the number of threads changes no bit.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use a3_core::integrators::METHODS;
use a3_core::{Control, Error, Method, Scene, Simulation};
use a3_scenes::{Description, Mesh};

use crate::common::method;

/// Names of scenes in docs/scenes with their texts, what is replaced in these, and the length of
/// their runs (s).
const SCENES: [(&str, &str, &[[&str; 2]], f64); 8] = [
    ("pile", include_str!("../../../../docs/scenes/pile.toml"), &[["[14, 14]", "[6, 6]"]], 0.35),
    (
        "twist",
        include_str!("../../../../docs/scenes/twist.toml"),
        &[["[14, 22]", "[6, 9]"], ["end = 3", "end = 0.4"]],
        0.5,
    ),
    (
        "ball",
        include_str!("../../../../docs/scenes/ball.toml"),
        &[["[24, 24]", "[8, 8]"], ["start = 1", "start = 0.1"]],
        0.4,
    ),
    (
        "drawn",
        include_str!("../../../../docs/scenes/drawn.toml"),
        &[["[20, 20]", "[8, 8]"], ["rate = 1.2", "rate = 6"]],
        0.8,
    ),
    ("knot", include_str!("../../../../docs/scenes/knot.toml"), &[["end = 3", "end = 0.6"]], 0.1),
    (
        "funnel",
        include_str!("../../../../docs/scenes/funnel.toml"),
        &[
            ["[20, 20]", "[8, 8]"],
            ["189, 190, 209, 210", "27, 28, 35, 36"],
            ["start = 0.5, end = 4", "start = 0, end = 0.5"],
        ],
        0.4,
    ),
    ("stack", include_str!("../../../../docs/scenes/stack.toml"), &[["[13, 13]", "[5, 5]"]], 0.2),
    (
        "turning",
        include_str!("../../../../docs/scenes/turning.toml"),
        &[
            ["[16, 16]", "[7, 7]"],
            ["[12, 20]", "[5, 8]"],
            ["end = 3", "end = 0.4"],
            ["duration = 4", "self_collision = true"],
        ],
        0.4,
    ),
];

/// Mesh of a file of docs/scenes.
fn mesh(name: &str) -> Mesh {
    let text = match name {
        "funnel.obj" => include_str!("../../../../docs/scenes/funnel.obj"),
        _ => include_str!("../../../../docs/scenes/ring.obj"),
    };
    let mut mesh = Mesh::default();
    for line in text.lines() {
        let words: Vec<_> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z] => mesh.positions.push([x, y, z].map(|x| x.parse().unwrap())),
            ["f", ref corners @ ..] => {
                let corners: Vec<u32> = corners.iter().map(|k| k.parse().unwrap()).collect();
                for k in 2..corners.len() {
                    let corners = [corners[0], corners[k - 1], corners[k]];
                    mesh.triangles.push(corners.map(|k| k - 1));
                }
            }
            _ => {}
        }
    }
    mesh
}

fn build(text: &str) -> Scene {
    let description = Description::parse(text);
    let setup =
        description.and_then(|description| description.build(None, &mut |name| Ok(mesh(name))));
    setup.unwrap().scene
}

/// The text without damping of springs, which methods for positions alone refuse.
fn undamped(text: &str) -> String {
    let lines = text.lines();
    let damps = |line: &&str| line.starts_with("damping_ratio");
    lines.filter(|line| !damps(line)).flat_map(|line| [line, "\n"]).collect()
}

/// Two steps (s) or tolerances of a method on a scene.
fn values(name: &str, method: &Method) -> [f64; 2] {
    if method.is_adaptive() {
        [1e-2, 1e-3]
    } else if method.is_implicit() || method.needs_springs() {
        [1.0 / 60.0, 1.0 / 120.0]
    } else if name == "knot" {
        [1.0 / 720.0, 1.0 / 1440.0]
    } else {
        [1.0 / 180.0, 1.0 / 360.0]
    }
}

/// Length of a run (s), if there is one: adaptive methods take short steps while surfaces touch.
fn length(name: &str, method: &Method, until: f64) -> Option<f64> {
    if !method.is_adaptive() {
        return Some(until);
    }
    match name {
        "ball" => Some(0.25),
        "funnel" => Some(0.15),
        "stack" => Some(0.01),
        "turning" if method.name == "dopri5" => Some(0.2),
        _ => None,
    }
}

/// Run of a scene, with sixty checks a second whether surfaces cross. Returns whether surfaces
/// touched, and whether the run blew up.
fn run(name: &str, scene: &Scene, method: &'static Method, value: f64, until: f64) -> [bool; 2] {
    let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
    let mut touched = false;
    for k in 1.. {
        let time = f64::min(f64::from(k) / 60.0, until);
        let ran = run.advance_to(time);
        let network = run.model().network().unwrap();
        let (x, _) = run.state().split_at(run.state().len() / 2);
        let crossed = network.crossed(run.time(), x);
        let what = format!("{name}, {} {value}, at {} s", method.name, run.time());
        assert!(crossed.is_empty(), "{what}: {} and more", crossed[0]);
        touched |= run.energy().unwrap().contact > 0.0 || run.guarded().impulses > 0;
        match ran {
            Ok(()) if time < until => {}
            Ok(()) => return [touched, false],
            Err(Error::BlowUp(lost)) => {
                println!("{what}: {lost}");
                return [touched, true];
            }
            Err(error) => panic!("{what}: {error}"),
        }
    }
    unreachable!()
}

#[test]
fn nothing_crosses_in_any_documented_scene_by_any_method() {
    let mut runs = vec![];
    for (name, text, changes, until) in SCENES {
        let mut text = text.to_owned();
        for [from, to] in changes {
            assert!(text.contains(from), "{name} has no {from:?}");
            text = text.replace(from, to);
        }
        let scenes = [build(&text), build(&undamped(&text))];
        for method in METHODS {
            let Some(until) = length(name, method, until) else {
                continue;
            };
            let serves = |scene: &&Scene| method.check(scene.model.system()).is_ok();
            let scene = scenes.iter().find(serves);
            let Some(scene) = scene else {
                // With a tolerance and without velocities, they refuse friction.
                let refuses =
                    method.plain_only() || method.positions_only() && method.is_adaptive();
                assert!(refuses, "{} does not run {name}", method.name);
                continue;
            };
            let values = values(name, method);
            runs.extend(values.map(|value| (name, scene.clone(), method, value, until)));
        }
    }
    let next = AtomicUsize::new(0);
    let work = || {
        let mut found = vec![];
        while let Some((name, scene, method, value, until)) =
            runs.get(next.fetch_add(1, Ordering::Relaxed))
        {
            let [touched, lost] = run(name, scene, method, *value, *until);
            // Explicit Euler makes any motion grow, until it blows up.
            found.push((*name, [touched, lost && method.name != "euler"]));
        }
        found
    };
    let count = thread::available_parallelism().map_or(1, usize::from);
    let found: Vec<_> = thread::scope(|scope| {
        let workers: Vec<_> = (0..count).map(|_| scope.spawn(work)).collect();
        let all = workers.into_iter().flat_map(|worker| worker.join().unwrap());
        all.collect()
    });
    for (scene, ..) in SCENES {
        let touches =
            |(name, [touched, lost]): &(_, [bool; 2])| *name == scene && *touched && !lost;
        assert!(found.iter().any(touches), "nothing touched in {scene}");
    }
    let lost = found.iter().filter(|(_, [_, lost])| *lost).count();
    assert!(10 * lost < runs.len(), "{lost} of {} runs were lost", runs.len());
}

/// A cloth large enough that threads share its rows and its pairs, on a ball and on itself.
#[test]
fn the_number_of_threads_changes_no_bit() {
    let (_, ball, ..) = SCENES[2];
    let text = ball.replace("[24, 24]", "[80, 80]").replace("0.78,", "0.7005,");
    let scene = build(&text);
    let method = method("implicit");
    let states = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let control = Control::Step(1.0 / 60.0);
            let mut run = Simulation::new(scene.clone(), method, control).unwrap();
            run.take_steps(3).unwrap();
            assert!(run.energy().unwrap().contact > 0.0, "nothing touched");
            run.state().to_vec()
        })
    });
    assert!(states.iter().all(|state| *state == states[0]));
}
