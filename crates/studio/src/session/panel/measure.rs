//! Measurement of the parts of a scene on its own thread: what each costs in a step, and how much
//! it changes the motion from the present state on.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;
use web_time::{Duration, Instant};

use a3_core::integrators::find;
use a3_core::{Checkpoint, Control, Error, Method, Simulation};

use super::parts::{is_in, set};
use super::tune::{leave_out_named, tuned, turn_knobs};
use super::values::pane;
use crate::session::{
    Beginning, Deviation, Effect, Job, Origin, Session, Situation, continue_from,
};

/// Simulated time over which motions are compared (s).
const COMPARED_TIME: f64 = 2.0;
/// Number of states in that time at which they are compared.
const FRAMES: u32 = 40;
/// Longest computing time of all accurate runs together.
const COMPARING_TIME: Duration = Duration::from_secs(3);
/// Relative tolerances of the accurate runs: that of all, and that of another run of the present
/// scene, which shows the error.
const TOLERANCES: [f64; 2] = [1e-5, 1e-4];
/// Longest computing time of the steps that show what a part costs.
const TIMING_TIME: Duration = Duration::from_millis(80);
/// Least computing time of the steps between two readings of the clock.
const SAMPLE_TIME: Duration = Duration::from_millis(1);
/// Longest simulated time of these steps (s).
const MAX_SAMPLE_TIME: f64 = 0.05;

/// Data from which the measured run is built on another thread.
struct Task {
    origin: Origin,
    tuned: Vec<(String, f64)>,
    moment: Checkpoint,
    method: &'static Method,
    control: Control,
}

/// Positions of the particles (m) at each frame: all x, all y, all z.
type Track = Vec<Vec<f64>>;

/// Starts to measure the parts of the scene, or ends that, and says why if it is impossible.
pub fn toggle(session: &mut Session) {
    if session.effects.progress().is_some() {
        return session.effects.forget();
    }
    begin(session);
}

/// Starts to measure the parts of the scene, in the run of the panel's pane.
pub fn begin(session: &mut Session) {
    let pane = pane(session);
    let run = &session.runs.panes[pane].simulation;
    if run.blow_up().is_some() {
        return session
            .readings
            .say("This run has blown up: reset it (key r).");
    }
    let at = situation(session, pane);
    let task = Task {
        origin: session.scenes.shown.clone(),
        tuned: tuned(session),
        moment: run.moment(),
        method: run.method(),
        control: run.control(),
    };
    let ended = Arc::new(AtomicBool::new(false));
    let (sender, effects) = channel();
    let go_on = {
        let ended = ended.clone();
        move || !ended.load(Ordering::Relaxed)
    };
    let work = move || measure_all(task, &sender, &go_on);
    match thread::Builder::new().spawn(work) {
        Ok(_) => {
            let parts = session.tuning.parts.len();
            session.effects.begin(parts, Job::new(effects, ended), at);
        }
        Err(_) => session
            .readings
            .say("There are no threads here to measure on."),
    }
}

/// Collects the new measurements of the thread, and discards all of them if the scene has changed.
pub fn update(session: &mut Session) {
    if let Some(pane) = session.effects.pane() {
        let (now, time) = situation(session, pane);
        session.effects.update(&now, time);
    }
}

/// Returns the situation of a pane, and its simulated time (s).
fn situation(session: &Session, pane: usize) -> (Situation, f64) {
    let run = &session.runs.panes[pane].simulation;
    (Situation::of(pane, run, tuned(session)), run.time())
}

/// Builds the scene of a task, and measures each of its parts as long as `go_on` allows.
fn measure_all(task: Task, effects: &Sender<(usize, Effect)>, go_on: &dyn Fn() -> bool) {
    let (method, control) = (task.method, task.control);
    let Some(mut session) = session_of(task) else {
        return;
    };
    let parts = session.tuning.parts.len();
    let present = session.runs.first();
    let Ok(mut own) = copy(present, method, control) else {
        return;
    };
    let budget = COMPARING_TIME / (parts as u32 + 2);
    let accurate = accurate_method(present);
    let track_of = |run: &Simulation, tolerance| -> Option<Track> {
        let mut run = copy(run, accurate?, Control::Tolerance(tolerance)).ok()?;
        Some(follow(&mut run, budget, go_on))
    };
    let [track, rough] = TOLERANCES.map(|tolerance| track_of(present, tolerance));
    for part in 0..parts {
        let is_there = is_in(&session, part);
        let mut effect = Effect::default();
        if set(&mut session, part, !is_there).is_ok() {
            let other = session.runs.first();
            if let Ok(mut other) = copy(other, method, control) {
                let times = times(&mut [&mut own, &mut other], go_on);
                effect.cost = times.map(|[own, other]| {
                    if is_there {
                        1.0 - other / own
                    } else {
                        1.0 - own / other
                    }
                });
            }
            let other = track_of(other, TOLERANCES[0]);
            effect.change = deviation(track.as_ref(), rough.as_ref(), other.as_ref());
        }
        let sent = go_on() && effects.send((part, effect)).is_ok();
        if !sent || set(&mut session, part, is_there).is_err() {
            return;
        }
    }
}

