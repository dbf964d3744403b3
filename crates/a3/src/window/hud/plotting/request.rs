//! What keys, clicks and requests do to the plots.

use egui::{Area, Context, Id, Rect, Sense, vec2};

use super::super::docked::Place;
use super::super::measure::chip;
use super::super::panel::{PanelKey, Request};
use super::files;
use crate::window::session::{Action, Pick, PlotRequest, RunAction, Session, plotting};

/// The place of the pane.
pub const PLACE: Place = Place {
    width: (380.0, 800.0, 0.4),
    min_width_beside: 700.0,
    share_below: 0.55,
};

/// Returns whether the plots are visible: they are open, and the help does not hide them.
pub fn is_shown(session: &Session) -> bool {
    session.panel.plotting.open && !session.readings.help
}

/// Returns the width on the right and the height below the picture that the plots take, in a window
/// of a size (points).
pub fn taken(session: &Session, window: [f32; 2]) -> [f32; 2] {
    if is_shown(session) {
        PLACE.taken(window)
    } else {
        [0.0, 0.0]
    }
}

/// Draws a button that plots the particle whose springs are listed, below that list, unless the
/// plots are open.
pub fn offer(ctx: &Context, session: &Session) -> Option<Request> {
    let is_free = !session.panel.plotting.open && !session.readings.help;
    let [pane] = &*session.runs.panes else {
        return None;
    };
    let i = pane.show.springs_of.filter(|_| is_free)?;
    let list = ctx.memory(|memory| memory.area_rect(Id::unique("run")))?;
    let at = list.left_bottom() + vec2(0.0, 6.0);
    let pick = Pick::at(session.runs.first(), i);
    let words = format!("plot {} (F3)", pick.name());
    let rect = Rect::from_min_size(at, vec2(14.0 + 7.5 * words.len() as f32, 26.0));
    let clicked = Area::new(Id::unique("plot it"))
        .fixed_pos(at)
        .constrain(false)
        .fade_in(false)
        .show(ctx, |ui| {
            let response = ui.allocate_rect(rect, Sense::click());
            chip(ui, rect, &response, &words, false);
            response.clicked()
        })
        .inner;
    clicked.then_some(Request::Act(Action::Run(RunAction::Plots)))
}

/// Plots the particle of a double click, or its body, or no longer, if the plots are open.
pub fn pick(session: &mut Session, particle: Option<usize>) {
    if let Some(i) = particle.filter(|_| is_shown(session)) {
        let pick = Pick::at(session.runs.first(), i);
        apply(session, PlotRequest::Toggle(pick));
    }
}

/// Removes the ruler of the former scene and, if the plots are open, plots what moves alone.
pub fn begin_scene(session: &mut Session) {
    session.panel.plotting.ruler = None;
    if session.panel.plotting.open {
        plotting::pick_first(&mut session.runs.panes);
    }
}

/// Handles a key, and returns whether the plots take it.
pub fn press(session: &mut Session, key: PanelKey) -> bool {
    let by = match key {
        PanelKey::Left => -1,
        PanelKey::Right => 1,
        _ => return false,
    };
    if !is_shown(session) {
        return false;
    }
    let next = session.panel.plotting.mode.neighbour(by);
    apply(session, PlotRequest::Mode(next));
    true
}

/// Carries out a request.
pub fn apply(session: &mut Session, request: PlotRequest) {
    let (settings, panes) = (&mut session.panel.plotting, &mut session.runs.panes);
    match request {
        PlotRequest::Close => settings.open = false,
        PlotRequest::Toggle(pick) => {
            if let Err(why) = plotting::toggle(panes, pick) {
                session.readings.say(why);
            }
        }
        PlotRequest::Mode(mode) => {
            settings.mode = mode;
            plotting::begin_section(panes, mode, settings.axes[0]);
        }
        PlotRequest::Show(variable) => {
            let before = settings.shown.len();
            settings.shown.retain(|it| *it != variable);
            if settings.shown.len() == before {
                settings.shown.push(variable);
            }
        }
        PlotRequest::Axis(axis, variable) => {
            // The velocity goes with its coordinate.
            let [across, up] = &mut settings.axes;
            if axis == 0 && *up == across.velocity() && variable.is_coordinate() {
                *up = variable.velocity();
            }
            settings.axes[axis] = variable;
        }
        PlotRequest::Trigger(trigger) => plotting::set_trigger(panes, trigger),
        PlotRequest::Span(span) => settings.span = span,
        PlotRequest::Clear => panes.iter_mut().for_each(|pane| pane.traces.forget()),
        PlotRequest::Ruler if settings.ruler.take().is_none() => {
            settings.ruler = Some(vec![]);
            session
                .readings
                .say("Drag from one point to another, or click on both.");
        }
        PlotRequest::Ruler => {}
        PlotRequest::Write(file) => {
            let said = match files::write_one(session, file) {
                Ok(path) => format!("Wrote {}.", path.display()),
                Err(failure) => failure.to_string(),
            };
            session.readings.say(said);
        }
    }
}
