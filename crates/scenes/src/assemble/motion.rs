//! Paths and turns of pins and obstacles with a prescribed motion, and pins.

use a3_core::{Path, Pin as Held, Turn, Vector3};

use crate::budget::{Budget, PINS, RODS, SEARCHED};
use crate::description;
use crate::description::{Pin, Shift, Sine, Spot};
use crate::fault::{Fault, at, key_of, one_of, positive};

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
            let way = shift.map(way).transpose()?;
            let (by, [start, end]) = way.unwrap_or_default();
            Path::Turn { turn, arm: from - about, from: about, to: about + by, start, end }
        }
        (None, None, None) => Path::Still(from),
        (None, Some(sine), None) => Path::Sine {
            center: sine.center.map_or(from, Vector3::from),
            amplitude: Vector3::from(sine.amplitude),
            rate: sine.rate,
            phase: sine.phase,
        },
        (None, None, Some(shift)) => {
            let (by, [start, end]) = way(shift)?;
            Path::Line { from, to: from + by, start, end }
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
        refuse!("axis": "it must be a direction, not [0, 0, 0]");
    };
    let start = turn.start;
    if let Some(end) = turn.end {
        later("end", start, end)?;
    }
    let (by_rate, number) = one_of(("rate", turn.rate), ("angle", turn.angle))?;
    let rate = match turn.end {
        _ if by_rate => number,
        Some(end) => number / (end - start),
        None => refuse!("end":
            "with an `angle`, it is needed: the time at which the turn ends (s)"),
    };
    Ok(Turn { axis, rate, start, end: turn.end })
}

/// What holds particles.
#[derive(Default)]
pub(super) struct Pinned {
    /// Particles on paths.
    pub paths: Vec<Held>,
    /// Particles that are attached to rigid bodies, with the numbers of these.
    pub attached: Vec<(usize, usize)>,
}

impl Pinned {
    /// Adds pins of particles that are counted from `first`. `spot` finds the particles of a spot.
    pub fn add(
        &mut self,
        first: usize,
        pins: &[Pin],
        positions: &[Vector3<f64>],
        budget: &mut Budget,
        spot: impl Fn(Spot) -> Option<Vec<usize>>,
    ) -> Result<(), Fault> {
        for (k, pin) in pins.iter().enumerate() {
            let added = self.add_one(first, pin, positions, budget, &spot);
            added.map_err(|fault| fault.within(&key_of("pin", k, pins.len())))?;
        }
        Ok(())
    }

    fn add_one(
        &mut self,
        first: usize,
        pin: &Pin,
        positions: &[Vector3<f64>],
        budget: &mut Budget,
        spot: impl Fn(Spot) -> Option<Vec<usize>>,
    ) -> Result<(), Fault> {
        let mut particles = pin.particles.clone();
        budget.spend("particles", particles.len(), PINS)?;
        if let Some(i) = particles.iter().find(|i| **i >= positions.len()) {
            return Err(Fault::no_particle("particles", *i, positions.len()));
        }
        for place in &pin.at {
            budget.spend("at", positions.len(), SEARCHED)?;
            let Some(there) = spot(*place) else {
                refuse!("at": "a cloth has top, bottom, left, right, top-left, top-right, bottom-left, bottom-right; a jelly and \
                     a solid top, bottom, left, right; a mesh top, bottom; a chain first, last; others are pinned by `particles`");
            };
            budget.spend("at", there.len(), PINS)?;
            particles.extend(there);
        }
        refuse!(if particles.is_empty() => "":
            "the pin holds nothing: it needs the key `at` or `particles`");
        refuse!(if pin.turn.as_ref().is_some_and(|turn| turn.about.is_none()) => "turn.about":
            "the turn of a pin needs it: a point of the axis (m)");
        if let Some(body) = pin.body {
            refuse!(if pin.sine.is_some() || pin.shift.is_some() || pin.turn.is_some() => "body":
                "what is attached to a body has no motion of its own");
            refuse!(if pin.until.is_some() => "until":
                "what is attached to a body stays so; `until` is for what is held in place");
            budget.spend("body", particles.len(), RODS)?;
            let attached = particles.into_iter().map(|i| (first + i, body));
            self.attached.extend(attached);
            return Ok(());
        }
        if let Some(until) = pin.until {
            at("until", positive("it", until))?;
        }
        for i in particles {
            let (sine, shift, turn) = (pin.sine.as_ref(), pin.shift.as_ref(), pin.turn.as_ref());
            let (path, _) = motion(sine, shift, turn, positions[i])?;
            self.paths.push(Held { until: pin.until, ..Held::new(first + i, path) });
        }
        Ok(())
    }
}

/// Returns the axis across a side, and whether it is the far side; `None` if the spot is no side.
pub(super) fn side(spot: Spot) -> Option<(usize, bool)> {
    match spot {
        Spot::Left => Some((0, false)),
        Spot::Right => Some((0, true)),
        Spot::Bottom => Some((1, false)),
        Spot::Top => Some((1, true)),
        _ => None,
    }
}

/// Finds the outermost particles on a side, to within a hundredth of the body's extent; `None` if
/// the spot is no side.
pub(super) fn extreme(spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>> {
    let (axis, far) = side(spot)?;
    let places = || positions.iter().map(|p| p[axis]);
    let low = places().fold(f64::INFINITY, f64::min);
    let high = places().fold(f64::NEG_INFINITY, f64::max);
    let (at, near) = (if far { high } else { low }, 0.01 * (high - low));
    let there = places().enumerate().filter(|(_, y)| (y - at).abs() <= near);
    Some(there.map(|(i, _)| i).collect())
}