/// Creates a session without a window in the state of a task.
fn session_of(task: Task) -> Option<Session> {
    let setup = task.origin.build().ok()?;
    let run = Simulation::new(setup.scene.clone(), task.method, task.control).ok()?;
    let beginning = Beginning::default();
    let mut session = Session::new(task.origin, &setup, vec![run], &beginning).ok()?;
    leave_out_named(&mut session, &task.tuned).ok()?;
    session.restore(&task.moment).ok()?;
    turn_knobs(&mut session, &task.tuned);
    Some(session)
}

/// Returns the adaptive method that integrates a run accurately, if one supports it.
fn accurate_method(run: &Simulation) -> Option<&'static Method> {
    let names = ["verner65", "dopri5"].into_iter();
    let supports = |method: &&'static Method| method.check(run.model().system()).is_ok();
    names.filter_map(find).find(supports)
}

/// Creates a run that continues from the state of another one by a method.
fn copy(run: &Simulation, method: &'static Method, control: Control) -> Result<Simulation, Error> {
    let mut copy = Simulation::new(run.scene().clone(), method, control)?;
    continue_from(&mut copy, run)?;
    Ok(copy)
}

/// Advances a run from frame to frame within a budget of computing time, and returns its positions
/// as far as it got.
fn follow(run: &mut Simulation, budget: Duration, go_on: &dyn Fn() -> bool) -> Track {
    let (begun, start) = (Instant::now(), run.time());
    let n = 3 * run.particles();
    let mut track = vec![];
    // Within a frame, the clock is read often, because steps may be short.
    let slices = 10 * FRAMES;
    for k in 1..=slices {
        let time = start + COMPARED_TIME * f64::from(k) / f64::from(slices);
        if begun.elapsed() >= budget || !go_on() || run.advance_to(time).is_err() {
            break;
        }
        if k % 10 == 0 {
            track.push(run.state()[..n].to_vec());
        }
    }
    track
}

/// Compares the motion of the present scene, also by a rough run, with that of another one, over
/// the time that all reached.
fn deviation(
    own: Option<&Track>,
    rough: Option<&Track>,
    other: Option<&Track>,
) -> Option<Deviation> {
    let (own, rough, other) = (own?, rough?, other?);
    let frames = own.len().min(rough.len()).min(other.len());
    if frames == 0 {
        return None;
    }
    let largest = |track: &Track| {
        let pairs = own.iter().zip(track).take(frames);
        let distances = pairs.map(|(a, b)| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
            (squares.sum::<f64>() / (a.len() / 3) as f64).sqrt()
        });
        distances.fold(0.0, f64::max)
    };
    Some(Deviation {
        distance: largest(other),
        error: largest(rough),
        time: COMPARED_TIME * frames as f64 / f64::from(FRAMES),
    })
}

/// Measures the computing time of a simulated second in each of two runs, in turns from the same
/// states: the shortest of several. `None` if a run blows up, or if `go_on` ends it.
fn times(runs: &mut [&mut Simulation; 2], go_on: &dyn Fn() -> bool) -> Option<[f64; 2]> {
    let moments = [0, 1].map(|k| runs[k].moment());
    let begun = Instant::now();
    let (mut best, mut counts) = ([f64::INFINITY; 2], [1; 2]);
    for round in 0_u32.. {
        for (k, moment) in moments.iter().enumerate() {
            let run = &mut *runs[k];
            run.rewind(moment).ok()?;
            let (start, clock) = (run.time(), Instant::now());
            run.take_steps(counts[k]).ok()?;
            let (elapsed, simulated) = (clock.elapsed(), run.time() - start);
            // The first steps of a run list pairs and analyse matrices.
            if round > 0 {
                best[k] = best[k].min(elapsed.as_secs_f64() / simulated);
            }
            if elapsed < SAMPLE_TIME && 2.0 * simulated < MAX_SAMPLE_TIME {
                counts[k] *= 2;
            }
        }
        if round > 0 && begun.elapsed() > TIMING_TIME {
            break;
        }
        if !go_on() {
            return None;
        }
    }
    Some(best)
}
