//! The usual mistakes in the forces of a program, each with a question to its author.

/// Mistake in the forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    HalfGravity,
    DoubleGravity,
    NoGravity,
    GravityUpwards,
    GravityAsForce,
    RestLengthZero,
    NotNormalised,
    StretchAsRatio,
    FirstEndOnly,
    SecondEndOnly,
    SpringsTwice,
    SpringsPush,
    NoSpringDamping,
    DampingAcross,
    NoDrag,
    DragPerMass,
    UnitMasses,
    ForcesKept,
    PinsMove,
    NoShearSprings,
    NoBendSprings,
}

impl Mistake {
    /// All mistakes.
    pub const ALL: [Self; 21] = [
        Self::HalfGravity,
        Self::DoubleGravity,
        Self::NoGravity,
        Self::GravityUpwards,
        Self::GravityAsForce,
        Self::RestLengthZero,
        Self::NotNormalised,
        Self::StretchAsRatio,
        Self::FirstEndOnly,
        Self::SecondEndOnly,
        Self::SpringsTwice,
        Self::SpringsPush,
        Self::NoSpringDamping,
        Self::DampingAcross,
        Self::NoDrag,
        Self::DragPerMass,
        Self::UnitMasses,
        Self::ForcesKept,
        Self::PinsMove,
        Self::NoShearSprings,
        Self::NoBendSprings,
    ];

    /// Returns the mistake in a few words, which follow "with".
    pub fn words(self) -> &'static str {
        match self {
            Self::HalfGravity => "half the gravity",
            Self::DoubleGravity => "twice the gravity",
            Self::NoGravity => "no gravity",
            Self::GravityUpwards => "gravity upwards",
            Self::GravityAsForce => "a weight that does not depend on the mass",
            Self::RestLengthZero => "rest lengths of 0",
            Self::NotNormalised => "spring directions that are not normalised",
            Self::StretchAsRatio => "stretch as a ratio of lengths",
            Self::FirstEndOnly => "spring forces on the first end only",
            Self::SecondEndOnly => "spring forces on the second end only",
            Self::SpringsTwice => "every spring twice",
            Self::SpringsPush => "springs that push where they should pull",
            Self::NoSpringDamping => "springs without damping",
            Self::DampingAcross => "damping of the whole relative velocity",
            Self::NoDrag => "no drag",
            Self::DragPerMass => "drag that grows with the mass",
            Self::UnitMasses => "forces not divided by the masses",
            Self::ForcesKept => "forces that are never cleared",
            Self::PinsMove => "pins that move",
            Self::NoShearSprings => "no shear springs",
            Self::NoBendSprings => "no bend springs",
        }
    }

    /// Returns the question to the author.
    pub fn question(self) -> &'static str {
        match self {
            Self::HalfGravity => "is a factor 1/2 in the gravity, or is its sum taken by halves?",
            Self::DoubleGravity => "is gravity added twice?",
            Self::NoGravity => "is gravity added to the forces?",
            Self::GravityUpwards => "has gravity the wrong sign?",
            Self::GravityAsForce => "is the weight m g, and not g?",
            Self::RestLengthZero => "is the rest length subtracted from the length?",
            Self::NotNormalised => "is the direction of a spring divided by its length?",
            Self::StretchAsRatio => {
                "is the force the stiffness times the stretch in metres, not over the rest length?"
            }
            Self::FirstEndOnly | Self::SecondEndOnly => {
                "is the opposite force added to the other end of a spring?"
            }
            Self::SpringsTwice => "is every spring visited from both of its ends?",
            Self::SpringsPush => "has the force of a spring the wrong sign?",
            Self::NoSpringDamping => "is the damping of the springs added to their force?",
            Self::DampingAcross => {
                "does a spring damp only the part of the relative velocity along it?"
            }
            Self::NoDrag => "is the drag added to the forces?",
            Self::DragPerMass => "is the drag -c v a force, which is divided by the mass?",
            Self::UnitMasses => "are the forces divided by the masses?",
            Self::ForcesKept => "are the forces set to 0 before each evaluation?",
            Self::PinsMove => "are the pinned particles left where they are?",
            Self::NoShearSprings => "are the shear springs, across the cells, in the list?",
            Self::NoBendSprings => "are the bend springs, over two cells, in the list?",
        }
    }
}
