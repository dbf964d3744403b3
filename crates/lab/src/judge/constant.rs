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

/// All constants, with their names and units.
#[rustfmt::skip]
pub const CONSTANTS: [(Constant, &str, &str); 9] = [
    (Constant::Gravity, "gravity", "m/s²"),
    (Constant::Stiffness, "stiffness", "N/m"),
    (Constant::Springs, "forces of springs", "N"),
    (Constant::RestLength, "rest length", "m"),
    (Constant::Damping, "damping", "N s/m"),
    (Constant::Drag, "drag", "kg/s"),
    (Constant::Mass, "mass", "kg"),
    (Constant::Start, "velocities at the start", "m/s"),
    (Constant::Velocities, "velocities at the end of each step", "m/s"),
];

/// Factors that have a name: constant, factor, words that follow "with", and the question to the
/// author.
#[rustfmt::skip]
const NAMED: [(Constant, f64, &str, &str); 14] = [
    (Constant::Gravity, 0.5, "half the gravity",
     "is a factor 1/2 in the gravity, or is its sum taken by halves?"),
    (Constant::Gravity, 2.0, "twice the gravity", "is gravity added twice?"),
    (Constant::Gravity, 0.0, "no gravity", "is gravity added to the forces?"),
    (Constant::Gravity, -1.0, "gravity upwards", "has gravity the wrong sign?"),
    (Constant::Stiffness, 2.0, TWICE.0, TWICE.1),
    (Constant::Springs, 2.0, TWICE.0, TWICE.1),
    (Constant::Stiffness, 0.0, "springs without stiffness", NONE),
    (Constant::Springs, 0.0, "no springs", NONE),
    (Constant::Stiffness, -1.0, PUSH.0, PUSH.1),
    (Constant::Springs, -1.0, PUSH.0, PUSH.1),
    (Constant::RestLength, 0.0, "rest lengths of 0",
     "is the rest length subtracted from the length?"),
    (Constant::Damping, 0.0, "springs without damping",
     "is the damping of the springs added to their force?"),
    (Constant::Drag, 0.0, "no drag", "is the drag added to the forces?"),
    (Constant::Start, 0.0, "a start at rest", "are the velocities of the scene set at the start?"),
];
#[rustfmt::skip]
const TWICE: (&str, &str) = ("every spring twice", "is every spring visited from both of its ends?");
const NONE: &str = "is the force of a spring added to its ends?";
#[rustfmt::skip]
const PUSH: (&str, &str) =
    ("springs that push where they should pull", "has the force of a spring the wrong sign?");

/// Largest distance of a fitted factor from one that has a name.
const NEAR: f64 = 1e-6;
/// Number of digits of constants as people type them.
const DIGITS: usize = 6;

/// Constant that differs from that of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    pub constant: Constant,
    /// Value over that in the scene.
    pub factor: f64,
    /// Value in the scene, if it is one number.
    pub own: Option<f64>,
}

impl Change {
    /// Returns the change with a number of few digits, as people type it, or with a factor that has
    /// a name.
    pub fn typed(self) -> Self {
        let own = self.own.unwrap_or(1.0);
        let typed = || short(own * self.factor, DIGITS) / own;
        let factor = self.named(NEAR).map_or_else(typed, |row| row.1);
        Self { factor, ..self }
    }

    /// Returns the change with another factor. Accelerations are linear in the factor that grows by
    /// `more` or, for masses, in its inverse that does.
    pub fn plus(self, more: f64) -> Self {
        let factor = match self.constant {
            Constant::Mass => 1.0 / (1.0 / self.factor + more),
            _ => self.factor + more,
        };
        Self { factor, ..self }
    }

    /// Returns the row of the named factor from which this one differs by less than `near`.
    fn named(self, near: f64) -> Option<&'static (Constant, f64, &'static str, &'static str)> {
        let is_near = |factor: f64| (factor - self.factor).abs() < near;
        let mut rows = NAMED.iter();
        rows.find(|row| row.0 == self.constant && is_near(row.1))
    }

    /// Returns the name of the constant, and its unit.
    pub fn name(self) -> (&'static str, &'static str) {
        let row = CONSTANTS.iter().find(|row| row.0 == self.constant);
        row.map_or(("", ""), |row| (row.1, row.2))
    }

    /// Returns the change in words, which follow "with", and the question to the author.
    fn words(self) -> [String; 2] {
        let (name, unit) = self.name();
        if let Some((.., words, question)) = self.named(f64::MIN_POSITIVE) {
            return [*words, *question].map(String::from);
        }
        let words = match self.own {
            Some(own) => {
                let [found, own] = [own * self.factor, own].map(|value| short(value, DIGITS));
                format!("a {name} of {found} {unit} in place of {own} {unit}")
            }
            None => format!("the {name} times {}", short(self.factor, DIGITS)),
        };
        let question = match self.constant {
            Constant::Velocities => {
                "is a factor of the velocities meant? Drag belongs in the forces".into()
            }
            _ => format!("is the {name} that of the scene?"),
        };
        [words, question]
    }
}

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

/// All mistakes but constants, each in a few words, which follow "with", and with the question to
/// the author.
#[rustfmt::skip]
pub const MISTAKES: [(Mistake, &str, &str); 12] = [
    (Mistake::GravityAsForce, "a weight that does not depend on the mass",
     "is the weight m g, and not g?"),
    (Mistake::NotNormalised, "spring directions that are not normalised",
     "is the direction of a spring divided by its length?"),
    (Mistake::StretchAsRatio, "stretch as a ratio of lengths",
     "is the force the stiffness times the stretch in metres, not over the rest length?"),
    (Mistake::FirstEndOnly, "spring forces on the first end only", ONE_END),
    (Mistake::SecondEndOnly, "spring forces on the second end only", ONE_END),
    (Mistake::DampingAcross, "damping of the whole relative velocity",
     "does a spring damp only the part of the relative velocity along it?"),
    (Mistake::DragPerMass, "drag that grows with the mass",
     "is the drag -c v a force, which is divided by the mass?"),
    (Mistake::UnitMasses, "forces not divided by the masses",
     "are the forces divided by the masses?"),
    (Mistake::ForcesKept, "forces that are never cleared",
     "are the forces set to 0 before each evaluation?"),
    (Mistake::PinsMove, "pins that move", "are the pinned particles left where they are?"),
    (Mistake::NoShearSprings, "no shear springs",
     "are the shear springs, across the cells, in the list?"),
    (Mistake::NoBendSprings, "no bend springs",
     "are the bend springs, over two cells, in the list?"),
];
const ONE_END: &str = "is the opposite force added to the other end of a spring?";

impl Mistake {
    /// Returns the mistake in a few words, which follow "with", and the question to the author.
    pub fn words(self) -> [String; 2] {
        if let Self::Constant(change) = self {
            return change.words();
        }
        let row = MISTAKES.iter().find(|row| row.0 == self);
        row.map_or_else(Default::default, |row| [row.1, row.2].map(String::from))
    }

    /// Returns the constant that is another, if the mistake is that.
    pub fn change(self) -> Option<Change> {
        match self {
            Self::Constant(change) => Some(change),
            _ => None,
        }
    }
}
