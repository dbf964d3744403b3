//! Numbers of particles and rigid bodies in a description, after some came or went.

use crate::description::{Description, Pin};
use crate::splice::{Splice, keep};

/// Numbers all particles anew that the scene names, and forgets what names a removed one.
pub(crate) fn particles(description: &mut Description, particles: Splice) {
    let number = |i: usize| particles.number(i);
    let pair = |[i, j]: [usize; 2]| Some([number(i)?, number(j)?]);
    let Description {
        springs,
        constraint,
        pin,
        torn,
        trail,
        ..
    } = description;
    keep(springs, |it| {
        let [i, j] = pair([it.0, it.1])?;
        Some((i, j, it.2, it.3, it.4))
    });
    keep(torn, |it| pair(*it));
    keep(constraint, |it| {
        let mut it = it.clone();
        for ends in [&mut it.rod, &mut it.rope].into_iter().flatten() {
            *ends = pair(*ends)?;
        }
        if let Some(i) = &mut it.particle {
            *i = number(*i)?;
        }
        Some(it)
    });
    for Pin { particles, .. } in pin.iter_mut() {
        keep(particles, |i| number(*i));
    }
    pin.retain(|pin| !pin.particles.is_empty());
    *trail = trail.and_then(number);
}

/// Numbers all rigid bodies anew that joints and pins name, and forgets the joints and the pins of
/// a removed one.
pub(crate) fn bodies(description: &mut Description, bodies: Splice) {
    let number = |k: usize| bodies.number(k);
    keep(&mut description.joint, |it| {
        let mut it = it.clone();
        if let Some(k) = &mut it.body {
            *k = number(*k)?;
        }
        if let Some([k, l]) = &mut it.bodies {
            (*k, *l) = (number(*k)?, number(*l)?);
        }
        Some(it)
    });
    let fit = |pins: &mut Vec<Pin>| {
        keep(pins, |pin| {
            let body = match pin.body {
                Some(k) => Some(number(k)?),
                None => None,
            };
            Some(Pin {
                body,
                ..pin.clone()
            })
        });
    };
    fit(&mut description.pin);
    let pinned = description.bodies_mut().filter_map(|body| body.pin);
    pinned.for_each(fit);
}
