//! One particle whose velocity is its position turned by a right angle, f = (-y, x, 0): a circle for ever.
//! Three numbers are its whole state.

use std::sync::Arc;

use nalgebra::Vector3;

use super::{Model, Scene, SceneEntry, View};
use crate::system::ParticleSystem;

pub(super) const ENTRY: SceneEntry = SceneEntry {
    name: "simple",
    summary: "one particle on a circle, first order: f = (-y, x, 0)",
    grid: None,
    make: |_| {
        Ok(Scene {
            name: "simple".into(),
            model: Model::FirstOrder(Arc::new(Circle)),
            state: vec![1.0, 0.0, 0.0],
            grid: None,
            surface: Arc::default(),
            swing: None,
            wind: None,
            trail: Some(0),
            view: View {
                eye: Vector3::new(0.0, 0.0, 6.5),
                target: Vector3::zeros(),
            },
            step_scale: 1.0,
            reach: 10.0,
        })
    },
};

struct Circle;

impl ParticleSystem for Circle {
    fn dim(&self) -> usize {
        3
    }

    fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt.copy_from_slice(&[-y[1], y[0], 0.0]);
    }
}
