//! Whether a system is stiff, measured: an explicit and an implicit method take turns.

use crate::error::Error;
use crate::integrators::{Adaptive, Method, Tolerance, Work, find};
use crate::scene::Scene;

/// Tolerances of both runs: the second one if Radau fails with the first, whose errors may lead to
/// another solution.
const TOLERANCES: [f64; 2] = [1e-6, 1e-9];
/// Work of the explicit method over that of the implicit one at the first tolerance, from which on
/// the implicit one counts as cheaper at that tolerance.
const STIFF_RATIO: f64 = 1.4;
/// Negative power of the tolerance with which that ratio grows: the explicit method of order 8
/// takes tolerance^(-1/8) times as many steps, if stiffness does not limit them, and the implicit
/// one, whose estimate has order 3, tolerance^(-1/4) times as many.
const RATIO_POWER: f64 = 1.0 / 4.0 - 1.0 / 8.0;

/// Largest work of all runs of a system of one's own (evaluations), whose time may be of any
/// length.
const MOST: f64 = 1e6;

/// Returns whether Radau is expected to reach a time (s) to a tolerance with less work than DOP853,
/// and the work of finding that out. No system is stiff that Radau does not support, and one with a
/// mass matrix is, which no explicit method supports. `None` if `go_on` returned false.
///
/// # Errors
/// A function of the system failed, or a system of one's own takes more than a million evaluations.
pub(crate) fn is_stiff(
    scene: &Scene,
    until: f64,
    tolerance: f64,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<(bool, Work)>, Error> {
    let mut work = Work::default();
    let ratio = STIFF_RATIO * (TOLERANCES[0] / tolerance).max(1.0).powf(RATIO_POWER);
    if !scene.model.system().mass_matrix().is_empty() {
        return Ok(Some((true, work)));
    }
    for tolerance in TOLERANCES {
        match race(scene, until, (tolerance, ratio), &mut work, go_on)? {
            None => return Ok(None),
            Some(Won::Explicit) => return Ok(Some((false, work))),
            Some(Won::Implicit) => return Ok(Some((true, work))),
            Some(Won::Neither) => {}
        }
    }
    Ok(Some((false, work)))
}

/// End of a race.
enum Won {
    Explicit,
    Implicit,
    /// The implicit method failed before the explicit one arrived.
    Neither,
}

/// Lets both methods race at a tolerance, the explicit one with `ratio` times the work of the
/// implicit one, and adds their work. `None` if `go_on` returned false.
fn race(
    scene: &Scene,
    until: f64,
    (tolerance, ratio): (f64, f64),
    work: &mut Work,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Won>, Error> {
    let (system, tolerance) = (scene.model.system(), Tolerance::new(tolerance)?);
    let radau = find("radau").filter(|method| method.check(system).is_ok());
    let of = |method: Option<&Method>| method.and_then(|m| m.adaptive(system, tolerance));
    let (Some(explicit), Some(implicit)) = (of(find("dop853")), of(radau)) else {
        return Ok(Some(Won::Explicit));
    };
    let begin = |adaptive: Adaptive| Racer { adaptive, t: 0.0, y: scene.state.clone(), work: 0.0 };
    let mut racers = [explicit, implicit].map(begin);
    loop {
        if !go_on() {
            return Ok(None);
        }
        let turn = usize::from(racers[0].work > ratio * racers[1].work);
        let arrived = racers[turn].step(scene, until, work);
        match arrived {
            Ok(false) if scene.model.network().is_none() && work.total() > MOST => {
                let t = racers[0].t.max(racers[1].t);
                return Err(Error::Invalid(format!(
                    "{} takes {MOST:.0e} evaluations up to t = {t:.3e} of {until:.3e}: end the runs earlier",
                    scene.name
                )));
            }
            Ok(false) => {}
            Ok(true) if turn == 0 => return Ok(Some(Won::Explicit)),
            Ok(true) => return Ok(Some(Won::Implicit)),
            Err(Error::Callback(words)) => return Err(Error::Callback(words)),
            // The other one is left.
            Err(_) if turn == 0 => return Ok(Some(Won::Implicit)),
            Err(_) => return Ok(Some(Won::Neither)),
        }
    }
}

/// Returns the method that is the most accurate one for its cost: Radau in a stiff system.
///
/// # Errors
/// Never fails for the table of methods.
pub(crate) fn accurate(is_stiff: bool) -> Result<&'static Method, Error> {
    let none = || Error::Invalid("no accurate method is in the table".into());
    find(if is_stiff { "radau" } else { "dop853" }).ok_or_else(none)
}

/// A method on its way.
struct Racer {
    adaptive: Adaptive,
    t: f64,
    y: Vec<f64>,
    /// Work until now (evaluations).
    work: f64,
}

impl Racer {
    /// Takes a step, and adds its work. Returns whether it ends at the time `until` (s).
    fn step(&mut self, scene: &Scene, until: f64, work: &mut Work) -> Result<bool, Error> {
        let system = scene.model.system();
        let taken = self.adaptive.advance(system, self.t, until - self.t, &mut self.y)?;
        self.t += taken.h;
        self.work += taken.work.total();
        *work += taken.work;
        Ok(self.t >= until)
    }
}
