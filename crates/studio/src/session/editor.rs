//! The tools that edit the scene, with the sizes, speeds and masses of what they add.

use a3_core::Network;
use a3_core::elements::Fluid;
use a3_files::rounding::short;

use super::runs::Runs;

/// Tool that edits the scene where the pointer clicks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    #[default]
    ThrowBall,
    ThrowBox,
    AddBall,
    AddBox,
    Particle,
    Spring,
    Rod,
    Rope,
    Delete,
}

/// Quantity of what a tool adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Diameter of a ball, or edge of a box (m).
    Size,
    /// Speed of a throw (m/s).
    Speed,
    /// Mass of a body (kg).
    Mass,
    /// Mass of a particle (kg).
    PointMass,
    /// Stiffness of a spring (N/m).
    Stiffness,
}

impl Tool {
    /// All tools in the order of their buttons, each with its name, and how it is used.
    pub const ALL: [(Self, &str, &str); 9] = [
        (
            Self::ThrowBall,
            "throw ball",
            "Click where the ball shall hit; drag there to throw it faster.",
        ),
        (
            Self::ThrowBox,
            "throw box",
            "Click where the box shall hit; drag there to throw it faster.",
        ),
        (Self::AddBall, "ball", "Click on what the ball shall lie."),
        (Self::AddBox, "box", "Click on what the box shall stand."),
        (Self::Particle, "particle", "Click where the particle shall be."),
        (Self::Spring, "spring", "Drag from one particle to another to join them by a spring."),
        (
            Self::Rod,
            "rod",
            "Drag from one particle to another to join them by a rod, whose length never changes.",
        ),
        (
            Self::Rope,
            "rope",
            "Drag from one particle to another to join them by a rope, which only pulls.",
        ),
        (
            Self::Delete,
            "delete",
            "Click a particle, a spring, a rod, a rope, a body or an obstacle to delete it.",
        ),
    ];

    /// Returns the quantities that can be set for the tool.
    pub fn measures(self) -> &'static [Measure] {
        match self {
            Self::ThrowBall | Self::ThrowBox => &[Measure::Size, Measure::Speed, Measure::Mass],
            Self::AddBall | Self::AddBox => &[Measure::Size, Measure::Mass],
            Self::Particle => &[Measure::PointMass],
            Self::Spring => &[Measure::Stiffness],
            Self::Rod | Self::Rope | Self::Delete => &[],
        }
    }

    /// Returns whether the tool throws, by a drag the faster.
    pub fn throws(self) -> bool {
        matches!(self, Self::ThrowBall | Self::ThrowBox)
    }

    /// Returns whether the tool joins two particles by a drag.
    pub fn joins(self) -> bool {
        matches!(self, Self::Spring | Self::Rod | Self::Rope)
    }
}

/// Size of a body in a liquid, over the liquid's spacing: the liquid feels such bodies well.
const LAYERS: f64 = 4.0;

/// Mass of a body over the liquid's in a cube of its size, so that a ball floats.
const FLOATING: f64 = 0.25;

/// State of the tools.
#[derive(Default)]
pub struct Editor {
    /// Whether the tools are shown, and act where the mouse is pressed.
    pub open: bool,
    /// The chosen tool.
    pub tool: Tool,
    /// Values of the quantities that fit the scene, and those that are set.
    values: Option<[[f64; 2]; 5]>,
}

impl Editor {
    /// Shows the tools, or hides them.
    pub fn toggle(&mut self, runs: &Runs) {
        self.open = !self.open;
        self.fit(runs);
    }

    /// Gives all quantities values that fit the scene, unless they have some.
    pub fn fit(&mut self, runs: &Runs) {
        let fit = || fitting(runs).map(|value| [value; 2]);
        self.values.get_or_insert_with(fit);
    }

    /// Forgets all values, because the scene is another one.
    pub fn forget(&mut self, runs: &Runs) {
        self.values = self.open.then(|| fitting(runs).map(|value| [value; 2]));
    }

    /// Returns the value that is set for a quantity.
    pub fn value(&self, measure: Measure) -> f64 {
        self.both(measure)[1]
    }

    /// Returns the value of a quantity that fits the scene, and that which is set.
    pub fn both(&self, measure: Measure) -> [f64; 2] {
        self.values.map_or([1.0; 2], |all| all[measure as usize])
    }

    /// Sets the value of a quantity.
    pub fn set(&mut self, measure: Measure, value: f64) {
        if let Some(all) = &mut self.values {
            all[measure as usize][1] = value;
        }
    }
}

/// Returns values of all quantities that fit the scene.
fn fitting(runs: &Runs) -> [f64; 5] {
    let view = runs.panes[0].show.presentation.viewpoint;
    let distance = (view.eye - view.target).norm();
    let network = runs.first().model().network();
    let all = network.map_or(&[][..], Network::masses).iter().enumerate();
    let carried = |i: &usize| network.is_some_and(|network| network.body_of(*i).is_some());
    let free: Vec<_> = all.filter(|(i, _)| !carried(i)).map(|(_, m)| *m).collect();
    let centers = network.into_iter().flat_map(Network::bodies);
    let bodies = centers.map(|body| network.map_or(0.0, |network| network.masses()[body.center()]));
    let (count, points) = (free.len(), free.iter().sum::<f64>());
    let total = points + bodies.sum::<f64>();
    let point = if count == 0 { 0.1 * total } else { points / count as f64 };
    let stiffness = network.and_then(|network| Some(network.springs().next()?.law.stiffness));
    let liquid = network.and_then(Network::fluid).map(Fluid::law);
    let layers = liquid.map_or(0.0, |law| LAYERS * law.spacing);
    let size = short(layers.max(0.035 * distance), 1);
    let values = [
        size,
        1.3 * distance,
        if let Some(law) = liquid {
            FLOATING * law.density * size.powi(law.dimensions.into())
        } else if points > 0.0 {
            0.05 * total
        } else {
            0.5 * total
        },
        point,
        stiffness.unwrap_or(400.0 * point),
    ];
    values.map(|value| short(value.clamp(1e-6, 1e6), 1))
}
