//! Passes of friction over the velocities of contacts.
//!
//! Each contact changes velocities that the next ones read, so a processor would wait for the end
//! of one computation before it begins the next. Therefore contacts without rigid bodies are in the
//! order of a greedy colouring, in which those that move the same vertex have different colours:
//! most neighbours then do not interact.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::contact_pair::ContactPair;
use super::rebound::limited_to;
use super::solids::{Field, Masses};
use crate::vectors::Arch;

/// Largest number of passes of friction between surfaces that the contact force keeps apart.
const MAX_PASSES: usize = 20;

/// Share of the largest change of velocity by friction below which a slip counts as zero, so that
/// passes may end early. Only its displacement is undone: the velocity stays, and grows if a slide
/// begins.
pub(super) const STUCK_TOLERANCE: f64 = 1e-4;

/// Largest number of colours. Contacts that would need more have the last one.
const COLOURS: u32 = 64;

/// Repeats a pass until it changes nothing, or the number of passes reaches a limit.
pub(super) fn pass_until_still(mut pass: impl FnMut() -> bool) {
    for _ in 0..MAX_PASSES {
        if pass() {
            break;
        }
    }
}

/// Lets friction stop the slip of contacts, each with its largest impulse (N s), by changes of the
/// velocities v (m/s), and the turns of those that resist them. Returns the impulse (N s) and the
/// angular impulse (N m s) of each. The points of rigid bodies must be settled afterwards.
pub(super) fn hold(
    contacts: &[(ContactPair, f64)],
    masses: Masses,
    v: &mut Field,
) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    // Impulses of each contact so far, which a later pass may reduce.
    let mut all = vec![Vector3::zeros(); contacts.len()];
    let mut turned = all.clone();
    let numbers = in_order(contacts, masses.inverse);
    let mut soft: Vec<_> = numbers
        .iter()
        .map(|number| Soft::new(&contacts[*number], masses.inverse))
        .collect();
    let rigid: Vec<_> = (0..contacts.len())
        .filter(|k| contacts[*k].0.is_rigid())
        .collect();
    pass_until_still(|| {
        let points = &mut v.points;

        let mut still = Arch::new().dispatch(Pass {
            contacts: &mut soft,
            v: points,
        });
        for k in &rigid {
            let (contact, most) = &contacts[*k];
            let slip = contact.slip(v);
            let held = limited_to(all[*k] - slip / contact.mobility(slip), *most);
            let change = held - all[*k];
            contact.push(change, masses, v);
            all[*k] = held;
            still &= change.norm() <= STUCK_TOLERANCE * most;
            if let Some((stopping, most)) = contact.turning(v, 1.0) {
                let held = limited_to(turned[*k] + stopping, most);
                let change = held - turned[*k];
                contact.spin(change, masses, v);
                turned[*k] = held;
                still &= change.norm() <= STUCK_TOLERANCE * most;
            }
        }
        still
    });
    for (number, contact) in numbers.iter().zip(&soft) {
        all[*number] = contact.held;
    }
    (all, turned)
}

/// Lists the numbers of the contacts without rigid bodies, in the order of their colours.
fn in_order(contacts: &[(ContactPair, f64)], inverse_masses: &[f64]) -> Vec<usize> {
    let mut used = vec![0_u64; inverse_masses.len()];
    let mut keys = vec![];
    for (number, (contact, _)) in contacts.iter().enumerate() {
        if contact.is_rigid() {
            continue;
        }
        let points = contact.points.map(|i| i as usize);
        let moved = || points.iter().filter(|i| inverse_masses[**i] > 0.0);
        let taken = moved().fold(0, |all, i| all | used[*i]);
        let colour = taken.trailing_ones().min(COLOURS - 1);
        for i in moved() {
            used[*i] |= 1 << colour;
        }
        keys.push((colour, number));
    }
    keys.sort_unstable();
    keys.into_iter().map(|(_, number)| number).collect()
}

/// Contact without rigid bodies.
struct Soft {
    weights: [f64; 4],
    /// Weights times inverse masses (1/kg).
    mobilities: [f64; 4],
    normal: Vector3<f64>,
    /// Impulse so far (N s).
    held: Vector3<f64>,
    points: [u32; 4],
    /// Effective mass (kg), and the largest impulse of friction (N s).
    mass: f64,
    most: f64,
}

impl Soft {
    fn new((contact, most): &(ContactPair, f64), inverse_masses: &[f64]) -> Self {
        let inverse = contact.points.map(|i| inverse_masses[i as usize]);
        Self {
            weights: contact.weights,
            mobilities: std::array::from_fn(|k| contact.weights[k] * inverse[k]),
            normal: contact.normal,
            held: Vector3::zeros(),
            points: contact.points,
            mass: 1.0 / contact.inverse_mass,
            most: *most,
        }
    }
}

/// Pass over contacts without rigid bodies.
struct Pass<'a> {
    contacts: &'a mut [Soft],
    v: &'a mut [Vector3<f64>],
}

impl WithSimd for Pass<'_> {
    /// Whether no impulse changed by more than a tolerance.
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { contacts, v } = self;
        let mut still = true;
        for contact in contacts {
            let (points, weights) = (contact.points.map(|i| i as usize), contact.weights);
            let relative = v[points[0]] * weights[0]
                + v[points[1]] * weights[1]
                + v[points[2]] * weights[2]
                + v[points[3]] * weights[3];
            let slip = relative - contact.normal * relative.dot(&contact.normal);
            let wanted = contact.held - slip * contact.mass;
            let most = contact.most;
            let squared = wanted.norm_squared();
            let held = if squared > most * most {
                wanted * (most / squared.sqrt())
            } else {
                wanted
            };
            let change = held - contact.held;
            contact.held = held;
            let least = STUCK_TOLERANCE * most;
            still &= change.norm_squared() <= least * least;
            for k in 0..4 {
                let mobility = contact.mobilities[k];
                if mobility != 0.0 {
                    v[points[k]] += change * mobility;
                }
            }
        }
        still
    }
}
