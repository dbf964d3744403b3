//! The dial of a knob: a value on a scale, and how it is turned.

use crate::base::rounding::short;

/// The values that a knob may have.
#[derive(Clone, Debug, PartialEq)]
pub enum DialScale {
    /// Values with equal steps between them.
    Linear { from: f64, to: f64, step: f64 },
    /// Values of which ten steps make a factor of ten.
    Log { from: f64, to: f64 },
    /// Whole numbers.
    Whole { from: f64, to: f64 },
    /// These values, and after the last one the first again.
    Choice(Vec<f64>),
    /// 0 (off) or 1 (on).
    Switch,
}

/// The value that a knob shows, and its scale.
pub struct Dial {
    /// The value now.
    pub value: f64,
    /// The value of the scene as it was built.
    pub own: f64,
    /// The values that it may have.
    pub scale: DialScale,
    /// The value in words.
    pub words: String,
}

/// A turn of a knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// To the nearest value of the scale.
    To(f64),
    /// Up or down by a step of the scale. With `other` the step is ten times finer, or for whole
    /// numbers ten times coarser.
    By { up: bool, other: bool },
    /// The other way for a switch; to the scene's own value for all else.
    Toggle,
    /// To the scene's own value.
    Own,
    /// To a value that was typed, and is within the scale.
    Exactly(f64),
}

impl DialScale {
    /// The share of the scale at which a value is: from 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        let share = match self {
            Self::Linear { from, to, .. } | Self::Whole { from, to } => {
                (value - from) / (to - from)
            }
            Self::Log { from, to } => (value / from).ln() / (to / from).ln(),
            Self::Choice(values) => {
                let at = values.iter().position(|v| *v == value);
                at.unwrap_or(0) as f64 / values.len() as f64
            }
            Self::Switch => value,
        };
        share.clamp(0.0, 1.0)
    }

    /// The value at a share of the scale.
    pub fn at(&self, share: f64) -> f64 {
        let share = share.clamp(0.0, 1.0);
        match self {
            Self::Linear { from, to, .. } | Self::Whole { from, to } => from + share * (to - from),
            Self::Log { from, to } => from * (to / from).powf(share),
            Self::Choice(values) => {
                values[((share * values.len() as f64) as usize).min(values.len() - 1)]
            }
            Self::Switch => share.round(),
        }
    }

    /// The value of the scale that is nearest, as one would type it.
    pub fn nearest(&self, value: f64) -> f64 {
        match self {
            Self::Linear { from, to, step } => {
                short(multiple(value, 0.1 * step).clamp(*from, *to), 6)
            }
            Self::Log { from, to } => short(value, 3).clamp(*from, *to),
            Self::Whole { from, to } => value.round().clamp(*from, *to),
            Self::Choice(_) | Self::Switch => value,
        }
    }

    /// The ends of the scale, if it has numbers between them.
    pub fn ends(&self) -> Option<[f64; 2]> {
        match self {
            Self::Linear { from, to, .. } | Self::Log { from, to } | Self::Whole { from, to } => {
                Some([*from, *to])
            }
            Self::Choice(_) | Self::Switch => None,
        }
    }

    /// The value, or the end of the scale that it is beyond.
    pub fn within(&self, value: f64) -> f64 {
        match self {
            Self::Linear { from, to, .. } | Self::Log { from, to } | Self::Whole { from, to } => {
                value.max(*from).min(*to)
            }
            Self::Choice(_) | Self::Switch => value,
        }
    }

    /// The next value up or down, one of those that are a step apart.
    pub fn next(&self, value: f64, up: bool, other: bool) -> f64 {
        // A value that is off a rung by rounding is on it.
        let rung = |x: f64, hair: f64| {
            if up {
                (x + hair).floor() + 1.0
            } else {
                (x - hair).ceil() - 1.0
            }
        };
        match self {
            Self::Linear { from, to, step } => {
                let step = if other { 0.1 * step } else { *step };
                short((rung(value / step, 1e-3) * step).clamp(*from, *to), 6)
            }
            Self::Log { from, to } => {
                // Rounding to three digits moves a value by up to a fifth of a hundredth of a
                // decade.
                let (rungs, hair) = if other { (100.0, 0.25) } else { (10.0, 0.025) };
                let next = 10_f64.powf(rung(value.log10() * rungs, hair) / rungs);
                short(next, 3).clamp(*from, *to)
            }
            Self::Whole { from, to } => {
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

/// The multiple of a step that is nearest to a value.
fn multiple(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}
