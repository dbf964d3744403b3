//! Constants of a scene of masses and springs that a program may have otherwise, and the usual
//! mistakes in its forces, each with a question to its author.

use a3_files::rounding::short;

/// Constant of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    Gravity,
    Stiffness,
    /// Whole forces of the springs: stiffness and damping.
    Springs,
    RestLength,
    Damping,
    Drag,
    Mass,
    /// Velocities at the start.
    Start,
    /// Factor of all velocities at the end of each step.
    Velocities,
}

/// Factors that have a name: constant, factor, words that follow "with", and the question to the
/// author.
const NAMED: [(Constant, f64, &str, &str); 11] = [
    (
        Constant::Gravity,
        0.5,
        "half the gravity",
        "is a factor 1/2 in the gravity, or is its sum taken by halves?",
    ),
    (
        Constant::Gravity,
        2.0,
        "twice the gravity",
        "is gravity added twice?",
    ),
    (
        Constant::Gravity,
        0.0,
        "no gravity",
        "is gravity added to the forces?",
    ),
    (
        Constant::Gravity,
        -1.0,
        "gravity upwards",
        "has gravity the wrong sign?",
    ),
    (Constant::Stiffness, 2.0, TWICE.0, TWICE.1),
    (Constant::Springs, 2.0, TWICE.0, TWICE.1),
    (Constant::Stiffness, -1.0, PUSH.0, PUSH.1),
    (Constant::Springs, -1.0, PUSH.0, PUSH.1),
    (
        Constant::RestLength,
        0.0,
        "rest lengths of 0",
        "is the rest length subtracted from the length?",
    ),
    (
        Constant::Damping,
        0.0,
        "springs without damping",
        "is the damping of the springs added to their force?",
    ),
    (
        Constant::Drag,
        0.0,
        "no drag",
        "is the drag added to the forces?",
    ),
];
const TWICE: (&str, &str) = (
    "every spring twice",
    "is every spring visited from both of its ends?",
);
const PUSH: (&str, &str) = (
    "springs that push where they should pull",
    "has the force of a spring the wrong sign?",
);

/// Largest distance of a fitted factor from one that has a name.
const NEAR: f64 = 1e-6;

/// Constant that differs from that of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    pub constant: Constant,
    /// Value over that in the scene.
    pub factor: f64,
    /// Value in the scene, if it is one number.
    pub own: Option<f64>,
}

impl Constant {
    /// All constants.
    pub const ALL: [Self; 9] = [
        Self::Gravity,
        Self::Stiffness,
        Self::Springs,
        Self::RestLength,
        Self::Damping,
        Self::Drag,
        Self::Mass,
        Self::Start,
        Self::Velocities,
    ];

    /// Returns the name of the constant, and its unit.
    pub fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::Gravity => ("gravity", "m/s²"),
            Self::Stiffness => ("stiffness", "N/m"),
            Self::Springs => ("forces of springs", "N"),
            Self::RestLength => ("rest length", "m"),
            Self::Damping => ("damping", "N s/m"),
            Self::Drag => ("drag", "kg/s"),
            Self::Mass => ("mass", "kg"),
            Self::Start => ("velocities at the start", "m/s"),
            Self::Velocities => ("velocities at the end of each step", "m/s"),
        }
    }
}

impl Change {
    /// Returns the change with a number of few digits, as people type it, or with a factor that has
    /// a name.
    pub fn typed(self) -> Self {
        let own = self.own.unwrap_or(1.0);
        let is = |row: &&(Constant, f64, _, _)| {
            row.0 == self.constant && (row.1 - self.factor).abs() < NEAR
        };
        let named = NAMED.iter().find(is).map(|row| row.1);
        let factor = named.unwrap_or_else(|| short(own * self.factor, DIGITS) / own);
        Self { factor, ..self }
    }

    fn named(self) -> Option<(&'static str, &'static str)> {
        let is = |row: &&(Constant, f64, _, _)| (row.0, row.1) == (self.constant, self.factor);
        let row = NAMED.iter().find(is)?;
        Some((row.2, row.3))
    }

    /// Returns the change in words, which follow "with".
    pub fn words(self) -> String {
        let (name, unit) = self.constant.name();
        match (self.named(), self.own) {
            (Some((words, _)), _) => words.into(),
            (None, Some(own)) => {
                let [found, own] = [own * self.factor, own].map(|value| short(value, DIGITS));
                format!("a {name} of {found} {unit} in place of {own} {unit}")
            }
            (None, None) => format!("the {name} times {}", short(self.factor, DIGITS)),
        }
    }

    /// Returns the question to the author.
    pub fn question(self) -> String {
        let name = self.constant.name().0;
        match self.named() {
            Some((_, question)) => question.into(),
            None if self.constant == Constant::Velocities => {
                "is a factor of the velocities meant? Drag belongs in the forces".into()
            }
            None => format!("is the {name} that of the scene?"),
        }
    }
}

/// Number of digits of constants as people type them.
const DIGITS: usize = 6;

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
