//! All that a window draws over and around its picture.

use std::collections::HashMap;

use egui::{Context, TextureId};

use super::panel::{self, Request};
use super::{
    bar, edit, hint, layout, lessons, list, measure, offer, pane_buttons, plotting, question,
    ruler, text,
};
use crate::session::Session;

/// Shorter side of a picture that lists cover (points).
const LIST_COVERS: f32 = 500.0;

/// Heights of a picture without room for text above the tools, with one row of panes and with two
/// (points).
const TOOLS_COVER: [f32; 2] = [260.0, 560.0];

/// Draws text, panel, bar and the open list, with `pictures` of scenes by their names. Returns the
/// request of the mouse.
pub fn show_all(
    ctx: &Context,
    session: &Session,
    pictures: &HashMap<String, TextureId>,
) -> Option<Request> {
    let window = ctx.viewport_rect().size();
    let on_picture = if layout::is_covered(session, window.into()) {
        None
    } else {
        over_picture(ctx, session)
    };
    let on_panel = panel::show(ctx, session);
    let on_measure = measure::show(ctx, session);
    let on_lessons = lessons::show(ctx, session).map(Request::Learn);
    let on_plots = plotting::show(ctx, session).map(Request::Plot);
    let on_bar = bar::show(ctx, session);
    let asks = session.readings.asks_to_quit;
    let on_question = asks.then(|| question::show(ctx)).flatten();
    let on_list = list::show(ctx, session, pictures).map(Request::Change);
    on_question
        .or(on_list)
        .or(on_bar)
        .or(on_panel)
        .or(on_measure)
        .or(on_lessons)
        .or(on_plots)
        .or(on_picture)
}

/// Draws what lies over the picture, and returns the request of the mouse.
fn over_picture(ctx: &Context, session: &Session) -> Option<Request> {
    let window = ctx.content_rect().size();
    // In a small window, the open list leaves no room for text beside it.
    if session.list.is_some() && window.min_elem() < LIST_COVERS {
        return None;
    }
    // In a low window, the tools leave no room for text above them, nor for that of lower panes.
    let several = session.runs.panes.len() > 2;
    let is_low = window.y < TOOLS_COVER[usize::from(several)] && session.panel.editor.open;
    if is_low && !session.readings.help {
        return edit::show(ctx, session).map(Request::Change);
    }
    hint::show(ctx, session);
    let on_text = text::show(ctx, &session.runs.panes, &session.readings);
    let on_offer = plotting::offer(ctx, session);
    let on_offer = offer::show(ctx, session).or(on_offer);
    ruler::show(ctx, session);
    let on_panes = pane_buttons::show(ctx, session);
    let on_tools = edit::show(ctx, session).map(Request::Change);
    on_panes.or(on_offer).or(on_tools).or(on_text)
}
