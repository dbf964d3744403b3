//! The first look of a run, and whether its scene supports it.

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_render::Style;

use super::quantity::{Arrows, Quantity};
use super::springs::has_springs;

/// The first look of a run.
#[derive(Clone, Copy, Default)]
pub struct Manner {
    /// Surface, wires or springs.
    pub style: Style,
    /// The particle whose springs are highlighted.
    pub springs_of: Option<usize>,
    /// Whether the projection is orthographic, not perspective.
    pub orthographic: bool,
    /// Whether the background is dark and text is light.
    pub dark: bool,
    /// Quantity that colours the particles.
    pub colour: Option<Quantity>,
    /// Arrows on particles.
    pub arrows: Option<Arrows>,
}

/// Returns the style of a surface, of its wireframe, or of all springs.
pub fn style(wireframe: bool, springs: bool) -> Style {
    match (wireframe, springs) {
        (false, false) => Style::Shaded,
        (true, false) => Style::Wireframe,
        (_, true) => Style::Springs,
    }
}

/// Checks that the scene has the particle whose springs are requested, if one is.
pub fn check_particle(simulation: &Simulation, particle: Option<usize>) -> Result<(), Failure> {
    match (particle, simulation.model().network()) {
        (Some(i), Some(network)) => {
            network.check_particle(i).map_err(|e| Failure::usage(format!("--springs-of: {e}")))
        }
        (Some(_), None) => Err(Failure::usage("--springs-of: this scene has no springs")),
        (None, _) => Ok(()),
    }
}

/// Checks that the scene supports the requested colours, arrows and springs. `compared` says
/// whether the run is part of a comparison, which has errors.
pub fn check_drawing(
    simulation: &Simulation,
    manner: Manner,
    compared: bool,
) -> Result<(), Failure> {
    let scene = &simulation.scene().name;
    let has_none = |what: &str, option: &str| {
        format!("the scene {scene} has no {what} to show: leave out --{option}")
    };
    let colour = manner.colour.filter(|c| !c.is_in(simulation, compared));
    let arrows = manner.arrows.filter(|a| !a.is_in(simulation));
    let why = match (colour, arrows) {
        (Some(Quantity::Contact), _) => format!(
            "nothing can touch in the scene {scene}: leave out --colour, or let surfaces touch \
             by --self-collision"
        ),
        (Some(Quantity::Error), _) => {
            "errors need a reference, which only a3 compare runs: leave out --colour".into()
        }
        (Some(colour), _) => has_none(colour.name(), "colour"),
        (None, Some(arrows)) => has_none(arrows.name(), "arrows"),
        (None, None) if manner.style == Style::Springs && !has_springs(simulation) => {
            has_none("springs", "springs")
        }
        (None, None) => return Ok(()),
    };
    Err(Failure::usage(why))
}
