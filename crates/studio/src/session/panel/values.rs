//! The dials of the knobs: for solver, step and scene, and for drawing, frames and films.

use std::ops::Range;

use a3_core::contact::{Obstacle, Shape};
use a3_core::{Control, Network, Sheet, integrators};
use a3_files::bounds;
use a3_files::ending::Ending;
use a3_files::rounding::{FEW, round_up, short};
use a3_media::show::{Arrows, Quantity, Show};
use a3_render::Style;
use a3_scenes::MATERIALS;

use crate::session::{DEFAULT_FILM_SECONDS, Dial, DialScale, IS_PAGE, SPAN, Session, looks};

/// Returns the index of the panel's pane.
pub fn pane(session: &Session) -> usize {
    session.panel.pane.min(session.runs.panes.len() - 1)
}

/// Returns the network of the first run, if its scene has one.
pub fn network(session: &Session) -> Option<&Network> {
    session.runs.first().model().network()
}

/// Returns the network of the untuned scene, if it has one.
pub fn own(session: &Session) -> Option<&Network> {
    session.tuning.own.model.network()
}

/// Creates the dial of a switch. `own` is the scene's own position.
pub fn switch(on: bool, own: bool) -> Dial {
    Dial {
        value: f64::from(u8::from(on)),
        own: f64::from(u8::from(own)),
        scale: DialScale::Switch,
        words: if on { "on" } else { "off" }.into(),
    }
}

pub fn solver(session: &Session, at: usize) -> Option<Dial> {
    let run = &session.runs.panes.get(at)?.simulation;
    let system = run.model().system();
    let serves = |i: &usize| integrators::METHODS[*i].check(system).is_ok();
    let index = |method| {
        let of = |m: &a3_core::Method| std::ptr::eq(m, method);
        integrators::METHODS.iter().position(of).unwrap_or(0) as f64
    };
    let own = session.scenes.shown.source.solver_or(None);
    Some(Dial {
        value: index(run.method()),
        own: index(own),
        scale: DialScale::Choice(
            (0..integrators::METHODS.len())
                .filter(serves)
                .map(|i| i as f64)
                .collect(),
        ),
        words: run.method().title.into(),
    })
}

/// Returns the dial of the material of the bodies, by its index; past the last one for none.
pub fn material(session: &Session, _: usize) -> Option<Dial> {
    let scene = &session.scenes.shown.source.description;
    let place = |name: &str| MATERIALS.iter().position(|it| it.name == name);
    let mut all: Vec<_> = scene.materials().into_iter().filter_map(place).collect();
    if all.is_empty() {
        return None;
    }
    let now = scene.named_material().and_then(place);
    let value = now.unwrap_or_else(|| {
        all.push(MATERIALS.len());
        MATERIALS.len()
    }) as f64;
    Some(Dial {
        value,
        own: value,
        scale: DialScale::Choice(all.iter().map(|k| *k as f64).collect()),
        words: now.map_or("own", |k| MATERIALS[k].name).into(),
    })
}

pub fn step(session: &Session, at: usize) -> Option<Dial> {
    let run = &session.runs.panes.get(at)?.simulation;
    let (from, to, words) = match run.control() {
        // The dial covers common steps, and more if the present step is beyond them.
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
        own: session.tuning.defaults.control_of(run.method()).value(),
        scale: DialScale::Log { from, to },
        words,
    })
}

/// Creates the dial of a factor on the scene's own value.
fn factor(value: f64, scale: DialScale) -> Dial {
    Dial {
        value,
        own: 1.0,
        scale,
        words: format!("× {value}"),
    }
}

pub fn stiffness(session: &Session, _: usize) -> Option<Dial> {
    let own = own(session)?;
    (own.is_elastic() || own.fluid().is_some()).then_some(())?;
    let scale = DialScale::Log {
        from: 0.1,
        to: 10.0,
    };
    Some(factor(session.tuning.stiffness, scale))
}

pub fn damping(session: &Session, _: usize) -> Option<Dial> {
    let own = own(session)?;
    let is_viscous = own.fluid().is_some_and(|fluid| fluid.law().viscosity > 0.0);
    (own.is_damped() || is_viscous).then_some(())?;
    let scale = DialScale::Linear {
        from: 0.0,
        to: 5.0,
        step: 0.2,
    };
    Some(factor(session.tuning.damping, scale))
}

