//! The table of elements: a force that is added is a file beside this one, and a line here.

use super::airflow::Airflow;
use super::attraction::Attraction;
use super::buckling::BucklingSprings;
use super::drag::Drag;
use super::fluid::Fluid;
use super::force::Force;
use super::gravity::Gravity;
use super::packed::Packed;
use super::sheet::Sheet;
use super::solid::Solid;
use super::springs::Springs;
use super::wind::Wind;
use crate::contact::ContactLayer;
use crate::spring::Spring;

macro_rules! elements {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// One of the forces of a network.
        #[derive(Clone, Debug)]
        #[expect(clippy::large_enum_variant, reason = "the large one occurs once in a network")]
        #[non_exhaustive]
        pub enum Element {
            $($(#[$doc])* $name($name),)*
        }

        impl Element {
            /// Its force.
            pub(crate) fn force(&self) -> &dyn Force {
                match self {
                    $(Self::$name(element) => element,)*
                }
            }

            /// Its force, to be changed.
            pub(crate) fn force_mut(&mut self) -> &mut dyn Force {
                match self {
                    $(Self::$name(element) => element,)*
                }
            }

            /// The place of its kind in the order of elements.
            pub(crate) fn rank(&self) -> u8 {
                enum Rank {
                    $($name,)*
                }
                match self {
                    $(Self::$name(_) => Rank::$name as u8,)*
                }
            }
        }

        $(impl From<$name> for Element {
            fn from(element: $name) -> Self {
                Self::$name(element)
            }
        })*
    };
}

// In the order in which a network keeps them.
elements! {
    /// Springs of a grid of particles.
    Sheet,
    /// Single springs.
    Springs,
    /// Bend springs that buckle.
    BucklingSprings,
    /// Fluid of smoothed particles.
    Fluid,
    /// Tetrahedra of an elastic material.
    Solid,
    /// Uniform gravity.
    Gravity,
    /// Viscous drag.
    Drag,
    /// Wind that pushes each particle.
    Wind,
    /// Wind that blows on triangles.
    Airflow,
    /// A critically damped spring from a moving point to a particle.
    Attraction,
    /// Repulsion of surfaces that are near.
    ContactLayer,
}

impl Element {
    /// Its springs that do not buckle.
    pub(crate) fn springs(&self) -> impl Iterator<Item = Spring> {
        let single = match self {
            Self::Springs(springs) => springs.all(),
            _ => &[],
        };
        let of_sheet = self.sheet().into_iter().flat_map(Sheet::springs);
        of_sheet.chain(single.iter().copied())
    }

    /// Its springs in blocks, if they are single and many.
    pub(crate) fn packed(&self) -> Option<&Packed> {
        match self {
            Self::Springs(springs) => springs.packed(),
            _ => None,
        }
    }

    /// The fluid, if this element is one.
    pub(crate) fn fluid(&self) -> Option<&Fluid> {
        match self {
            Self::Fluid(fluid) => Some(fluid),
            _ => None,
        }
    }

    /// The contact layer, if this element is one.
    pub(crate) fn contact_layer(&self) -> Option<&ContactLayer> {
        match self {
            Self::ContactLayer(layer) => Some(layer),
            _ => None,
        }
    }

    /// The contact layer, to be changed, if this element is one.
    pub(crate) fn contact_layer_mut(&mut self) -> Option<&mut ContactLayer> {
        match self {
            Self::ContactLayer(layer) => Some(layer),
            _ => None,
        }
    }

    /// The sheet, if it is one.
    pub(crate) fn sheet(&self) -> Option<&Sheet> {
        match self {
            Self::Sheet(sheet) => Some(sheet),
            _ => None,
        }
    }

    /// The solid, if it is one.
    pub(crate) fn solid(&self) -> Option<&Solid> {
        match self {
            Self::Solid(solid) => Some(solid),
            _ => None,
        }
    }

    /// Whether it couples no particles.
    pub(crate) fn is_empty(&self) -> bool {
        self.force().cost().couplings == 0.0
    }

    /// Whether it is elastic, and can be scaled and copied.
    pub(crate) fn is_elastic(&self) -> bool {
        matches!(
            self,
            Self::Sheet(_) | Self::Springs(_) | Self::BucklingSprings(_) | Self::Solid(_)
        )
    }
}
