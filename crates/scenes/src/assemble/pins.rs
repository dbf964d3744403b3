//! Pins.

use a3_core::{Pin as Held, Vector3};

use super::motion::motion;
use crate::budget::{Budget, PINS, RODS, SEARCHED};
use crate::check::{at, key_of, positive};
use crate::description::{Pin, Spot};
use crate::fault::Fault;

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
                return Err(Fault::new(
                    "at",
                    "a cloth has top, bottom, left, right, top-left, top-right, bottom-left, bottom-right; a jelly and \
                     a solid top, bottom, left, right; a mesh top, bottom; a chain first, last; others are pinned by `particles`",
                ));
            };
            budget.spend("at", there.len(), PINS)?;
            particles.extend(there);
        }
        if particles.is_empty() {
            let why = "the pin holds nothing: it needs the key `at` or `particles`";
            return Err(Fault::new("", why));
        }
        if pin.turn.as_ref().is_some_and(|turn| turn.about.is_none()) {
            let why = "the turn of a pin needs it: a point of the axis (m)";
            return Err(Fault::new("turn.about", why));
        }
        if let Some(body) = pin.body {
            if pin.sine.is_some() || pin.shift.is_some() || pin.turn.is_some() {
                let why = "what is attached to a body has no motion of its own";
                return Err(Fault::new("body", why));
            }
            if pin.until.is_some() {
                let why =
                    "what is attached to a body stays so; `until` is for what is held in place";
                return Err(Fault::new("until", why));
            }
            budget.spend("body", particles.len(), RODS)?;
            let attached = particles.into_iter().map(|i| (first + i, body));
            self.attached.extend(attached);
            return Ok(());
        }
        if let Some(until) = pin.until {
            at("until", positive("it", until))?;
        }
        for i in particles {
            let (path, _) = motion(
                pin.sine.as_ref(),
                pin.shift.as_ref(),
                pin.turn.as_ref(),
                positions[i],
            )?;
            self.paths.push(Held {
                until: pin.until,
                ..Held::new(first + i, path)
            });
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
    let (low, high) = (
        places().fold(f64::INFINITY, f64::min),
        places().fold(f64::NEG_INFINITY, f64::max),
    );
    let (at, near) = (if far { high } else { low }, 0.01 * (high - low));
    let there = places().enumerate().filter(|(_, y)| (y - at).abs() <= near);
    Some(there.map(|(i, _)| i).collect())
}
