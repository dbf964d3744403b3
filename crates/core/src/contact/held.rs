//! Impacts of particles that constraints hold. Each acts as the constraints lie at its time: at the
//! end of a step for what strikes there, at its time for a rebound within the step, and in the
//! middle for contact that lasts for the step, which is then of order 2.

use super::contact_pair::{ContactPair, LeastSpeed};
use super::impact::{Blow, solve};
use super::met::{Noted, PointImpact, SIMULTANEOUS_SHARE, Step};
use super::response::{JoinedBodies, Joints, Tie};
use super::solids::Field;
use crate::columns::{row, set_row};
use crate::interval::Interval;

/// Applies the noted impacts to y1, the end of a step, with the impulses of the constraints: first
/// the contacts that last for the step; then the rebounds within the step and the impacts at its
/// end, `struck`, in order of time, each together with the lasting contacts.
pub(super) fn pass_on(
    noted: &mut Noted,
    struck: Vec<PointImpact>,
    (inverse_masses, step): (&[f64], &Step),
    y1: &mut [f64],
) {
    let Some(joints) = noted.joints.filter(|_| !(noted.held.is_empty() && struck.is_empty()))
    else {
        return;
    };
    let n = inverse_masses.len();
    let (rebounds, lasting): (Vec<_>, Vec<_>) =
        noted.held.drain(..).partition(|impact| impact.left > 0.0);
    // A particle that strikes an obstacle at the end of the step did not touch it before.
    let strikes = |impact: &PointImpact| {
        let own = |it: &PointImpact| (it.particle, it.obstacle);
        struck.iter().any(|it| own(it) == own(impact))
    };
    let lasting: Vec<_> = lasting.into_iter().filter(|it| !strikes(it)).collect();
    let mut sudden: Vec<_> = rebounds.into_iter().chain(struck).collect();
    sudden.sort_by(|a, b| a.share.total_cmp(&b.share));
    let free = y1[3 * n..6 * n].to_vec();
    apply(noted, (joints, &lasting), (inverse_masses, step), y1);
    let lasted = y1[3 * n..6 * n].to_vec();
    for group in sudden.chunk_by_mut(|a, b| b.share - a.share <= SIMULTANEOUS_SHARE) {
        let speed = |i: usize| row(&y1[3 * n..], n, i);
        for impact in &mut *group {
            let i = impact.particle;
            let after = row(&lasted, n, i);
            impact.add((after - row(&free, n, i)) * impact.share + speed(i) - after);
        }
        let PointImpact { share, left, .. } = group[0];
        let others = lasting.iter().map(|contact| {
            let before = speed(contact.particle) - contact.carried;
            let LeastSpeed { speed, friction, .. } = contact.least;
            let least = LeastSpeed::of_impact(before, speed, friction);
            PointImpact { least, share, left, ..contact.clone() }
        });
        let together: Vec<_> = group.iter().cloned().chain(others).collect();
        apply(noted, (joints, &together), (inverse_masses, step), y1);
    }
}

/// Applies impacts at one time to y1, the end of a step. Notes how much the velocities would differ
/// if the constraints lay as they do at the end of the step, and by how much the friction of slides
/// turns in it.
fn apply(
    noted: &mut Noted,
    (joints, impacts): (&dyn Joints, &[PointImpact]),
    (inverse_masses, step): (&[f64], &Step),
    y1: &mut [f64],
) {
    if impacts.is_empty() {
        return;
    }
    let n = inverse_masses.len();
    let mut blows: Vec<_> = (impacts.iter())
        .map(|impact| {
            let points = ([impact.particle as u32; 4], [1.0, 0.0, 0.0, 0.0]);
            let mut contact =
                ContactPair::with_arms(points, impact.normal, inverse_masses, &[None, None]);
            let mut y = y1.to_vec();
            for (x, begun) in y[..3 * n].iter_mut().zip(step.y0) {
                *x += (begun - *x) * (1.0 - impact.share);
            }
            let is_smooth = impact.least.friction == 0.0 && impact.push == impact.normal;
            contact.join(JoinedBodies { joints, y: &y }, is_smooth, inverse_masses, &[]);
            contact.push_along(impact.push);
            let is_free = impact.least.speed > 0.0;
            Blow::new(contact, impact.least, is_free, impact.carried)
        })
        .collect();
    let mut before = Field::still(n, 0);
    for i in 0..n {
        before[i] = row(&y1[3 * n..], n, i);
    }
    // A rebound leaves a part of the step after it, and a strike acts at the end of the step.
    let lasts = impacts.iter().all(|impact| impact.left == 0.0 && impact.share < 1.0);
    let times = Interval { t: step.t, h: step.h };
    let mut ties =
        Tie::all(JoinedBodies { joints, y: y1 }, &[], &before, Some(times).filter(|_| lasts));
    let mut changes = Field::still(n, 0);
    let moving = (inverse_masses, &[][..]);
    solve(blows.iter_mut(), &mut ties, &mut changes, moving);
    let mut moves = Field::still(n, 0);
    let left = impacts.iter().map(|impact| impact.left).fold(0.0, f64::max);
    for tie in &ties {
        tie.push(left, &mut moves);
    }
    for (impact, blow) in impacts.iter().zip(&blows) {
        blow.contact.push(blow.impulse * impact.left, inverse_masses, &mut moves);
        if blow.is_free {
            blow.note(&changes, joints);
        }
        noted.add_contact(impact.particle, blow.impulse);
    }
    let mut end = y1.to_vec();
    for i in 0..n {
        set_row(&mut end[3 * n..], n, i, changes[i]);
    }
    joints.fit(&mut end);
    let apart = (0..n).map(|i| (row(&end[3 * n..], n, i) - changes[i]).norm() * step.h);
    let turned = blows.iter().map(|blow| 0.5 * blow.turned(&changes).norm() * step.h);
    let missed = &mut noted.statistics.missed;
    *missed = apart.chain(turned).fold(*missed, f64::max);
    let (x, v) = y1.split_at_mut(3 * n);
    for i in 0..n {
        set_row(x, n, i, row(x, n, i) + moves[i]);
        set_row(v, n, i, row(v, n, i) + changes[i]);
    }
}
