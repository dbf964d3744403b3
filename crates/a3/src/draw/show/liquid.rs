//! The surface of a fluid for the renderer.

use a3_core::Simulation;
use a3_render::{Corner, Style};

use super::colouring::Colouring;
use crate::draw::surfaces;

/// The surface of a fluid.
#[derive(Clone, Default)]
pub struct Liquid {
    corners: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

impl Liquid {
    /// Computes the present surface of the fluid of a run, coloured or not; empty in styles without
    /// surfaces.
    pub fn of(simulation: &Simulation, style: Style, colouring: &Colouring) -> Self {
        if style != Style::Shaded {
            return Self::default();
        }
        let surface = surfaces::Liquid::of(simulation, |i| colouring.share(i));
        let corners = surface.corners.iter().map(|corner| Corner {
            place: corner.place,
            value: corner.value,
            normal: corner.normal,
        });
        Self {
            corners: corners.collect(),
            triangles: surface.triangles,
        }
    }

    /// Returns the surface in the form of the renderer.
    pub fn as_drawn(&self) -> a3_render::Liquid<'_> {
        a3_render::Liquid {
            corners: &self.corners,
            triangles: &self.triangles,
        }
    }
}
