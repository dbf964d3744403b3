//! Contact of a network's surfaces.

use super::Network;
use super::crossed::Description;
use crate::contact::{ContactLayer, Crossed, Skin, Surface};
use crate::elements::Element;
use crate::error::Error;

/// What of a network can touch, beside its triangles and obstacles.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// Skin of each particle.
    pub skins: Vec<Skin>,
    /// Edges that are in no triangle, such as those of a rope. An edge with equal ends is a point.
    pub edges: Vec<[u32; 2]>,
    /// Whether bodies touch one another and themselves, or obstacles alone.
    pub bodies: bool,
}

impl Network {
    /// Lets surfaces touch, or, as in a new network, pass through one another: then only obstacles
    /// are solid, and only to particles.
    ///
    /// # Errors
    /// There is not one skin for each particle, or a number of one is negative or not finite; or an
    /// edge has an end that does not exist.
    pub fn set_touch(&mut self, touch: Option<Touch>) -> Result<(), Error> {
        if let Some(touch) = &touch {
            if touch.skins.len() != self.particles() {
                return Err(Error::Dimension {
                    expected: self.particles(),
                    found: touch.skins.len(),
                });
            }
            touch.skins.iter().try_for_each(Skin::check)?;
            for i in touch.edges.iter().flatten() {
                self.check_particle(*i as usize)?;
            }
        }
        self.touch = touch;
        self.renew_contact();
        Ok(())
    }

    /// What can touch, if surfaces do.
    #[must_use]
    pub fn touch(&self) -> Option<&Touch> {
        self.touch.as_ref()
    }

    /// Whether anything can touch: particles obstacles, or surfaces one another.
    #[must_use]
    pub fn can_touch(&self) -> bool {
        !self.obstacles.is_empty() || self.touch.as_ref().is_some_and(|touch| touch.bodies)
    }

    /// The contact of surfaces, if they touch.
    #[must_use]
    pub fn contact_layer(&self) -> Option<&ContactLayer> {
        self.elements.iter().find_map(Element::contact_layer)
    }

    /// The surfaces that pass through one another at time t (s) at x (m), n x 3, also where nothing
    /// keeps them from it, because surfaces do not touch.
    #[must_use]
    pub fn crossed(&self, t: f64, x: &[f64]) -> Vec<Crossed> {
        if let Some(layer) = self.contact_layer() {
            return layer.crossed(t, x);
        }
        let skins = vec![Skin::default(); self.particles()];
        let surface = Surface::new(
            &skins,
            &self.triangles,
            &[],
            &self.bodies,
            &self.obstacles,
            true,
        );
        ContactLayer::new(surface, self.obstacles.clone()).crossed(t, x)
    }

    /// `Ok` if no surfaces pass through one another at time t (s) at x (m), n x 3.
    ///
    /// # Errors
    /// Surfaces cross: the message names the first pair of triangles or edges, its place, and the
    /// connected parts that cross. Or too many are at one place to be tested pair by pair.
    pub fn check_apart(&self, t: f64, x: &[f64]) -> Result<(), Error> {
        if let Some(layer) = self.contact_layer() {
            let thickest = layer.surface().thickest();
            if layer.is_crowded(t, x, 0.0) {
                let why = "too many surfaces are at the same place for contact: move them apart";
                return Err(Error::Invalid(why.into()));
            }
            if layer.is_crowded(t, x, thickest) {
                return Err(Error::Invalid(format!(
                    "too many surfaces are within their thickness of one another for contact: it is up to {thickest} m, \
                     and a smaller one would do"
                )));
            }
        }
        let crossed = self.crossed(t, x);
        if crossed.is_empty() {
            return Ok(());
        }
        let network = self;
        let description = Description {
            network,
            x,
            crossed: &crossed,
        };
        Err(Error::Invalid(description.to_string()))
    }

    /// Half the largest thickness (m) of surfaces that touch; infinite if none do.
    pub(super) fn reach_of_contact(&self) -> f64 {
        let thickest = self.contact_layer().map(|layer| layer.surface().thickest());
        let reach = thickest.filter(|thickness| *thickness > 0.0);
        reach.map_or(f64::INFINITY, |thickness| 0.5 * thickness)
    }

    /// Makes the contact of surfaces anew, of the triangles and obstacles that are there now.
    pub(super) fn renew_contact(&mut self) {
        let layer = self.touch.as_ref().map(|touch| {
            let is_whole = |[a, b]: &[u32; 2]| !self.is_torn(*a as usize, *b as usize);
            let edges: Vec<_> = touch.edges.iter().copied().filter(is_whole).collect();
            let surface = Surface::new(
                &touch.skins,
                &self.triangles,
                &edges,
                &self.bodies,
                &self.obstacles,
                touch.bodies,
            );
            ContactLayer::new(surface, self.obstacles.clone()).into()
        });
        self.replace(|element| matches!(element, Element::ContactLayer(_)), layer);
    }
}
