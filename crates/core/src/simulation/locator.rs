//! The first event that ends a step: a touch, a tear, a rope that tightens or slackens, a joint at
//! its end, or the end of a contact.

use nalgebra::Vector3;

use super::depths::Depths;
use super::events::{Event, EventKind, Events, Searched};
use super::resting::{Resting, Rests, first_end, first_negative, may_rest};
use super::state::RunState;
use super::stepper::Stepper;
use crate::constraints::OneSided;
use crate::contact::{Obstacle, Shape};
use crate::elements::Outflow;
use crate::integrators::Work;
use crate::interval::Interval;
use crate::network::{Network, has_ropes, least_tension, open_ends, outflows, taut};
use crate::path::Path;
use crate::scene::Model;
use crate::system::ParticleSystem;

/// Number of intervals of a step at whose ends joints are looked at.
const INTERVALS: u32 = 16;

/// Search for the first event of a step.
pub(super) struct Locator {
    /// Whether fixed steps are split at events too: always in a network with ropes.
    pub splits_fixed_steps: bool,
    events: Events,
    /// Outflows of the fluid, as obstacles.
    outflows: Vec<Obstacle>,
    /// Particles that rest on obstacles in the current step.
    rests: Rests,
}

impl Locator {
    /// Creates a search in a model, with room for all its particles.
    pub fn new(model: &Model) -> Self {
        let outflows = model.network().map_or(&[][..], outflows).iter();
        Self {
            splits_fixed_steps: model.network().is_some_and(has_ropes),
            events: Events::new(model),
            outflows: outflows.map(obstacle).collect(),
            rests: Rests::new(model),
        }
    }

    /// Returns whether events are located in the steps of a stepper.
    pub fn serves(&self, stepper: &Stepper) -> bool {
        stepper.is_adaptive() || self.splits_fixed_steps
    }

    /// Returns whether fixed steps are split into parts, each up to an event.
    pub fn splits(&self, stepper: &Stepper) -> bool {
        self.splits_fixed_steps && !stepper.is_adaptive()
    }

    /// Returns a view of the model in which particles rest, if any do.
    pub fn view<'a>(&'a self, model: &'a Model) -> Option<Resting<'a>> {
        self.rests.view(model)
    }

    /// Returns the state at the event that was found.
    pub fn state(&self) -> &[f64] {
        &self.events.state
    }

    /// Lists the particles that rest on obstacles at time t (s), for steps that locate events.
    pub fn list_rests(
        &mut self,
        model: &Model,
        state: &mut RunState,
        stepper: &mut Stepper,
        t: f64,
        depths: Depths,
    ) {
        let method = state.method;
        let serves = !method.is_implicit() && !method.needs_mechanics() && !method.positions_only();
        let network = model.network();
        let network = network.filter(|network| serves && may_rest(network));
        self.rests.clear();
        if let Some(network) = network.filter(|_| self.serves(stepper)) {
            let evaluated = self.rests.list(network, t, &mut state.y, depths);
            state.work += Work::of(evaluated);
        }
        // If other particles rest, the last evaluation of the step before is of another system.
        let before = std::mem::replace(&mut state.resting, self.rests.fingerprint());
        if before != state.resting {
            stepper.forget();
        }
    }

    /// Returns the sum of the magnitudes of the impulses (N s) of moving obstacles on the particles
    /// that rest on them in a step of h (s) that ends now, at time t (s).
    pub fn impulse(&mut self, model: &Model, state: &mut RunState, times: (f64, f64)) -> f64 {
        let Some(network) = model.network() else {
            return 0.0;
        };
        let (impulse, evaluated) = self.rests.impulse(network, times, &state.y);
        state.work += Work::of(evaluated);
        impulse
    }