pub fn gusts(session: &Session, _: usize) -> Option<Dial> {
    session.runs.first().scene().wind?;
    let scale = DialScale::Linear {
        from: 0.0,
        to: 3.0,
        step: 0.1,
    };
    Some(factor(session.tuning.gusts, scale))
}

pub fn drag(session: &Session, _: usize) -> Option<Dial> {
    let (own, now) = (own(session)?, network(session)?);
    let mean = own.masses().iter().sum::<f64>() / own.particles() as f64;
    let (own, value) = (own.drag().unwrap_or(0.0), now.drag().unwrap_or(0.0));
    // Up to a drag that damps motion with a time constant of 0.2 s, or four times the scene's own.
    let to = round_up((5.0 * mean).max(4.0 * own), FEW);
    Some(Dial {
        value,
        own,
        scale: DialScale::Linear {
            from: 0.0,
            to,
            step: 0.02 * to,
        },
        words: format!("{} kg/s", short(value, 3)),
    })
}

/// Returns the particles and limits of all bodies with a strain limit, or else the sheets without
/// one.
pub fn strain_limits(network: &Network) -> Vec<(Range<usize>, Option<f64>)> {
    let limited = network.strain_limits().iter().cloned();
    let limited: Vec<_> = limited.map(|(body, limit)| (body, Some(limit))).collect();
    if limited.is_empty() {
        let sheets = network.sheets().map(Sheet::particles);
        return sheets.map(|body| (body, None)).collect();
    }
    limited
}

/// Returns the dial of the strain limit, 1 for none. A scene whose springs tear has none, because
/// limited springs never would.
pub fn strain_limit(session: &Session, _: usize) -> Option<Dial> {
    let own = own(session)?;
    if own.tear_limit().is_some() {
        return None;
    }
    let (_, own) = strain_limits(own).into_iter().next()?;
    let now = network(session)?.strain_limits().first();
    let value = now.map_or(1.0, |(_, limit)| *limit);
    Some(Dial {
        value,
        own: own.unwrap_or(1.0),
        scale: DialScale::Linear {
            from: 1.0,
            to: 1.5,
            step: 0.02,
        },
        words: now.map_or("off".into(), |_| format!("× {}", short(value, 4))),
    })
}

pub fn gravity(session: &Session, _: usize) -> Option<Dial> {
    let down = |network: &Network| network.gravity().map_or(0.0, |g| -g.y);
    let (own, value) = (down(own(session)?), down(network(session)?));
    Some(Dial {
        value,
        own,
        scale: DialScale::Linear {
            from: own.min(0.0),
            // The gravity of Jupiter.
            to: own.max(25.0),
            step: 0.5,
        },
        words: format!("{} m/s²", short(value, 3)),
    })
}

/// Returns the indices and radii (m) of the spheres among the obstacles of a network.
pub fn radii(network: &Network) -> impl Iterator<Item = (usize, f64)> {
    let obstacles = network.obstacles().iter().enumerate();
    obstacles.filter_map(|(k, obstacle)| match obstacle.shape {
        Shape::Sphere { radius } => Some((k, radius)),
        _ => None,
    })
}

/// Returns the last floor among the obstacles of a network, with its index.
pub fn floor(network: &Network) -> Option<(usize, &Obstacle)> {
    let obstacles = network.obstacles().iter().enumerate();
    obstacles
        .rev()
        .find(|(_, obstacle)| obstacle.shape == Shape::Floor)
}

pub fn sphere(session: &Session, _: usize) -> Option<Dial> {
    let radius = |network: &Network| radii(network).next().map(|(_, radius)| radius);
    let (own, value) = (radius(own(session)?)?, radius(network(session)?)?);
    Some(Dial {
        value,
        own,
        scale: DialScale::Linear {
            from: 0.1 * own,
            to: 2.0 * own,
            step: 0.05 * round_up(own, FEW),
        },
        words: format!("{} m", short(value, 3)),
    })
}

pub fn springs_of(session: &Session, at: usize) -> Option<Dial> {
    let network = network(session)?;
    own(session)?.all_springs().next()?;
    let i = session.runs.panes.get(at)?.show.springs_of;
    Some(Dial {
        value: i.map_or(-1.0, |i| i as f64),
        own: -1.0,
        scale: DialScale::Whole {
            from: -1.0,
            to: (network.particles() - 1) as f64,
        },
        words: i.map_or("none".into(), |i| i.to_string()),
    })
}

