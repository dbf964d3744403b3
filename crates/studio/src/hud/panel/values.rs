//! The dials of the knobs for solver, step and scene.

use std::ops::Range;

use a3_core::contact::{Obstacle, Shape};
use a3_core::{Control, Network, Sheet, integrators};
use a3_files::bounds;
use a3_files::rounding::{FEW, round_up, short};
use a3_scenes::MATERIALS;

use super::dial::{Dial, DialScale};
use crate::session::Session;

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
