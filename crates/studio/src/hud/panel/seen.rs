//! The dials of the knobs for drawing, frames and films.

use a3_files::ending::Ending;
use a3_files::rounding::short;
use a3_media::show::{Arrows, Quantity, Show};
use a3_render::Style;

use super::dial::{Dial, DialScale};
use crate::session::{DEFAULT_FILM_SECONDS, SPAN, Session, looks};

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
    let place = Ending::ALL.iter().position(|e| *e == session.panel.film)?;
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
