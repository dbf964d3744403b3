//! The usual mistakes in the forces of a program, each with a question to its author.

use super::constant::Change;

/// Mistake in the forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mistake {
    /// Constant that is another.
    Constant(Change),
    GravityAsForce,
    NotNormalised,
    StretchAsRatio,
    FirstEndOnly,
    SecondEndOnly,
    DampingAcross,
    DragPerMass,
    UnitMasses,
    ForcesKept,
    PinsMove,
    NoShearSprings,
    NoBendSprings,
}

impl Mistake {
    /// All mistakes but constants.
    pub const ALL: [Self; 12] = [
        Self::GravityAsForce,
        Self::NotNormalised,
        Self::StretchAsRatio,
        Self::FirstEndOnly,
        Self::SecondEndOnly,
        Self::DampingAcross,
        Self::DragPerMass,
        Self::UnitMasses,
        Self::ForcesKept,
        Self::PinsMove,
        Self::NoShearSprings,
        Self::NoBendSprings,
    ];

    /// Returns the mistake in a few words, which follow "with".
    pub fn words(self) -> String {
        let words = match self {
            Self::Constant(change) => return change.words(),
            Self::GravityAsForce => "a weight that does not depend on the mass",
            Self::NotNormalised => "spring directions that are not normalised",
            Self::StretchAsRatio => "stretch as a ratio of lengths",
            Self::FirstEndOnly => "spring forces on the first end only",
            Self::SecondEndOnly => "spring forces on the second end only",
            Self::DampingAcross => "damping of the whole relative velocity",
            Self::DragPerMass => "drag that grows with the mass",
            Self::UnitMasses => "forces not divided by the masses",
            Self::ForcesKept => "forces that are never cleared",
            Self::PinsMove => "pins that move",
            Self::NoShearSprings => "no shear springs",
            Self::NoBendSprings => "no bend springs",
        };
        words.into()
    }

    /// Returns the question to the author.
    pub fn question(self) -> String {
        let question = match self {
            Self::Constant(change) => return change.question(),
            Self::GravityAsForce => "is the weight m g, and not g?",
            Self::NotNormalised => "is the direction of a spring divided by its length?",
            Self::StretchAsRatio => {
                "is the force the stiffness times the stretch in metres, not over the rest length?"
            }
            Self::FirstEndOnly | Self::SecondEndOnly => {
                "is the opposite force added to the other end of a spring?"
            }
            Self::DampingAcross => {
                "does a spring damp only the part of the relative velocity along it?"
            }
            Self::DragPerMass => "is the drag -c v a force, which is divided by the mass?",
            Self::UnitMasses => "are the forces divided by the masses?",
            Self::ForcesKept => "are the forces set to 0 before each evaluation?",
            Self::PinsMove => "are the pinned particles left where they are?",
            Self::NoShearSprings => "are the shear springs, across the cells, in the list?",
            Self::NoBendSprings => "are the bend springs, over two cells, in the list?",
        };
        question.into()
    }
}
