//! The bar below the picture: what a user does most, as buttons, and the timeline.

use egui::{Align2, Color32, Context, FontId, Id, Rect, Response, Sense, Ui, pos2, vec2};

use super::docked::docked;
use super::panel::Request;
use super::style::{ALARM, FAINT, TEXT};
use super::{layout, timeline};
use crate::session::{Action, IS_PAGE, RunAction, Session, WindowAction, is_here};

/// Width of a button with a symbol, for the mouse and for fingers (points).
const SYMBOL_WIDTHS: [f32; 2] = [34.0, 44.0];
/// Width of a bar below which fingers have fewer buttons for the run (points).
const MIN_WIDTH_OF_ALL: f32 = 480.0;
/// Smallest width of the timeline (points).
const MIN_TIMELINE_WIDTH: f32 = 90.0;
/// Colour of the button under the pointer.
const HOVERED: Color32 = Color32::from_rgb(207, 211, 218);

/// A button of the bar.
struct Button {
    /// The symbol, or a short word.
    face: String,
    /// The effect, and the key that has it.
    about: String,
    action: Action,
    colour: Color32,
}

impl Button {
    fn new(face: &str, about: &str, action: Action) -> Self {
        Self {
            face: face.into(),
            about: about.into(),
            action,
            colour: TEXT,
        }
    }

    /// Returns the width of the button (points), if one with a symbol is `least` wide.
    fn width(&self, ui: &Ui, least: f32) -> f32 {
        if self.face.chars().count() == 1 {
            return least;
        }
        let font = FontId::proportional(13.5);
        let words = ui
            .painter()
            .layout_no_wrap(self.face.clone(), font, self.colour);
        words.size().x + 20.0
    }

    /// Draws the button in a rectangle, and returns its response.
    fn show(&self, ui: &Ui, rect: Rect) -> Response {
        let response = ui.interact(rect, Id::unique(("bar", &self.about)), Sense::click());
        let painter = ui.painter();
        if response.hovered() {
            painter.rect_filled(rect.shrink2(vec2(1.0, 5.0)), 6.0, HOVERED);
        }
        let size = if self.face.chars().count() == 1 {
            18.0
        } else {
            13.5
        };
        painter.text(
            rect.center(),
            Align2::CENTER_CENTER,
            &self.face,
            FontId::proportional(size),
            self.colour,
        );
        response.on_hover_text(&self.about)
    }
}

/// Draws the bar, if the window has room for it, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<Request> {
    let (window, picture) = (ctx.viewport_rect(), ctx.content_rect());
    let height = layout::bar_height(session, [window.width(), window.height()]);
    if height == 0.0 {
        return None;
    }
    let right = if layout::is_bar_whole(session, window.width()) {
        window.right()
    } else {
        picture.right()
    };
    let rect = Rect::from_min_max(
        pos2(picture.left(), window.bottom() - height),
        pos2(right, window.bottom()),
    );
    docked(ctx, "controls", rect, |ui| {
        contents(ui, rect.shrink2(vec2(8.0, 0.0)), session)
    })
}

/// Draws the buttons at both ends of a rectangle, and the timeline between them.
fn contents(ui: &Ui, rect: Rect, session: &Session) -> Option<Request> {
    let mut request = None;
    let mut place = |button: &Button, left: f32, width: f32| {
        let room = Rect::from_min_max(pos2(left, rect.top()), pos2(left + width, rect.bottom()));
        if button.show(ui, room).clicked() {
            request = Some(Request::Act(button.action));
        }
    };
    let (mut left, mut right) = (rect.left(), rect.right());
    let touch = session.readings.touch;
    let symbol = SYMBOL_WIDTHS[usize::from(touch)];
    let few = touch && rect.width() < MIN_WIDTH_OF_ALL;
    for (k, button) in running(session).iter().enumerate() {
        // Start again, and play or pause.
        if !few || k % 2 == 0 {
            place(button, left, symbol);
            left += symbol;
        }
    }
    let mut others = others(session);
    let width = |buttons: &[Button]| buttons.iter().map(|it| it.width(ui, symbol)).sum::<f32>();
    let room = right - left - MIN_TIMELINE_WIDTH;
    // In a narrow bar, a symbol has to do for scene and solver; then the last buttons go.
    if width(&others) > room {
        others[0].face = "☰".into();
        others[1].face = "∫".into();
    }
    while width(&others) > right - left && others.len() > 3 {
        others.remove(others.len() - 2);
    }
    for button in others.iter().rev() {
        let width = button.width(ui, symbol);
        right -= width;
        place(button, right, width);
    }
    let room = Rect::from_min_max(
        pos2(left + 14.0, rect.top()),
        pos2(right - 14.0, rect.bottom()),
    );
    let drawn = session.readings.timeline.filter(|_| room.width() > 60.0);
    let moved = drawn.and_then(|position| timeline::show(ui, room, &position));
    moved.map(Request::Change).or(request)
}

