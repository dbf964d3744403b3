//! Events of a step, for those that locate them: where the first is, and which particles rest on
//! obstacles until then.

use super::Simulation;
use super::events::{Event, Searched};
use super::resting;
use super::step::{MAX_PENETRATION, NONE};
use super::stepper::Kind;
use crate::integrators::Work;

impl Simulation {
    /// Finds the first event of a step of h (s) from time t (s) to the state as it is now.
    pub(super) fn first_event(&mut self, t: f64, h: f64) -> Option<Event> {
        let network = self.model.network()?;
        if network.obstacles().is_empty() && network.tear_limit().is_none() {
            return None;
        }
        let shallow = self.shallow();
        let step = Searched {
            network,
            t,
            h,
            ends: [self.phases.contact.y0(), &self.state.y],
            none: NONE * self.radius,
            shallow,
            deepest: MAX_PENETRATION * self.radius,
        };
        if step.ends.iter().any(|y| y.len() != self.state.y.len())
            || self.state.y.iter().any(|y| !y.is_finite())
        {
            return None;
        }
        let (stepper, work) = (&mut self.stepper, &mut self.state.work);
        let y0 = self.phases.contact.y0();
        let (rests, scratch) = self.rests.split();
        let resting = resting::view(&self.model, rests);
        let system = resting.as_ref().map_or(self.model.system(), |view| view);
        let mut state_at = |share: f64, out: &mut [f64]| {
            *work += stepper.state_at(system, t, share * h, y0, out);
            system.hold(t + share * h, out);
        };
        let event = self.events.first(&step, &mut state_at);
        let before = event.map_or(1.0, |event| event.share);
        let state = &mut self.events.state;
        let span = (t, h, step.none);
        let mut evaluated = 0;
        let end = resting::first_end(
            network,
            (rests, scratch),
            span,
            before,
            state,
            &mut |share, out| {
                evaluated += 1;
                state_at(share, out);
            },
        );
        *work += Work::of(evaluated);
        end.or(event)
    }

    /// Lists the particles that rest on obstacles, for steps that locate events.
    pub(super) fn list_rests(&mut self, t: f64) {
        let method = self.state.method;
        let serves = !method.is_implicit() && !method.needs_mechanics() && !method.positions_only();
        let network = self.model.network();
        let network = network.filter(|network| serves && resting::may_rest(network));
        let none = NONE * self.radius;
        let heights = [none, none.max(self.shallow())];
        self.rests.clear();
        if let Some(network) = network.filter(|_| self.stepper.is_adaptive() || self.locates) {
            let evaluated = self.rests.list(network, t, &mut self.state.y, heights);
            self.state.work += Work::of(evaluated);
        }
        // The last evaluation of a step in which others rest is of another system.
        let before = std::mem::replace(&mut self.state.resting, self.rests.fingerprint());
        if let Kind::Adaptive(adaptive) = &mut self.stepper.kind
            && before != self.state.resting
        {
            adaptive.restart();
        }
    }
}