    /// Finds the first event of a step of h (s) from time t (s), from y0 to the current state.
    pub fn first_event(
        &mut self,
        model: &Model,
        state: &mut RunState,
        stepper: &mut Stepper,
        y0: &[f64],
        Interval { t, h }: Interval,
        depths: Depths,
    ) -> Option<Event> {
        let network = model.network()?;
        let has_ropes = has_ropes(network);
        let is_none = network.solids().is_empty() && self.outflows.is_empty();
        if is_none && network.tear_limit().is_none() && !has_ropes {
            return None;
        }
        let RunState { y, work, .. } = state;
        let step = Searched { network, outflows: &self.outflows, t, h, ends: [y0, y], depths };
        if y0.len() != y.len() || y.iter().any(|y| !y.is_finite()) {
            return None;
        }
        let (rests, scratch) = self.rests.split();
        let resting = Resting::of(model, rests);
        let system = resting.as_ref().map_or(model.system(), |view| view);
        let mut state_at = |share: f64, out: &mut [f64]| {
            *work += stepper.state_at(system, t, share * h, y0, out);
            system.hold(t + share * h, out);
        };
        let event = self.events.first(&step, rests, &mut state_at);
        let before = event.map_or(1.0, |event| event.share);
        let state = &mut self.events.state;
        let span = (t, h, depths.none);
        let mut evaluated = 0;
        let stop = if has_ropes { first_stop(&step, before, state, &mut state_at) } else { None };
        let event = stop.or(event);
        let before = event.map_or(1.0, |event| event.share);
        let end = first_end(network, (rests, scratch), span, before, state, &mut |share, out| {
            evaluated += 1;
            state_at(share, out);
        });
        let slackens = if has_ropes {
            let at = &mut |share: f64, out: &mut [f64]| {
                evaluated += 1;
                state_at(share, out);
            };
            first_slack(network, Interval { t, h }, before, state, at)
        } else {
            None
        };
        *work += Work::of(evaluated);
        let end = end.map(|share| Event { share, kind: EventKind::Rested });
        slackens.or(end).or(event)
    }
}

/// Returns an outflow as an obstacle.
fn obstacle(outflow: &Outflow) -> Obstacle {
    let shape =
        Shape::Box { half_extents: outflow.half, axes: [Vector3::x(), Vector3::y(), Vector3::z()] };
    Obstacle::smooth(shape, Path::Still(outflow.at))
}

/// Finds where a joint first reaches one of its ends before the share `before` of a step, on the
/// step's polynomial, unless that lasts for less than one of some intervals. Writes the state there
/// to `state`.
fn first_stop(
    step: &Searched,
    before: f64,
    state: &mut Vec<f64>,
    state_at: &mut dyn FnMut(f64, &mut [f64]),
) -> Option<Event> {
    let Searched { network, h, .. } = *step;
    let [begun, ended] = step.ends.map(|y| open_ends(network, y));
    // Half of the most by which an error can leave its chord.
    let is_near = |(a, b): (&OneSided, &OneSided)| {
        a.value.max(b.value) + 0.5 * h * (a.rate.abs() + b.rate.abs()) > 0.0
    };
    if !begun.iter().zip(&ended).any(is_near) {
        return None;
    }
    let none = step.depths.none;
    // A joint that begins at its end or beyond has passed it a little later.
    let passed = |value: f64| {
        if -value > none { 0.0 } else { none.max(value + 1e-3 * none) }
    };
    let mut found = vec![0.0; network.dim()];
    let mut margin = |share: f64| {
        state_at(share, &mut found);
        let now = open_ends(network, &found);
        let left = begun.iter().zip(&now).map(|(begun, now)| passed(begun.value) - now.value);
        left.fold(f64::INFINITY, f64::min)
    };
    let ends = (1..=INTERVALS).map(|k| before * f64::from(k) / f64::from(INTERVALS));
    let end = ends.into_iter().find(|share| margin(*share) < 0.0)?;
    let share = first_negative(end, &mut margin)?;
    state.resize(network.dim(), 0.0);
    state_at(share, state);
    // Where a joint passes its end although its velocity leads away, the step is too long for the
    // flight that begins with it: the polynomial has the velocity of a later time.
    let now = open_ends(network, state);
    let passes = |(begun, now): (&OneSided, &OneSided)| {
        begun.value > -none && now.value >= passed(begun.value) && now.rate < 0.0
    };
    let is_flight = begun.iter().zip(&now).any(passes);
    let kind = if is_flight { EventKind::Sunk } else { EventKind::Rested };
    Some(Event { share, kind })
}

/// Finds where a taut rope slackens before the share `before` of a step of h (s) from t (s), on the
/// step's polynomial. Writes the state there to `state`.
fn first_slack(
    network: &Network,
    Interval { t, h }: Interval,
    before: f64,
    state: &mut Vec<f64>,
    state_at: &mut dyn FnMut(f64, &mut [f64]),
) -> Option<Event> {
    taut(network).next()?;
    let mut found = vec![0.0; network.dim()];
    let mut margin = |share: f64| {
        state_at(share, &mut found);
        least_tension(network, t + share * h, &found).map_or(0.0, |(_, tension)| tension)
    };
    if margin(before) >= 0.0 || margin(0.0) <= 0.0 {
        return None;
    }
    let share = first_negative(before, &mut margin)?;
    state.resize(network.dim(), 0.0);
    state_at(share, state);
    Some(Event { share, kind: EventKind::Rested })
}