/// Returns the buttons for the run: reset, back, play or pause, and a step.
fn running(session: &Session) -> [Button; 4] {
    let run = Action::Run;
    let (play, does) = if session.animated() {
        ("⏸", "Pause (Space)")
    } else {
        ("▶", "Play (Space)")
    };
    let step = if session.readings.rewound() {
        "One frame on (.)"
    } else {
        "One step (.)"
    };
    [
        Button::new("⟲", "Start again (r)", run(RunAction::Reset)),
        Button::new("⏮", "One frame back (,)", run(RunAction::Scrub(-1))),
        Button::new(play, does, run(RunAction::Pause)),
        Button::new("⏭", step, run(RunAction::Step)),
    ]
}

/// Returns the other buttons: scene, solver, and what can be left out in a narrow bar, before the
/// help.
fn others(session: &Session) -> Vec<Button> {
    let (run, window) = (Action::Run, Action::Window);
    let first = session.runs.first();
    let scene = format!("{} ⏷", first.scene().name);
    let solver: String = match session.runs.panes.len() {
        1 if session.panel.hidden.solvers => first.method().name.into(),
        1 => format!("{} ⏷", first.method().name),
        _ => "solvers ⏷".into(),
    };
    let live = session.readings.film.as_ref().is_some_and(|film| film.live);
    let (film, does) = if live {
        ("⏹", "Stop and write the film (m)")
    } else {
        ("⏺", "Film from now on (m)")
    };
    [
        (&*scene, "Choose a scene (o)", run(RunAction::Scenes)),
        (&*solver, "Choose a solver (e)", run(RunAction::Solvers)),
        (
            "📈",
            "Measure: chart, limits, choice, parts (q)",
            run(RunAction::Measure),
        ),
        ("⚙", "Tune and plot (Tab)", run(RunAction::Panel)),
        ("📖", "Lessons (F1)", run(RunAction::Lessons)),
        ("⛶", "Full screen (F11)", window(WindowAction::FullScreen)),
        (
            "🗠",
            "Plot particles, bodies and springs (F3)",
            run(RunAction::Plots),
        ),
        (
            "⚽",
            "Throw a ball; with Shift, a heavy one (F4)",
            window(WindowAction::Throw),
        ),
        ("✏", "Throw, add, join, delete (F2)", run(RunAction::Edit)),
        ("⮪", "Undo (z)", window(WindowAction::Undo)),
        ("📷", "Save a picture (p)", window(WindowAction::Picture)),
        (film, does, window(WindowAction::Record)),
        ("?", "Help, and everything else (h)", run(RunAction::Help)),
    ]
    .into_iter()
    .filter(|(.., action)| is_there(session, *action))
    .map(|(face, about, action)| Button {
        colour: colour(session, action),
        ..Button::new(face, about, action)
    })
    .collect()
}

/// Returns whether the bar has the button of an action. A telephone has no key that fills the
/// screen.
fn is_there(session: &Session, action: Action) -> bool {
    match action {
        Action::Run(RunAction::Measure) => session.measuring.answerer.is_some(),
        Action::Run(action @ (RunAction::Panel | RunAction::Lessons)) => {
            session.panel.hidden.refusal(action).is_none()
        }
        Action::Window(WindowAction::FullScreen) => IS_PAGE,
        Action::Run(RunAction::Edit) | Action::Window(WindowAction::Throw) => {
            session.runs.first().model().network().is_some()
        }
        _ => is_here(action),
    }
}

