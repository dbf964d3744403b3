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
    let [value, own] = [on, own].map(|on| f64::from(u8::from(on)));
    Dial::new(value, own, DialScale::Switch, if on { "on" } else { "off" })
}

pub fn solver(session: &Session, at: usize) -> Option<Dial> {
    let run = &session.runs.panes.get(at)?.simulation;
    let (system, all) = (run.model().system(), integrators::METHODS);
    let serves = (0..all.len()).filter(|i| all[*i].check(system).is_ok());
    let scale = DialScale::Choice(serves.map(|i| i as f64).collect());
    let index = |method: &a3_core::Method| {
        let mut others = all.iter();
        others.position(|m| std::ptr::eq(m, method)).unwrap_or(0) as f64
    };
    let own = index(session.scenes.shown.source.solver_or(None));
    let (value, words) = (index(run.method()), run.method().title);
    Some(Dial::new(value, own, scale, words))
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
    if now.is_none() {
        all.push(MATERIALS.len());
    }
    let value = now.unwrap_or(MATERIALS.len()) as f64;
    let scale = DialScale::Choice(all.iter().map(|k| *k as f64).collect());
    let words = now.map_or("own", |k| MATERIALS[k].name);
    Some(Dial::new(value, value, scale, words))
}

pub fn step(session: &Session, at: usize) -> Option<Dial> {
    let run = &session.runs.panes.get(at)?.simulation;
    let (ends, words) = match run.control() {
        // The dial covers common steps, and more if the present step is beyond them.
        Control::Step(step) => ([step.min(1e-5), step.max(1.0)], format!("{} s", short(step, 3))),
        Control::Tolerance(tolerance) => {
            let range = bounds::of(run.control());
            ([*range.start(), *range.end()], format!("{tolerance:e}"))
        }
    };
    let own = session.tuning.defaults.control_of(run.method()).value();
    let value = run.control().value();
    Some(Dial::new(value, own, DialScale::Log(ends), words))
}

/// Creates the dial of a factor on the scene's own value.
fn factor(value: f64, scale: DialScale) -> Dial {
    Dial::new(value, 1.0, scale, format!("× {value}"))
}

pub fn stiffness(session: &Session, _: usize) -> Option<Dial> {
    let own = own(session)?;
    (own.is_elastic() || own.fluid().is_some()).then_some(())?;
    let scale = DialScale::Log([0.1, 10.0]);
    Some(factor(session.tuning.stiffness, scale))
}

pub fn damping(session: &Session, _: usize) -> Option<Dial> {
    let own = own(session)?;
    let is_viscous = own.fluid().is_some_and(|fluid| fluid.law().viscosity > 0.0);
    (own.is_damped() || is_viscous).then_some(())?;
    let scale = DialScale::Linear([0.0, 5.0], 0.2);
    Some(factor(session.tuning.damping, scale))
}

pub fn gusts(session: &Session, _: usize) -> Option<Dial> {
    session.runs.first().scene().wind?;
    let scale = DialScale::Linear([0.0, 3.0], 0.1);
    Some(factor(session.tuning.gusts, scale))
}

pub fn drag(session: &Session, _: usize) -> Option<Dial> {
    let (own, now) = (own(session)?, network(session)?);
    let mean = own.masses().iter().sum::<f64>() / own.particles() as f64;
    let (own, value) = (own.drag().unwrap_or(0.0), now.drag().unwrap_or(0.0));
    // Up to a drag that damps motion with a time constant of 0.2 s, or four times the scene's own.
    let to = round_up((5.0 * mean).max(4.0 * own), FEW);
    let scale = DialScale::Linear([0.0, to], 0.02 * to);
    let words = format!("{} kg/s", short(value, 3));
    Some(Dial::new(value, own, scale, words))
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
    let scale = DialScale::Linear([1.0, 1.5], 0.02);
    let words = now.map_or("off".into(), |_| format!("× {}", short(value, 4)));
    Some(Dial::new(value, own.unwrap_or(1.0), scale, words))
}

pub fn gravity(session: &Session, _: usize) -> Option<Dial> {
    let down = |network: &Network| network.gravity().map_or(0.0, |g| -g.y);
    let (own, value) = (down(own(session)?), down(network(session)?));
    // Up to the gravity of Jupiter.
    let scale = DialScale::Linear([own.min(0.0), own.max(25.0)], 0.5);
    let words = format!("{} m/s²", short(value, 3));
    Some(Dial::new(value, own, scale, words))
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
    obstacles.rev().find(|(_, obstacle)| obstacle.shape == Shape::Floor)
}

