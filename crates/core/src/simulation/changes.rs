//! Changes of the network at the ends of steps and of their parts: velocities jump with pins, ropes
//! tighten and slacken, springs break, liquid flows out, and pins let go.

use super::depths::{Depths, NEGLIGIBLE_SHARE};
use super::power::energy_of;
use super::state::RunState;
use super::step::Pipeline;
use crate::integrators::Work;
use crate::network::{
    Jump, Least, Network, entered, fit, has_ropes, jump_near, next_release, pass_to, settle,
    slacken, taut, tighten,
};
use crate::scene::Model;

impl Pipeline {
    /// Applies the impacts of ropes that tighten at time t (s), with or without rebounds, and
    /// accounts for the energy that is lost in them.
    pub(super) fn tighten(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        t: f64,
        rebounds: bool,
    ) {
        let Model::Network(network) = model else {
            return;
        };
        if !has_ropes(network) || state.y.iter().any(|y| !y.is_finite()) {
            return;
        }
        let least = self.least(state, rebounds);
        self.jump(network, state, t, |network, y| tighten(network, t, y, least));
    }

    /// Makes velocities fit, and accounts for the work, where the velocity of a pin that
    /// constraints hold jumps at time t (s), or so near that no step ends between.
    fn follow_pins(&mut self, model: &mut Model, state: &mut RunState, t: f64) {
        if let Model::Network(network) = model
            && let Some(time) = jump_near(network, t, state.sliver())
        {
            let least = self.least(state, true);
            self.jump(network, state, t, |network, y| fit(network, t.max(time), y, least));
            self.watch.forget_power();
        }
    }

    /// Does so without an account.
    pub(super) fn fit_at_jump(&self, model: &mut Model, state: &mut RunState, t: f64) {
        if let Model::Network(network) = model
            && let Some(time) = jump_near(network, t, state.sliver())
        {
            self.fit(network, state, t.max(time));
        }
    }

    /// Makes velocities fit the constraints at time t (s), where something else has changed them.
    pub(super) fn fit(&self, network: &mut Network, state: &mut RunState, t: f64) {
        let least = self.least(state, true);
        fit(network, t, &mut state.y, least);
    }

    /// Returns the conditions for rebounds of ropes.
    fn least(&self, state: &RunState, rebounds: bool) -> Least {
        let depths = Depths::new(self.bounds.radius, self.limits, state.control);
        Least {
            none: depths.none,
            height: depths.none.max(depths.shallow),
            time: state.control.step().unwrap_or(0.0),
            rebounds,
        }
    }

    /// Changes velocities in the state y at time t (s), and accounts for the work and for the
    /// energy that ropes lose when they tighten.
    fn jump(
        &mut self,
        network: &mut Network,
        state: &mut RunState,
        t: f64,
        jump: impl FnOnce(&mut Network, &mut [f64]) -> Option<Jump>,
    ) {
        let before = energy_of(network, t, &state.y).total();
        if let Some(jump) = jump(network, &mut state.y) {
            let after = energy_of(network, t, &state.y).total();
            state.balance.add(jump.work);
            if jump.tightened {
                state.balance.allow(after - before - jump.work);
            }
            self.watch.forget_power();
            self.stepper.forget();
        }
    }

    /// Changes the network or the state y at time t (s), and accounts for the change of energy.
    /// `change` returns whether it has changed anything.
    fn change(
        &mut self,
        network: &mut Network,
        state: &mut RunState,
        t: f64,
        change: impl FnOnce(&mut Network, &mut [f64]) -> bool,
    ) {
        let before = energy_of(network, t, &state.y).total();
        if change(network, &mut state.y) {
            let after = energy_of(network, t, &state.y).total();
            state.balance.allow(after - before);
            self.watch.forget_power();
            self.stepper.forget();
        }
    }

    /// Decides which ropes are taut from time t (s) on; just after an impact, which of them still
    /// are.
    pub(super) fn choose_taut(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        t: f64,
        is_after_impact: bool,
    ) {
        let Model::Network(network) = model else {
            return;
        };
        let before: Vec<_> = taut(network).collect();
        let none = Depths::new(self.bounds.radius, self.limits, state.control).none;
        state.work += Work::of(if is_after_impact {
            slacken(network, t, &state.y)
        } else {
            settle(network, t, &state.y, none)
        });
        if !taut(network).eq(before) {
            self.stepper.forget();
        }
    }

    /// Breaks springs that are stretched too far at the end of a step, or were located to be there,
    /// and accounts for the change of energy. Before the run has arrived at that end, a state shown
    /// within the step still has these springs.
    fn tear(&mut self, model: &mut Model, state: &mut RunState) {
        let share = if self.locator.serves(&self.stepper) { NEGLIGIBLE_SHARE } else { 0.0 };
        if let Model::Network(network) = model
            && network.is_overstretched(network.halves(&state.y).0, share)
        {
            let t = state.end();
            self.change(network, state, t, |network, y| {
                network.tear(&y[..3 * network.particles()], share) > 0
            });
            self.stepper.refit(state.method, model.system());
        }
    }

    /// Lets particles leave the fluid that are in its outflows at time t (s), where the run has
    /// arrived, and accounts for their energy.
    fn drain(&mut self, model: &mut Model, state: &mut RunState, t: f64) {
        let none = Depths::new(self.bounds.radius, self.limits, state.control).none;
        if let Model::Network(network) = model
            && entered(network, &state.y, none).next().is_some()
        {
            self.change(network, state, t, |network, y| network.drain(y, none));
            self.stepper.refit(state.method, model.system());
        }
    }

    /// Breaks springs, lets liquid flow out and lets go of pins at the end of a step.
    pub(super) fn end_step(&mut self, model: &mut Model, state: &mut RunState) {
        self.change_at(model, state, state.end());
    }

    /// Does so at time t (s), where the run has arrived.
    pub(super) fn change_at(&mut self, model: &mut Model, state: &mut RunState, t: f64) {
        self.tear(model, state);
        self.drain(model, state, t);
        self.let_go(model, state, t);
        self.follow_pins(model, state, t);
    }

    /// Lets go of pins at time t (s), where the run has arrived, and accounts for the energy of
    /// their particles, which does not count while they are held.
    fn let_go(&mut self, model: &mut Model, state: &mut RunState, t: f64) {
        if let Model::Network(network) = model
            && next_release(network) <= t
        {
            self.change(network, state, t, |network, _| pass_to(network, t));
        }
    }
}