/// Creates a dial that chooses one of the available items or none; `None` if no item is available.
fn one_of<T: Copy + PartialEq>(
    all: &[T],
    chosen: Option<T>,
    has: impl Fn(T) -> bool,
    name: impl Fn(T) -> &'static str,
) -> Option<Dial> {
    let none = all.len() as f64;
    let there = (0..all.len()).filter(|k| has(all[*k]));
    let mut values: Vec<f64> = there.map(|k| k as f64).collect();
    if values.is_empty() {
        return None;
    }
    values.push(none);
    let place = chosen.and_then(|chosen| all.iter().position(|one| *one == chosen));
    Some(Dial {
        value: place.map_or(none, |k| k as f64),
        own: none,
        scale: DialScale::Choice(values),
        words: chosen.map_or("none", name).into(),
    })
}

pub fn colour(session: &Session, at: usize) -> Option<Dial> {
    let chosen = session.runs.panes.get(at)?.show.colouring.quantity;
    let panes = &session.runs.panes;
    let has = |quantity| looks::has_quantity(panes, quantity);
    one_of(&Quantity::ALL, chosen, has, Quantity::name)
}

pub fn full_colour(session: &Session, at: usize) -> Option<Dial> {
    let colouring = &session.runs.panes.get(at)?.show.colouring;
    let (quantity, scale) = (colouring.quantity?, colouring.scale);
    let fitting = if scale.fitting > 0.0 {
        scale.fitting
    } else {
        1.0
    };
    let end = scale.fixed.unwrap_or(fitting);
    let words = format!("{}{}", short(end, 3), quantity.unit());
    Some(Dial {
        value: end,
        own: fitting,
        scale: DialScale::Log {
            from: 1e-3 * fitting,
            to: 1e2 * fitting,
        },
        words: if scale.fixed.is_some() {
            words
        } else {
            format!("auto, {words}")
        },
    })
}

/// Frame rates (1/s) that can be chosen as the largest; 0 for that of the screen.
const FRAME_LIMITS: [u32; 5] = [0, 60, 30, 15, 5];

pub fn frame_limit(session: &Session, _: usize) -> Option<Dial> {
    session.readings.in_window.then(|| {
        let limit = session.panel.frame_limit;
        let mut values: Vec<f64> = FRAME_LIMITS.map(f64::from).to_vec();
        // Keep another value from the settings file.
        if !FRAME_LIMITS.contains(&limit) {
            values.push(limit.into());
        }
        Dial {
            value: limit.into(),
            own: 0.0,
            scale: DialScale::Choice(values),
            words: match limit {
                0 => "no limit".into(),
                limit => format!("at most {limit}/s"),
            },
        }
    })
}

pub fn film(session: &Session, _: usize) -> Option<Dial> {
    let ending = Ending::ALL.iter().position(|e| *e == session.panel.film);
    let place = ending.filter(|_| !IS_PAGE)?;
    Some(Dial {
        value: place as f64,
        own: 0.0,
        scale: DialScale::Choice((0..Ending::ALL.len()).map(|k| k as f64).collect()),
        words: session.panel.film.name().into(),
    })
}

pub fn film_seconds(session: &Session) -> Dial {
    Dial {
        value: session.panel.film_seconds,
        own: DEFAULT_FILM_SECONDS,
        scale: DialScale::Whole {
            from: 1.0,
            to: SPAN,
        },
        words: format!("last {} s", session.panel.film_seconds),
    }
}

pub fn arrows(session: &Session, at: usize) -> Option<Dial> {
    let chosen = session.runs.panes.get(at)?.show.field.arrows;
    let has = |arrows: Arrows| arrows.is_in(session.runs.first());
    one_of(&Arrows::ALL, chosen, has, Arrows::name)
}

/// Returns the name of a style.
fn style_name(style: Style) -> &'static str {
    match style {
        Style::Shaded => "surface",
        Style::Wireframe => "wires",
        Style::Springs => "springs",
    }
}

pub fn style(session: &Session, at: usize) -> Option<Dial> {
    let pane = session.runs.panes.get(at)?;
    let styles = Show::styles(&pane.simulation);
    let place = styles.iter().position(|style| *style == pane.show.style);
    let drawn = pane.show.has_surface(&pane.simulation);
    drawn.then(|| Dial {
        value: place.unwrap_or(0) as f64,
        own: 0.0,
        scale: DialScale::Choice((0..styles.len()).map(|k| k as f64).collect()),
        words: style_name(pane.show.style).into(),
    })
}