/// Returns the colour of the button of an action.
fn colour(session: &Session, action: Action) -> Color32 {
    let is_open = match action {
        Action::Window(WindowAction::Record) => return ALARM.colour,
        Action::Run(RunAction::Measure) => session.measuring.open,
        Action::Run(RunAction::Panel) => session.panel.open,
        Action::Run(RunAction::Edit) => session.panel.editor.open,
        _ => false,
    };
    if is_open { FAINT } else { TEXT }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, SafeAreaInsets};

    use super::*;
    use crate::hud::all::show_all;
    use crate::hud::panel::PanelRequest;
    use crate::hud::style::context;
    use crate::session::{TimelinePosition, session};

    /// Draws the bar in a window of a size (points), and presses at a place. Returns its text, the
    /// places of its parts, and the request.
    fn draw(
        ctx: &Context,
        session: &Session,
        [width, height]: [f32; 2],
        at: Pos2,
    ) -> (String, Vec<Rect>, Option<Request>) {
        let window = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
        let bottom = layout::bar_height(session, [width, height]);
        let press = |pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::default(),
        };
        let (mut words, mut places, mut request) = (String::new(), vec![], None);
        for event in [None, None, Some(press(true)), Some(press(false))] {
            let input = RawInput {
                screen_rect: Some(window),
                safe_area_insets: Some(SafeAreaInsets(egui::epaint::MarginF32 {
                    bottom,
                    ..Default::default()
                })),
                events: [Event::PointerMoved(at)].into_iter().chain(event).collect(),
                ..RawInput::default()
            };
            let mut output = ctx.run_ui(input, |ui| request = show(ui.ctx(), session).or(request));
            output.textures_delta.set.clear();
            output.textures_delta.free.clear();
            (words, places) = (String::new(), vec![]);
            for clipped in &output.shapes {
                if let egui::Shape::Text(text) = &clipped.shape {
                    let rect = text.visual_bounding_rect();
                    assert!(window.contains_rect(rect), "{:?}", text.galley.text());
                    words.extend([text.galley.text(), "\n"]);
                    places.push(rect);
                }
            }
        }
        (words, places, request)
    }

    /// Returns a session whose runs are in the middle of their timeline.
    fn rewound() -> Session {
        let mut session = session(&["t", "0.01", "--paused"]);
        session.readings.timeline = Some(TimelinePosition {
            share: 0.5,
            back: 1.5,
            span: 3.0,
            blew_up: false,
        });
        session
    }

    #[test]
    fn buttons_have_symbols_in_the_fonts_and_never_overlap() {
        let (ctx, session) = (context(), rewound());
        let away = Pos2::new(5.0, 5.0);
        for width in [280.0, 400.0, 600.0, 700.0, 1280.0, 1920.0] {
            let (words, places, _) = draw(&ctx, &session, [width, 600.0], away);
            for (k, a) in places.iter().enumerate() {
                let apart = places[..k].iter().all(|b| !a.shrink(1.0).intersects(*b));
                assert!(apart, "{words} in {width}");
            }
            assert!(
                words.contains('▶') && words.contains('?'),
                "{words} in {width}"
            );
        }
        let (words, ..) = draw(&ctx, &session, [1280.0, 720.0], away);
        for said in ["cloth ⏷", "trapezoid ⏷", "1.50 s back", "3.0 s kept"] {
            assert!(words.contains(said), "{said} in {words}");
        }
        let font = FontId::proportional(18.0);
        for symbol in words.chars().chain("⏸⏹☰∫✖⛶".chars()).filter(|c| *c != '\n') {
            let known = ctx.fonts_mut(|fonts| fonts.has_glyph(&font, symbol));
            assert!(known, "{symbol}");
        }
        // Fingers have larger buttons, and on a phone the lessons are among them.
        let mut touched = rewound();
        touched.readings.touch = true;
        for width in [360.0, 390.0, 844.0] {
            let (words, places, _) = draw(&ctx, &touched, [width, 600.0], away);
            assert!(words.contains('📖') && words.contains('▶'), "{words}");
            assert_eq!(words.contains('⏭'), width > 500.0, "{words}");
            let middles = places.iter().map(|place| place.center().x);
            let middles: Vec<_> = middles.filter(|x| *x > 0.5 * width).collect();
            let apart = middles
                .iter()
                .filter(|x| middles.iter().any(|y| y - *x > 0.0 && y - *x < 40.0));
            assert_eq!(apart.count(), 0, "{words}");
        }
        // A tiny window has no bar.
        assert_eq!(draw(&ctx, &session, [200.0, 150.0], away).0, "");
    }

    #[test]
    fn a_press_plays_and_goes_along_the_timeline() {
        let (ctx, session) = (context(), rewound());
        let size = [1280.0, 720.0];
        let (.., request) = draw(&ctx, &session, size, Pos2::new(93.0, 700.0));
        assert_eq!(request, Some(Request::Act(Action::Run(RunAction::Pause))));
        let (.., request) = draw(&ctx, &session, size, Pos2::new(400.0, 705.0));
        let Some(Request::Change(PanelRequest::GoTo(share))) = request else {
            panic!("{request:?}");
        };
        assert!(share > 0.2 && share < 0.4, "{share}");
        let (.., request) = draw(&ctx, &session, size, Pos2::new(400.0, 600.0));
        assert_eq!(request, None);
    }

    /// What is beside the picture leaves the bar to the mouse, also after it has opened.
    #[test]
    fn panes_beside_the_picture_cover_no_button() {
        let (ctx, mut session) = (context(), session(&["t", "0.01"]));
        let window = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 720.0));
        for action in [RunAction::Panel, RunAction::Lessons] {
            session.act(action, 0);
            let size = layout::picture_size(&session, (1280, 720), 1.0);
            let at = pos2(size.0 as f32 - 30.0, 700.0);
            for _ in 0..4 {
                let input = RawInput {
                    screen_rect: Some(window),
                    safe_area_insets: Some(SafeAreaInsets(egui::epaint::MarginF32 {
                        bottom: (720 - size.1) as f32,
                        right: (1280 - size.0) as f32,
                        ..Default::default()
                    })),
                    ..RawInput::default()
                };
                let mut output = ctx.run_ui(input, |ui| {
                    let _ = show_all(ui.ctx(), &session, &HashMap::new());
                });
                output.textures_delta.set.clear();
                output.textures_delta.free.clear();
            }
            let layer = ctx.layer_id_at(at).unwrap();
            assert_eq!(layer.id, Id::unique("controls"), "{action:?}");
        }
    }
}
