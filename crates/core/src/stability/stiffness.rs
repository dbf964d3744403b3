//! Whether a system is stiff, measured: an explicit and an implicit method take turns.

use crate::error::Error;
use crate::integrators::{Adaptive, Method, Tolerance, Work, find};
use crate::scene::Scene;

/// Tolerance of both runs.
const TOLERANCE: f64 = 1e-6;
/// Work of the explicit method over that of the implicit one, from which on a system is stiff. To a
/// tolerance of 1e-12 instead, the explicit method of order 8 takes 10^(6/8) = 6 times as many
/// steps, if stiffness does not limit them, and the implicit one, whose estimate has order 3,
/// 10^(6/4) = 32 times as many.
const STIFF_RATIO: f64 = 8.0;

/// Returns whether Radau reaches a time (s) with less than an eighth of the work of DOP853, and the
/// work of both. No system is stiff that Radau does not support. `None` if `go_on` returned false.
///
/// # Errors
/// A function of the system failed.
pub(crate) fn is_stiff(
    scene: &Scene,
    until: f64,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<(bool, Work)>, Error> {
    let (system, none) = (scene.model.system(), Work::default());
    let tolerance = Tolerance::new(TOLERANCE)?;
    let radau = find("radau").filter(|method| method.check(system).is_ok());
    let of = |method: Option<&Method>| method.and_then(|m| m.adaptive(system, tolerance));
    let (Some(explicit), Some(implicit)) = (of(find("dop853")), of(radau)) else {
        return Ok(Some((false, none)));
    };
    let begin = |adaptive: Adaptive| Racer {
        adaptive,
        t: 0.0,
        y: scene.state.clone(),
        work: none,
    };
    let mut racers = [explicit, implicit].map(begin);
    loop {
        if !go_on() {
            return Ok(None);
        }
        let [explicit, implicit] = racers.each_ref().map(|racer| racer.work.total());
        let turn = usize::from(explicit > STIFF_RATIO * implicit);
        let arrived = racers[turn].step(scene, until);
        let mut work = none;
        for racer in &racers {
            work += racer.work;
        }
        match arrived {
            Ok(false) => {}
            Ok(true) => return Ok(Some((turn == 1, work))),
            Err(Error::Callback(words)) => return Err(Error::Callback(words)),
            // The other one is left.
            Err(_) => return Ok(Some((turn == 0, work))),
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
    work: Work,
}

impl Racer {
    /// Takes a step. Returns whether it ends at the time `until` (s).
    fn step(&mut self, scene: &Scene, until: f64) -> Result<bool, Error> {
        let system = scene.model.system();
        let taken = self
            .adaptive
            .advance(system, self.t, until - self.t, &mut self.y)?;
        self.t += taken.h;
        self.work += taken.work;
        Ok(self.t >= until)
    }
}
