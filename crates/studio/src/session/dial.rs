//! The dial of a knob: a value on a scale, and its turns.

use a3_files::rounding::short;

/// The values that a knob can have.
#[derive(Clone, Debug, PartialEq)]
pub enum DialScale {
    /// Values between two ends, at equal steps.
    Linear([f64; 2], f64),
    /// Values between two ends, at ten steps per decade.
    Log([f64; 2]),
    /// Whole numbers between two ends.
    Whole([f64; 2]),
    /// A cycle of values.
    Choice(Vec<f64>),
    /// 0 (off) or 1 (on).
    Switch,
}

/// The value that a knob shows, and its scale.
pub struct Dial {
    /// Present value.
    pub value: f64,
    /// Value in the untuned scene.
    pub own: f64,
    /// The possible values.
    pub scale: DialScale,
    /// The present value in words.
    pub words: String,
}

impl Dial {
    /// Creates a dial.
    pub fn new(value: f64, own: f64, scale: DialScale, words: impl Into<String>) -> Self {
        let words = words.into();
        Self { value, own, scale, words }
    }
}

/// A turn of a knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Turns to the nearest value of the scale.
    To(f64),
    /// Turns by a step of the scale. With `other`, the step is ten times finer, or for whole
    /// numbers ten times coarser.
    By { up: bool, other: bool },
    /// Toggles a switch; turns any other knob to the scene's own value.
    Toggle,
    /// Turns to the scene's own value.
    Own,
    /// Turns to exactly this value, which must be within the scale.
    Exactly(f64),
}

impl DialScale {
    /// Returns the position of a value on the scale, from 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        let share = match self {
            Self::Linear([from, to], _) | Self::Whole([from, to]) => (value - from) / (to - from),
            Self::Log([from, to]) => (value / from).ln() / (to / from).ln(),
            Self::Choice(values) => {
                let at = values.iter().position(|v| *v == value);
                at.unwrap_or(0) as f64 / values.len() as f64
            }
            Self::Switch => value,
        };
        share.clamp(0.0, 1.0)
    }

    /// Returns the value at a position on the scale, from 0 to 1.
    pub fn at(&self, share: f64) -> f64 {
        let share = share.clamp(0.0, 1.0);
        match self {
            Self::Linear([from, to], _) | Self::Whole([from, to]) => from + share * (to - from),
            Self::Log([from, to]) => from * (to / from).powf(share),
            Self::Choice(values) => {
                values[((share * values.len() as f64) as usize).min(values.len() - 1)]
            }
            Self::Switch => share.round(),
        }
    }

    /// Rounds a value to the nearest one of the scale, with few digits.
    pub fn nearest(&self, value: f64) -> f64 {
        match self {
            Self::Linear([from, to], step) => {
                let step = 0.1 * step;
                short(((value / step).round() * step).clamp(*from, *to), 6)
            }
            Self::Log([from, to]) => short(value, 3).clamp(*from, *to),
            Self::Whole([from, to]) => value.round().clamp(*from, *to),
            Self::Choice(_) | Self::Switch => value,
        }
    }

    /// Returns the ends of a scale of numbers; `None` for a choice or a switch.
    pub fn ends(&self) -> Option<[f64; 2]> {
        match self {
            Self::Linear(ends, _) | Self::Log(ends) | Self::Whole(ends) => Some(*ends),
            Self::Choice(_) | Self::Switch => None,
        }
    }

    /// Clamps a value to the scale.
    pub fn within(&self, value: f64) -> f64 {
        let ends = self.ends();
        ends.map_or(value, |[from, to]| value.max(from).min(to))
    }

    /// Returns the next value up or down, at a multiple of the step. `other` is that of
    /// [`Turn::By`].
    pub fn next(&self, value: f64, up: bool, other: bool) -> f64 {
        // `hair` is the distance within which a value counts as on a rung, despite rounding.
        let rung = |x: f64, hair: f64| {
            if up { (x + hair).floor() + 1.0 } else { (x - hair).ceil() - 1.0 }
        };
        match self {
            Self::Linear([from, to], step) => {
                let step = if other { 0.1 * step } else { *step };
                short((rung(value / step, 1e-3) * step).clamp(*from, *to), 6)
            }
            Self::Log([from, to]) => {
                // Rounding to three digits moves a value by up to 0.002 decades.
                let (rungs, hair) = if other { (100.0, 0.25) } else { (10.0, 0.025) };
                let next = 10_f64.powf(rung(value.log10() * rungs, hair) / rungs);
                short(next, 3).clamp(*from, *to)
            }
            Self::Whole([from, to]) => {
                let by = if other { 10.0 } else { 1.0 };
                (value + if up { by } else { -by }).clamp(*from, *to)
            }
            Self::Choice(values) => {
                let (count, at) = (values.len(), values.iter().position(|v| *v == value));
                let at = at.unwrap_or(0) + if up { 1 } else { count - 1 };
                values[at % count]
            }
            Self::Switch => f64::from(u8::from(up)),
        }
    }
}
