//! Paths and turns of pins and obstacles with a prescribed motion.

use a3_core::{Path, Turn, Vector3};

use crate::check::one_of;
use crate::description;
use crate::description::{Shift, Sine};
use crate::fault::Fault;

/// Creates the path of a pin or an obstacle that begins at `from` (m), and its turn.
pub(super) fn motion(
    sine: Option<&Sine>,
    shift: Option<&Shift>,
    spun: Option<&description::Turn>,
    from: Vector3<f64>,
) -> Result<(Path, Option<Turn>), Fault> {
    let turn = spun.map(turn).transpose();
    let turn = turn.map_err(|fault| fault.within("turn"))?;
    let about = spun.and_then(|turn| turn.about).map(Vector3::from);
    let path = match (turn.zip(about), sine, shift) {
        (_, Some(_), Some(_)) => return Err(Fault::not_both("sine", "shift")),
        (Some(_), Some(_), None) => return Err(Fault::not_both("sine", "turn.about")),
        (Some((turn, about)), None, shift) => {
            let (by, [start, end]) = match shift {
                None => (Vector3::zeros(), [0.0; 2]),
                Some(shift) => way(shift)?,
            };
            Path::Turn {
                turn,
                arm: from - about,
                from: about,
                to: about + by,
                start,
                end,
            }
        }
        (None, None, None) => Path::Still(from),
        (None, Some(sine), None) => Path::Sine {
            center: match sine.center {
                None => from,
                Some(center) => Vector3::from(center),
            },
            amplitude: Vector3::from(sine.amplitude),
            rate: sine.rate,
            phase: sine.phase,
        },
        (None, None, Some(shift)) => {
            let (by, [start, end]) = way(shift)?;
            Path::Line {
                from,
                to: from + by,
                start,
                end,
            }
        }
    };
    Ok((path, turn))
}

/// Returns the displacement of a shift (m), and its start and end (s).
fn way(shift: &Shift) -> Result<(Vector3<f64>, [f64; 2]), Fault> {
    let by = Vector3::from(shift.by);
    later("shift.end", shift.start, shift.end)?;
    Ok((by, [shift.start, shift.end]))
}

fn later(key: &str, start: f64, end: f64) -> Result<(), Fault> {
    if end > start {
        return Ok(());
    }
    let why = format!("it must be later than {start} s, not {end}");
    Err(Fault::new(key, why))
}

fn turn(turn: &description::Turn) -> Result<Turn, Fault> {
    let axis = Vector3::from(turn.axis);
    let Some(axis) = axis.try_normalize(0.0) else {
        let why = "it must be a direction, not [0, 0, 0]";
        return Err(Fault::new("axis", why));
    };
    let start = turn.start;
    if let Some(end) = turn.end {
        later("end", start, end)?;
    }
    let rate = match (
        one_of(("rate", turn.rate), ("angle", turn.angle))?,
        turn.end,
    ) {
        ((true, rate), _) => rate,
        ((false, angle), Some(end)) => angle / (end - start),
        ((false, _), None) => {
            let why = "with an `angle`, it is needed: the time at which the turn ends (s)";
            return Err(Fault::new("end", why));
        }
    };
    Ok(Turn {
        axis,
        rate,
        start,
        end: turn.end,
    })
}
