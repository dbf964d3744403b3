//! Alarms of energy that nothing put in, checked by runs at a tenth of the step.

use std::time::Instant;

use a3_core::integrators::METHODS;
use a3_core::{Cause, Control, Energy, Method, Simulation};
use a3_scenes::Setup;

use crate::chance::Chance;
use crate::grammar::Grammar;
use crate::run::INVISIBLE_SPEED;
use crate::{LONGEST, MOST_PARTICLES, build, numbered, time_taken, told};

/// Default number of scenes. `A3_SCENES` sets another, and `A3_FIRST` the number of the first.
const SCENES: usize = 150;

/// Number of times at which energies are compared.
const LOOKS: usize = 40;

/// Number of steps between them.
const STEPS: u64 = 5;

/// Gain over the energy that moves below which an alarm is false, and above which silence is.
const LIMITS: [f64; 2] = [0.03, 0.2];

/// Course of a run: its energies at the looks, and the gain that it tells (J), if any.
struct Course {
    energies: Vec<Energy>,
    alarm: Option<f64>,
    is_lost: bool,
}

/// Returns the energy of a run, without the kinetic energy of its pins: their motion is prescribed.
fn energy(run: &Simulation) -> Option<Energy> {
    let (network, v) = (run.model().network()?, run.velocities());
    let (n, mut energy) = (network.particles(), run.energy()?);
    for k in (0..3 * n).filter(|k| network.is_pinned(k % n)) {
        energy.kinetic -= 0.5 * network.masses()[k % n] * v[k].powi(2);
    }
    Some(energy)
}

/// Runs a scene, and looks at its energy at these times, as far as it gets.
fn course(
    setup: &Setup,
    method: &'static Method,
    control: Control,
    times: &[f64],
) -> Option<Course> {
    let mut run = Simulation::new(setup.scene.clone(), method, control).ok()?;
    let (mut energies, begun) = (vec![energy(&run)?], Instant::now());
    let before = time_taken(begun);
    for time in times {
        // Such a scene tells too little for its time.
        if time_taken(begun).saturating_sub(before) > LONGEST {
            return None;
        }
        if run.advance_to(*time).is_err() {
            break;
        }
        energies.push(energy(&run)?);
    }
    let lost = run.blow_up().map(|lost| lost.cause);
    let alarm = match lost {
        Some(Cause::Gained { energy, .. }) => Some(energy),
        _ => run.gained().map(|gain| gain.energy),
    };
    Some(Course { energies, alarm, is_lost: lost.is_some() })
}

/// Returns the largest exchange between kinds of energy in a course (J).
fn exchanged(energies: &[Energy]) -> f64 {
    let width = |kind: fn(&Energy) -> f64| {
        let all = || energies.iter().map(kind);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    let kinetic = energies.iter().map(|e| e.kinetic).fold(0.0, f64::max);
    let elastic = width(|e| e.elastic + e.contact);
    let others = [width(|e| e.gravitational), width(Energy::total)];
    others.into_iter().fold(kinetic.max(elastic), f64::max)
}

/// Returns a sentence about the alarm of scene k if it is false, or missing.
fn fault(k: usize, grammar: &Grammar) -> Option<String> {
    let mut chance = Chance(k as u64);
    let (mut scene, _) = grammar.table("", &mut chance);
    let write = |scene: &serde_json::Value| toml::to_string(scene).unwrap();
    let setup = build(&write(&scene)).ok()??;
    if setup.scene.model.particles() > MOST_PARTICLES {
        return None;
    }
    numbered::add(grammar, &mut scene, &setup, &mut chance);
    let setup = build(&write(&scene)).ok()??;
    // One that serves networks, if it does not refuse this one.
    let methods: Vec<_> = METHODS.iter().filter(|m| !m.plain_only()).collect();
    let method = methods[chance.below(methods.len())];
    let h = method.default_control.step()? * chance.within((0.1, 10.0, true));
    let times: Vec<_> = (1..=LOOKS).map(|k| k as f64 * STEPS as f64 * h).collect();
    let own = course(&setup, method, Control::Step(h), &times)?;
    let fine = course(&setup, method, Control::Step(0.1 * h), &times)?;
    // A run that fails is known by that.
    if own.alarm.is_none() && own.energies.len() <= LOOKS || fine.energies.len() <= LOOKS {
        return None;
    }
    let mass: f64 = setup.scene.model.network()?.masses().iter().sum();
    if exchanged(&fine.energies) < 0.5 * mass * INVISIBLE_SPEED.powi(2) {
        return None;
    }
    let both = own.energies.iter().zip(&fine.energies);
    let gained = both.map(|(own, fine)| own.total() - fine.total());
    let moves = exchanged(&fine.energies[..own.energies.len()]);
    let share = gained.fold(0.0, f64::max) / moves;
    let own_share = exchanged(&own.energies) / exchanged(&fine.energies);
    if std::env::var("A3_TELL").is_ok() {
        println!("{k} {} {:?} {share} {own_share}", method.name, own.alarm);
    }
    let why = match own.alarm {
        // Energy at the end of a run that is lost is told by the run itself.
        Some(told) if own.is_lost && told < moves && fine.alarm.is_none() => {
            format!("a false alarm of {told} J: {moves} J move")
        }
        Some(told) if !own.is_lost && share < LIMITS[0] && fine.alarm.is_none() => {
            format!("a false alarm of {told} J: it gained {share}")
        }
        None if share > LIMITS[1] => format!("silent at a gain of {share} ({own_share})"),
        _ => return None,
    };
    let text = write(&scene);
    Some(format!("scene {k}, {} {h}: {why}\n{text}", method.name))
}

#[test]
fn alarms_of_energy_are_true() {
    let (scenes, first) = (told("A3_SCENES", SCENES), told("A3_FIRST", 0));
    let grammar = Grammar::new();
    let all = first..first + scenes;
    let faults: Vec<_> = all.filter_map(|k| fault(k, &grammar)).collect();
    for fault in &faults {
        println!("{fault}");
    }
    assert!(faults.is_empty(), "{} of {scenes}", faults.len());
}
