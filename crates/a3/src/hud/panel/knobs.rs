//! What can be tuned while it runs, in one table: the mouse and the keys turn the same knobs.

use a3_core::{Control, Network, Vector3, integrators};
use a3_render::Style;

use crate::bounds;
use crate::session::{Action, Session, Tuning};

/// What values there are.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// Each time so much more.
    Linear { from: f64, to: f64, step: f64 },
    /// Ten times more in ten steps.
    Log { from: f64, to: f64 },
    /// One after the other.
    Whole { from: f64, to: f64 },
    /// These, round and round.
    Choice(Vec<f64>),
    /// 0 or 1.
    Switch,
}

/// What a knob shows.
pub struct Dial {
    pub value: f64,
    /// Of the scene as it was built.
    pub own: f64,
    pub scale: Scale,
    pub words: String,
}

/// What a hand does to a knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    To(f64),
    /// By a step, or with `other` by one ten times finer (of whole numbers: coarser).
    By {
        up: bool,
        other: bool,
    },
    /// The other way, of a switch; back to the scene's own, of all else.
    Toggle,
    Own,
}

/// A row of the table.
#[derive(Clone, Copy)]
pub struct Knob {
    pub name: &'static str,
    /// It stands apart from the one before it.
    pub apart: bool,
    /// What it shows for the session and that pane, if it means something there.
    pub read: fn(&Session, usize) -> Option<Dial>,
    set: fn(&mut Session, usize, f64),
}

const fn knob(
    name: &'static str,
    read: fn(&Session, usize) -> Option<Dial>,
    set: fn(&mut Session, usize, f64),
) -> Knob {
    Knob {
        name,
        apart: false,
        read,
        set,
    }
}

const fn apart(knob: Knob) -> Knob {
    Knob {
        apart: true,
        ..knob
    }
}

/// From top to bottom.
pub static KNOBS: &[Knob] = &[
    knob("solver", solver, |session, at, i| {
        session.act(Action::Solver(i as usize), at);
    }),
    knob("step", step, |session, at, value| {
        session.set_step_of(at, value);
    }),
    apart(knob("stiffness", stiffness, |session, _, factor| {
        session.tuning.stiffness = factor;
        set_springs(session);
    })),
    knob("damping", damping, |session, _, factor| {
        session.tuning.damping = factor;
        set_springs(session);
    }),
    knob("drag", drag, |session, _, drag| {
        session.adjust(|network| {
            // It is within its scale.
            let _ = network.set_drag(drag);
        });
    }),
    knob("gravity", gravity, |session, _, g| {
        session.adjust(|network| {
            let sideways = network.gravity().unwrap_or_default();
            network.set_gravity(Vector3::new(sideways.x, -g, sideways.z));
        });
    }),
    apart(knob(
        "wind",
        |session, _| {
            session.first().scene().wind?;
            Some(switch(session.first().windy(), false))
        },
        |session, at, _| {
            session.act(Action::Wind, at);
        },
    )),
    knob("gusts", gusts, |session, _, factor| {
        session.tuning.gusts = factor;
        if let Some(wind) = session.tuning.own.wind {
            session.change_all(|run| run.change_wind(wind.scaled(factor)));
        }
    }),
    knob(
        "swing",
        |session, _| {
            session.first().scene().swing?;
            Some(switch(session.first().swinging(), false))
        },
        |session, at, _| {
            session.act(Action::Swing, at);
        },
    ),
    knob(
        "pins",
        |session, _| {
            own(session)?.pins().next()?;
            Some(switch(session.first().pinned(), true))
        },
        |session, _, on| session.change_all(|run| run.set_pinned(on != 0.0)),
    ),
    knob("sphere", sphere, |session, _, radius| {
        let Some(first) = own(session).and_then(|own| own.spheres().first()) else {
            return;
        };
        let factor = radius / first.radius;
        let radii = own(session).into_iter().flat_map(Network::spheres);
        let radii: Vec<_> = radii.map(|sphere| sphere.radius * factor).collect();
        session.adjust(|network| {
            for (k, radius) in radii.iter().enumerate() {
                let _ = network.resize_sphere(k, *radius);
            }
        });
    }),
    knob(
        "floor",
        |session, _| {
            own(session)?.floor()?;
            let there = network(session)?.floor().is_some();
            Some(switch(there, true))
        },
        |session, _, on| {
            let floor = own(session).and_then(Network::floor);
            session.adjust(|network| match floor.filter(|_| on != 0.0) {
                Some(floor) => network.set_floor(floor),
                None => network.remove_floor(),
            });
        },
    ),
    apart(knob("springs of", springs_of, |session, _, i| {
        for pane in &mut session.panes {
            pane.show.springs_of = (i >= 0.0).then_some(i as usize);
        }
    })),
    knob(
        "wires",
        |session, _| {
            let drawn = !session.first().scene().surface.triangles.is_empty();
            let wires = session.panes[0].show.style == Style::Wireframe;
            drawn.then(|| switch(wires, false))
        },
        |session, at, _| {
            session.act(Action::Wireframe, at);
        },
    ),
];

