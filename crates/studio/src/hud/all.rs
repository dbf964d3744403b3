//! All that a window draws over and around its picture.

use std::collections::HashMap;

use egui::{Context, TextureId};

use super::panel::{self, Request};
use super::{bar, edit, hint, lessons, list, measure, offer, pane_buttons, plotting, text};
use crate::session::Session;

/// Draws text, panel, bar and the open list, with `pictures` of scenes by their names. Returns the
/// request of the mouse.
pub fn show_all(
    ctx: &Context,
    session: &Session,
    pictures: &HashMap<String, TextureId>,
) -> Option<Request> {
    hint::show(ctx, session);
    let on_text = text::show(ctx, &session.runs.panes, &session.readings);
    let on_offer = plotting::offer(ctx, session);
    let on_offer = offer::show(ctx, session).or(on_offer);
    #[cfg(not(target_arch = "wasm32"))]
    super::ruler::show(ctx, session);
    let on_panel = panel::show(ctx, session);
    let on_measure = measure::show(ctx, session);
    let on_panes = pane_buttons::show(ctx, session);
    let on_lessons = lessons::show(ctx, session).map(Request::Learn);
    let on_plots = plotting::show(ctx, session).map(Request::Plot);
    let on_tools = edit::show(ctx, session).map(Request::Change);
    let on_bar = bar::show(ctx, session);
    let on_list = list::show(ctx, session, pictures).map(Request::Change);
    on_list
        .or(on_bar)
        .or(on_panel)
        .or(on_measure)
        .or(on_lessons)
        .or(on_plots)
        .or(on_panes)
        .or(on_offer)
        .or(on_tools)
        .or(on_text)
}
