//! Liquid that flows in through an opening. It is a column of pinned particles behind the opening,
//! which moves at the speed of the flow. Each layer is let go as it passes the opening, so that the
//! liquid that has flowed in always has its neighbours behind it.

use a3_core::{Path, Pin as Held, Vector3};

use super::places::{LAYERS, Places};
use crate::check::{at, at_least, positive};
use crate::description::{Fluid, Inflow};
use crate::fault::Fault;

/// Column of particles behind an opening.
pub(super) struct Column {
    places: Places,
    /// Middle of the opening (m).
    opening: Vector3<f64>,
    velocity: Vector3<f64>,
    /// Axis and speed (m/s) of the flow.
    axis: usize,
    speed: f64,
    /// Half of the edges of the opening (m).
    half: Vector3<f64>,
    spacing: f64,
    /// Number of layers that flow in.
    layers: f64,
    /// Time for which the liquid has flowed at the start (s).
    ahead: f64,
}

impl Column {
    /// Creates the column of an inflow of a fluid.
    pub fn new(fluid: &Fluid, inflow: &Inflow) -> Result<Self, Fault> {
        let velocity = Vector3::from(inflow.velocity);
        let speed = velocity.norm();
        let axis = (0..3).find(|axis| velocity[*axis].abs() == speed);
        let Some(axis) = axis.filter(|axis| speed > 0.0 && (fluid.dimensions == 3 || *axis < 2))
        else {
            let why = format!(
                "it must be along one of the axes x, y{}, not {:?}",
                if fluid.dimensions == 3 { ", z" } else { "" },
                inflow.velocity
            );
            return Err(Fault::new("velocity", why));
        };
        if inflow.size[axis] != 0.0 {
            let why = format!(
                "along the velocity, the opening has the length 0, not {}",
                inflow.size[axis]
            );
            return Err(Fault::new("size", why));
        }
        at("duration", positive("it", inflow.duration))?;
        at("ahead", at_least(0.0, "it", inflow.ahead))?;
        let layers = (inflow.duration * speed / fluid.spacing).round().max(1.0);
        let mut size = inflow.size;
        // Three more layers close the opening behind the last ones.
        size[axis] = (layers + f64::from(LAYERS)) * fluid.spacing;
        let opening = Vector3::from(inflow.at);
        let middle = opening - velocity * (0.5 * size[axis] / speed);
        Ok(Self {
            places: Places::new(fluid, size, middle.into())?,
            opening,
            velocity,
            axis,
            speed,
            half: 0.5 * Vector3::from(inflow.size),
            spacing: fluid.spacing,
            layers,
            ahead: inflow.ahead,
        })
    }

    /// Counts the particles.
    pub fn count(&self) -> usize {
        self.places.count(0)
    }

    /// Lists the particles, numbered from `first`: their places (m) and velocities (m/s) at the
    /// start, and the pins that hold them then. What has flowed in has flown straight on.
    pub fn particles(
        &self,
        first: usize,
    ) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>, Option<Held>)> {
        let flows_until = self.layers * self.spacing / self.speed - self.ahead;
        let all = self.places.all(0).map(|(place, _)| place);
        all.zip(first..).map(move |(place, i)| {
            let layer = (self.depth(place) / self.spacing - 0.5).round();
            let until = (layer + 0.5) * self.spacing / self.speed - self.ahead;
            let last = layer >= self.layers;
            // The last layers stop where they close the opening.
            let end = if last { flows_until } else { until };
            let gone = if last {
                self.ahead.min(self.ahead + end)
            } else {
                self.ahead
            };
            let here = place + self.velocity * gone;
            if end <= 0.0 {
                let closes = last.then(|| Held::new(i, Path::Still(here)));
                let velocity = if last {
                    Vector3::zeros()
                } else {
                    self.velocity
                };
                return (here, velocity, closes);
            }
            let path = Path::Line {
                from: here,
                to: here + self.velocity * end,
                start: 0.0,
                end,
            };
            let held = Held {
                until: (!last).then_some(until),
                ..Held::new(i, path)
            };
            (here, self.velocity, Some(held))
        })
    }

    /// Returns whether the column passes through a place, so that no wall can be there.
    pub fn passes(&self, place: &Vector3<f64>) -> bool {
        let from = place - self.opening;
        let slack = 1e-6 * self.spacing;
        let across = (0..3).filter(|axis| *axis != self.axis);
        let mut is_within = across.map(|axis| from[axis].abs() <= self.half[axis] + slack);
        let length = (self.layers + f64::from(LAYERS)) * self.spacing;
        is_within.all(|is| is) && (-slack..=length + slack).contains(&self.depth(*place))
    }

    /// Returns the distance (m) of a place behind the opening.
    fn depth(&self, place: Vector3<f64>) -> f64 {
        (self.opening - place).dot(&self.velocity) / self.speed
    }
}
