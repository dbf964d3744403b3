//! Pins and the paths of what moves as the scene says.

use a3_core::{Path, Vector3};

use crate::check::{key_of, number, vector};
use crate::description::{Pin, Shift, Sine, Spot};
use crate::fault::Fault;

/// The pinned particles and their paths. `spot` gives the particles of a spot.
pub(super) fn pins(
    pins: &[Pin],
    positions: &[Vector3<f64>],
    spot: impl Fn(Spot) -> Option<Vec<usize>>,
) -> Result<Vec<(usize, Path)>, Fault> {
    let mut all = vec![];
    for (k, pin) in pins.iter().enumerate() {
        let pinned = pinned(pin, positions, &spot);
        let pinned = pinned.map_err(|fault| fault.within(&key_of("pin", k, pins.len())))?;
        all.extend(pinned);
    }
    Ok(all)
}

fn pinned(
    pin: &Pin,
    positions: &[Vector3<f64>],
    spot: impl Fn(Spot) -> Option<Vec<usize>>,
) -> Result<Vec<(usize, Path)>, Fault> {
    let mut particles = pin.particles.clone();
    if let Some(i) = particles.iter().find(|i| **i >= positions.len()) {
        return Err(Fault::no_particle("particles", *i, positions.len()));
    }
    for at in &pin.at {
        let Some(there) = spot(*at) else {
            return Err(Fault::new(
                "at",
                "a cloth has top, bottom, left, right, top-left, top-right, bottom-left, bottom-right; a jelly top, \
                 bottom, left, right; a mesh top, bottom; a chain first, last; others are pinned by `particles`",
            ));
        };
        particles.extend(there);
    }
    if particles.is_empty() {
        return Err(Fault::new(
            "",
            "the pin holds nothing: it needs the key `at` or `particles`",
        ));
    }
    particles
        .into_iter()
        .map(|i| {
            Ok((
                i,
                path(positions[i], pin.sine.as_ref(), pin.shift.as_ref())?,
            ))
        })
        .collect()
}

/// The path that starts at `from` (m).
pub(super) fn path(
    from: Vector3<f64>,
    sine: Option<&Sine>,
    shift: Option<&Shift>,
) -> Result<Path, Fault> {
    match (sine, shift) {
        (None, None) => Ok(Path::Still(from)),
        (Some(sine), None) => Ok(Path::Sine {
            center: match sine.center {
                None => from,
                Some(center) => vector("sine.center", center)?,
            },
            amplitude: vector("sine.amplitude", sine.amplitude)?,
            rate: number("sine.rate", sine.rate)?,
            phase: number("sine.phase", sine.phase)?,
        }),
        (None, Some(shift)) => {
            let by = vector("shift.by", shift.by)?;
            let start = number("shift.start", shift.start)?;
            let end = number("shift.end", shift.end)?;
            if end <= start {
                return Err(Fault::new(
                    "shift.end",
                    format!("it must be later than {start} s, not {end}"),
                ));
            }
            Ok(Path::Line {
                from,
                to: from + by,
                start,
                end,
            })
        }
        (Some(_), Some(_)) => Err(Fault::not_both("sine", "shift")),
    }
}
