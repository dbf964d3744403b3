//! A short run of a scene, and the failures that it must not have.

use a3_core::integrators::METHODS;
use a3_core::{Control, Energy, Error, Simulation};
use a3_scenes::Setup;

use crate::chance::Chance;

/// Number of steps of a run.
const STEPS: u64 = 20;

/// Number of methods that are tried until one serves a scene.
const TRIES: usize = 5;

/// Energy relative to that at the beginning, above which a scene has exploded.
const EXPLODED: f64 = 100.0;

/// Speed (m/s) below which motion is invisible.
pub const INVISIBLE_SPEED: f64 = 1e-3;

/// How a run ended.
#[derive(Debug, PartialEq)]
pub enum Ended {
    Well,
    /// Ended with an error or a warning.
    Told,
}

/// Whether anything does work on a scene except its own forces.
fn is_driven(text: &str) -> bool {
    "sine shift turn wind torque".split(' ').any(|word| text.contains(word))
}

/// Checks that an error is a line, and not a whole file.
pub fn check_said(why: &str) -> Result<(), String> {
    if why.is_empty() || why.len() > 400 || why.contains('\n') {
        return Err(format!("this is no clear line: {why:?}"));
    }
    Ok(())
}

/// Runs a scene by a random method, of which it informs `begins`. Returns how the run ended.
pub fn run(
    text: &str,
    setup: &Setup,
    chance: &mut Chance,
    mut begins: impl FnMut(&str),
) -> Result<Ended, String> {
    let mut made = None;
    for _ in 0..TRIES {
        // One that serves networks, if it does not refuse this one.
        let methods: Vec<_> = METHODS.iter().filter(|m| !m.plain_only()).collect();
        let method = methods[chance.below(methods.len())];
        let control = match method.default_control {
            Control::Step(h) => Control::Step(h * chance.within((0.01, 3.0, true))),
            Control::Tolerance(_) => Control::Tolerance(chance.within((1e-9, 1e-2, true))),
        };
        begins(&format!("{} {control:?}", method.name));
        match Simulation::new(setup.scene.clone(), method, control) {
            Ok(run) => {
                made = Some(run);
                break;
            }
            Err(why) => check_said(&why.to_string())?,
        }
    }
    let Some(mut run) = made else {
        return Ok(Ended::Told);
    };
    run.set_swinging(chance.once_in(8));
    let begin = run.energy();
    let gone = steps(&mut run);
    if !run.state().iter().all(|y| y.is_finite()) {
        return Err("the state is not finite".into());
    }
    if let Err(why) = gone {
        check_said(&why.to_string())?;
        return Ok(Ended::Told);
    }
    let driven = run.swinging() || is_driven(text);
    if let (Some(begin), Some(end), false) = (begin, run.energy(), driven) {
        let fallen = (begin.gravitational - end.gravitational).max(0.0);
        // A gas under pressure sets in motion what its own energy at the start does not tell.
        let released = (begin.elastic - end.elastic).max(0.0);
        let own = own_energy(&run, begin) + fallen + released;
        let gained = end.total() - begin.total();
        if gained.is_nan() || gained > EXPLODED * own {
            let worst = run.worst_constraint();
            let is_broken = worst.is_some_and(|unmet| unmet.is_visible());
            if is_broken || run.gained().is_some() {
                return Ok(Ended::Told);
            }
            return Err(format!("{gained:e} J of {own:e} J: {end:?}"));
        }
    }
    Ok(Ended::Well)
}

/// Takes whole steps, and ends within a step. Implicit methods end on a whole step: they can turn a
/// body by half a turn in a step, and interpolation would change its shape.
fn steps(run: &mut Simulation) -> Result<(), Error> {
    run.take_steps(STEPS - 1)?;
    let before = run.time();
    run.take_steps(1)?;
    if !run.method().is_implicit() {
        run.advance_to(run.time() + 0.3 * (run.time() - before))?;
    }
    run.conclude()
}

/// Returns the energy (J) that a run may have which began with `begin`: its initial energy, the
/// work of gravity over the size of the scene, and the energy of errors within the tolerance and of
/// invisible motion.
fn own_energy(run: &Simulation, begin: Energy) -> f64 {
    let Some(network) = run.model().network() else {
        return 1.0;
    };
    let (mass, (_, radius)) = (network.masses().iter().sum::<f64>(), run.scene().extent());
    let weight = network.gravity().map_or(0.0, |g| g.norm()) * mass;
    let mut tolerated = 0.0;
    if let Some(tolerance) = run.control().tolerance() {
        let (mut off, mut chance) = (run.scene().state.clone(), Chance(1));
        let (error, before) = (tolerance * radius, network.energy_of(0.0, &off).elastic);
        for x in &mut off[..3 * network.particles()] {
            *x += chance.within((-error, error, false));
        }
        tolerated = network.energy_of(0.0, &off).elastic - before;
    }
    let moving = begin.kinetic + begin.elastic + begin.contact;
    moving.max(0.0) + weight * radius + tolerated.max(0.0) + 0.5 * mass * INVISIBLE_SPEED.powi(2)
}