pub fn sphere(session: &Session, _: usize) -> Option<Dial> {
    let radius = |network: &Network| radii(network).next().map(|(_, radius)| radius);
    let (own, value) = (radius(own(session)?)?, radius(network(session)?)?);
    let step = 0.05 * round_up(own, FEW);
    let scale = DialScale::Linear([0.1 * own, 2.0 * own], step);
    let words = format!("{} m", short(value, 3));
    Some(Dial::new(value, own, scale, words))
}

pub fn springs_of(session: &Session, at: usize) -> Option<Dial> {
    let network = network(session)?;
    own(session)?.all_springs().next()?;
    let i = session.runs.panes.get(at)?.show.springs_of;
    let scale = DialScale::Whole([-1.0, (network.particles() - 1) as f64]);
    let words = i.map_or("none".into(), |i| i.to_string());
    Some(Dial::new(i.map_or(-1.0, |i| i as f64), -1.0, scale, words))
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
    let value = place.map_or(none, |k| k as f64);
    let words = chosen.map_or("none", name);
    Some(Dial::new(value, none, DialScale::Choice(values), words))
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
    let fitting = Some(scale.fitting).filter(|it| *it > 0.0).unwrap_or(1.0);
    let end = scale.fixed.unwrap_or(fitting);
    let auto = scale.fixed.map_or("auto, ", |_| "");
    let words = format!("{auto}{}{}", short(end, 3), quantity.unit());
    let scale = DialScale::Log([1e-3 * fitting, 1e2 * fitting]);
    Some(Dial::new(end, fitting, scale, words))
}

/// Frame rates (1/s) that can be chosen as the largest; 0 for that of the screen.
const FRAME_LIMITS: [u32; 5] = [0, 60, 30, 15, 5];

pub fn frame_limit(session: &Session, _: usize) -> Option<Dial> {
    let limit = session.panel.frame_limit;
    let mut values: Vec<f64> = FRAME_LIMITS.map(f64::from).to_vec();
    // Keep another value from the settings file.
    if !FRAME_LIMITS.contains(&limit) {
        values.push(limit.into());
    }
    let words = match limit {
        0 => "no limit".into(),
        limit => format!("at most {limit}/s"),
    };
    let dial = || Dial::new(limit.into(), 0.0, DialScale::Choice(values), words);
    session.readings.in_window.then(dial)
}

pub fn film(session: &Session, _: usize) -> Option<Dial> {
    let ending = Ending::ALL.iter().position(|e| *e == session.panel.film);
    let place = ending.filter(|_| !IS_PAGE)?;
    let scale = DialScale::Choice((0..Ending::ALL.len()).map(|k| k as f64).collect());
    let words = session.panel.film.name();
    Some(Dial::new(place as f64, 0.0, scale, words))
}

pub fn film_seconds(session: &Session, _: usize) -> Option<Dial> {
    let seconds = session.panel.film_seconds;
    let (scale, words) = (DialScale::Whole([1.0, SPAN]), format!("last {seconds} s"));
    (!IS_PAGE).then(|| Dial::new(seconds, DEFAULT_FILM_SECONDS, scale, words))
}

pub fn arrows(session: &Session, at: usize) -> Option<Dial> {
    let chosen = session.runs.panes.get(at)?.show.field.arrows;
    let has = |arrows: Arrows| arrows.is_in(session.runs.first());
    one_of(&Arrows::ALL, chosen, has, Arrows::name)
}

pub fn style(session: &Session, at: usize) -> Option<Dial> {
    let pane = session.runs.panes.get(at)?;
    let styles = Show::styles(&pane.simulation);
    let place = styles.iter().position(|style| *style == pane.show.style);
    let scale = DialScale::Choice((0..styles.len()).map(|k| k as f64).collect());
    let words = match pane.show.style {
        Style::Shaded => "surface",
        Style::Wireframe => "wires",
        Style::Springs => "springs",
    };
    let drawn = pane.show.has_surface(&pane.simulation);
    drawn.then(|| Dial::new(place.unwrap_or(0) as f64, 0.0, scale, words))
}
