//! The table of elements: each force of a network has a line here.

use std::any::Any;

use crate::contact::ContactLayer;
use crate::elements::force::{Force, Matter};
use crate::elements::{
    Airflow, Attraction, BucklingSprings, Cords, Drag, Fluid, Gas, Gravity, OwnForce, Sheet, Solid,
    Springs, Wind,
};

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
            /// Returns the force of the element.
            pub(crate) fn force(&self) -> &dyn Force {
                match self {
                    $(Self::$name(element) => element,)*
                }
            }

            /// Returns the force of the element, to be changed.
            pub(crate) fn force_mut(&mut self) -> &mut dyn Force {
                match self {
                    $(Self::$name(element) => element,)*
                }
            }

            /// Returns the force as one of type T, if it is one: a comparison of variants, once
            /// compiled.
            pub(crate) fn get<T: Any>(&self) -> Option<&T> {
                match self {
                    $(Self::$name(element) => (element as &dyn Any).downcast_ref(),)*
                }
            }

            /// Returns the force as one of type T, to be changed, if it is one.
            pub(crate) fn get_mut<T: Any>(&mut self) -> Option<&mut T> {
                match self {
                    $(Self::$name(element) => (element as &mut dyn Any).downcast_mut(),)*
                }
            }

            /// Returns the position of the element's type in the table, which is the order of
            /// summation.
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

// In the order in which a network sums them.
elements! {
    /// Springs of a grid of particles.
    Sheet,
    /// Single springs.
    Springs,
    /// Bend springs that buckle.
    BucklingSprings,
    /// Springs that only pull.
    Cords,
    /// Fluid of smoothed particles.
    Fluid,
    /// Tetrahedra of an elastic material.
    Solid,
    /// Gas in a closed surface.
    Gas,
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
    /// Repulsion of surfaces that are nearer than their thickness.
    ContactLayer,
    /// A force that is a function.
    OwnForce,
}

impl Element {
    /// Returns whether the force is elastic: springs or a solid.
    pub(crate) fn is_elastic(&self) -> bool {
        matches!(
            self.force().matter(),
            Some(Matter::Springs | Matter::Elastic)
        )
    }

    /// Returns whether the element couples no particles.
    pub(crate) fn is_empty(&self) -> bool {
        self.force().cost().couplings == 0.0
    }
}