impl Knob {
    /// Turns it, if it means something.
    pub fn turn(&self, session: &mut Session, at: usize, turn: Turn) {
        let Some(dial) = (self.read)(session, at) else {
            return;
        };
        let to = match turn {
            Turn::To(value) => dial.scale.nearest(value),
            Turn::By { up, other } => dial.scale.next(dial.value, up, other),
            Turn::Toggle if dial.scale == Scale::Switch => 1.0 - dial.value,
            Turn::Toggle | Turn::Own => dial.own,
        };
        if to != dial.value {
            (self.set)(session, at, to);
        }
    }
}

impl Scale {
    /// Where a value is: from 0 to 1.
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

    /// The value that is there.
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

    /// A value as one would type it.
    fn nearest(&self, value: f64) -> f64 {
        match self {
            Self::Linear { from, to, step } => {
                short(multiple(value, 0.1 * step).clamp(*from, *to), 6)
            }
            Self::Log { from, to } => short(value, 3).clamp(*from, *to),
            Self::Whole { from, to } => value.round().clamp(*from, *to),
            Self::Choice(_) | Self::Switch => value,
        }
    }

    /// The next value up or down: one of those that are a step apart.
    fn next(&self, value: f64, up: bool, other: bool) -> f64 {
        // What is on a rung but for rounding is on it.
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
                // Three digits are off by up to a fifth of a hundredth of a decade.
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

fn multiple(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// To so many digits.
fn short(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Of 1, 2 or 5 times a power of ten, the next above.
fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let next = [1.0, 2.0, 5.0, 10.0].map(|m| short(m * power, 1));
    next.into_iter().find(|n| *n >= value).unwrap_or(value)
}

fn network(session: &Session) -> Option<&Network> {
    session.first().model().network()
}

fn own(session: &Session) -> Option<&Network> {
    session.tuning.own.model.network()
}

fn switch(on: bool, own: bool) -> Dial {
    Dial {
        value: f64::from(u8::from(on)),
        own: f64::from(u8::from(own)),
        scale: Scale::Switch,
        words: if on { "on" } else { "off" }.into(),
    }
}

fn solver(session: &Session, at: usize) -> Option<Dial> {
    let run = &session.panes.get(at)?.simulation;
    let serves =
        |i: &usize| !integrators::METHODS[*i].needs_mechanics || network(session).is_some();
    let index = |method| {
        let of = |m: &a3_core::Method| std::ptr::eq(m, method);
        integrators::METHODS.iter().position(of).unwrap_or(0) as f64
    };
    let own = session.shown().solver_or(None);
    Some(Dial {
        value: index(run.method()),
        own: index(own),
        scale: Scale::Choice(
            (0..integrators::METHODS.len())
                .filter(serves)
                .map(|i| i as f64)
                .collect(),
        ),
        words: run.method().title.into(),
    })
}

fn step(session: &Session, at: usize) -> Option<Dial> {
    let run = &session.panes.get(at)?.simulation;
    let (from, to, words) = match run.control() {
        // What is beyond is typed, not turned to.
        Control::Step(step) => (
            step.min(1e-5),
            step.max(1.0),
            format!("{} s", short(step, 3)),
        ),
        Control::Tolerance(tolerance) => {
            let range = bounds::of(run.control());
            (*range.start(), *range.end(), format!("{tolerance:e}"))
        }
    };
    Some(Dial {
        value: run.control().value(),
        own: session.tuning.own.default_control(run.method()).value(),
        scale: Scale::Log { from, to },
        words,
    })
}

/// So many times the scene's own.
fn factor(value: f64, scale: Scale) -> Dial {
    Dial {
        value,
        own: 1.0,
        scale,
        words: format!("× {value}"),
    }
}

fn stiffness(session: &Session, _: usize) -> Option<Dial> {
    own(session)?.springs().next()?;
    let scale = Scale::Log {
        from: 0.1,
        to: 10.0,
    };
    Some(factor(session.tuning.stiffness, scale))
}

fn damping(session: &Session, _: usize) -> Option<Dial> {
    own(session)?.springs().find(|s| s.law.damping > 0.0)?;
    let scale = Scale::Linear {
        from: 0.0,
        to: 5.0,
        step: 0.2,
    };
    Some(factor(session.tuning.damping, scale))
}

fn gusts(session: &Session, _: usize) -> Option<Dial> {
    session.first().scene().wind?;
    let scale = Scale::Linear {
        from: 0.0,
        to: 3.0,
        step: 0.1,
    };
    Some(factor(session.tuning.gusts, scale))
}

fn set_springs(session: &mut Session) {
    let Tuning {
        own,
        stiffness,
        damping,
        ..
    } = session.tuning.clone();
    let Some(own) = own.model.network() else {
        return;
    };
    session.adjust(|network| {
        // They are those of the same scene, and within their scales.
        let _ = network
            .copy_springs(own)
            .and_then(|()| network.scale_springs(stiffness, damping));
    });
}

fn drag(session: &Session, _: usize) -> Option<Dial> {
    let (own, now) = (own(session)?, network(session)?);
    let mean = own.masses().iter().sum::<f64>() / own.particles() as f64;
    let (own, value) = (own.drag().unwrap_or(0.0), now.drag().unwrap_or(0.0));
    // From none to where motion dies in a fifth of a second.
    let to = round_up((5.0 * mean).max(4.0 * own));
    Some(Dial {
        value,
        own,
        scale: Scale::Linear {
            from: 0.0,
            to,
            step: 0.02 * to,
        },
        words: format!("{} kg/s", short(value, 3)),
    })
}

fn gravity(session: &Session, _: usize) -> Option<Dial> {
    let down = |network: &Network| network.gravity().map_or(0.0, |g| -g.y);
    let (own, value) = (down(own(session)?), down(network(session)?));
    Some(Dial {
        value,
        own,
        scale: Scale::Linear {
            from: own.min(0.0),
            // Jupiter's.
            to: own.max(25.0),
            step: 0.5,
        },
        words: format!("{} m/s²", short(value, 3)),
    })
}

fn sphere(session: &Session, _: usize) -> Option<Dial> {
    let radius = |network: &Network| network.spheres().first().map(|sphere| sphere.radius);
    let (own, value) = (radius(own(session)?)?, radius(network(session)?)?);
    Some(Dial {
        value,
        own,
        scale: Scale::Linear {
            from: 0.1 * own,
            to: 2.0 * own,
            step: 0.05 * round_up(own),
        },
        words: format!("{} m", short(value, 3)),
    })
}

fn springs_of(session: &Session, at: usize) -> Option<Dial> {
    let network = network(session)?;
    let i = session.panes.get(at)?.show.springs_of;
    Some(Dial {
        value: i.map_or(-1.0, |i| i as f64),
        own: -1.0,
        scale: Scale::Whole {
            from: -1.0,
            to: (network.particles() - 1) as f64,
        },
        words: i.map_or("none".into(), |i| i.to_string()),
    })
}
