//! Readings of a run: its state, time, cost, energy and extent.

use nalgebra::{DMatrixView, Vector3};

use super::Simulation;
use super::stepper::Kind;
use crate::contact::{Guarded, Statistics};
use crate::control::Control;
use crate::energy::Energy;
use crate::error::BlowUp;
use crate::integrators::{Method, Work};
use crate::network::Network;
use crate::scene::{Model, Scene};

impl Simulation {
    /// The scene as it was built.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The model as it is now: pins led, wind on or off, springs broken.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The method.
    #[must_use]
    pub fn method(&self) -> &'static Method {
        self.state.method
    }

    /// The step or the tolerance.
    #[must_use]
    pub fn control(&self) -> Control {
        self.state.control
    }

    /// The step (s): the fixed one, or the last one under a tolerance, if there was one yet.
    #[must_use]
    pub fn step_size(&self) -> Option<f64> {
        match &self.stepper.kind {
            Kind::Fixed(_) => self.state.control.step(),
            Kind::Adaptive(adaptive) => Some(adaptive.last().h).filter(|h| *h > 0.0),
        }
    }

    /// Simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.state.time()
    }

    /// Steps taken since the beginning.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.state.steps
    }

    /// Cost of these steps.
    #[must_use]
    pub fn work(&self) -> Work {
        self.state.work
    }

    /// Contact during the last step.
    #[must_use]
    pub fn contact(&self) -> Statistics {
        self.phases.contact.last()
    }

    /// Forces of contact on the particles (N), n x 3: those of surfaces as they are now, and the
    /// impulses that obstacles, friction and the guard gave in the last step, divided by its
    /// length. Those are not known after the run went to another state, until the next step.
    /// Nothing if nothing can touch.
    #[must_use]
    pub fn contact_forces(&self) -> Option<Vec<f64>> {
        let network = self.model.network().filter(|n| n.can_touch())?;
        let mut f = vec![0.0; 3 * self.particles()];
        if let Some(layer) = network.contact_layer() {
            let (x, v) = network.halves(&self.state.y);
            layer.add_repulsion(self.time(), x, v, &mut f);
        }
        self.phases.contact.add_forces(&mut f);
        Some(f)
    }

    /// What the guard of surfaces did since the beginning.
    #[must_use]
    pub fn guarded(&self) -> Guarded {
        self.state.guarded
    }

    /// The state y: of a network [x | v], in m and m/s, and after these
    /// the rotation of each rigid body.
    #[must_use]
    pub fn state(&self) -> &[f64] {
        &self.state.y
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.model.particles()
    }

    /// Positions (m), n x 3.
    #[must_use]
    pub fn positions(&self) -> DMatrixView<'_, f64> {
        let n = self.particles();
        DMatrixView::from_slice(&self.state.y[..3 * n], n, 3)
    }

    /// Position of particle i (m).
    #[must_use]
    pub fn position(&self, i: usize) -> Vector3<f64> {
        let n = self.particles();
        Vector3::new(
            self.state.y[i],
            self.state.y[n + i],
            self.state.y[2 * n + i],
        )
    }

    /// Velocities (m/s), column-major: of a mechanical scene from its state, of a first-order one
    /// from f.
    #[must_use]
    pub fn velocities(&self) -> Vec<f64> {
        if let Some(network) = self.model.network() {
            return network.halves(&self.state.y).1.to_vec();
        }
        let mut v = vec![0.0; self.state.y.len()];
        self.model
            .system()
            .eval_f(self.time(), &self.state.y, &mut v);
        v
    }

    /// The energy (J), if the scene has forces.
    #[must_use]
    pub fn energy(&self) -> Option<Energy> {
        let network = self.model.network();
        network.map(|network| network.energy_of(self.time(), &self.state.y))
    }

    /// Height of the lowest particle (m).
    #[must_use]
    pub fn lowest(&self) -> f64 {
        self.positions().column(1).min()
    }

    /// Length over rest length of the most stretched structural spring, or the largest principal
    /// stretch of a solid, if there is any.
    #[must_use]
    pub fn largest_stretch(&self) -> Option<f64> {
        let x = &self.state.y[..3 * self.particles()];
        self.model.network()?.largest_stretch(x)
    }

    /// Number of springs that have broken.
    #[must_use]
    pub fn tears(&self) -> usize {
        self.model.network().map_or(0, Network::tears)
    }

    /// The middle of the scene as it began, and the distance of its farthest particle from there,
    /// at least 1 (m).
    #[must_use]
    pub fn extent(&self) -> (Vector3<f64>, f64) {
        (self.middle, self.radius)
    }

    /// The blow-up by which the run was lost, if it was.
    #[must_use]
    pub fn blow_up(&self) -> Option<BlowUp> {
        self.blow_up
    }
}
