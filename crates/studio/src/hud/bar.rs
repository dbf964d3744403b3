//! The bar below the picture: what a user does most, as buttons, and the timeline.

use egui::{Align2, Color32, Context, CursorIcon, FontId, Id, Rect, Sense, Stroke, Ui, pos2, vec2};

use super::dock::docked;
use super::layout;
use super::style::{ALARM, FAINT, INK, PAPER, TEXT};
use super::widgets::{Asks, CHOSEN, MIDDLE, ask, write};
use super::words::digits;
use crate::session::{
    Action, IS_PAGE, PanelRequest, RunAction, Session, TimelinePosition, WindowAction, is_here,
};

/// Width of a button with a symbol, for the mouse and for fingers (points).
const SYMBOL_WIDTHS: [f32; 2] = [34.0, 44.0];
/// Width of a bar below which fingers have fewer buttons for the run (points).
const MIN_WIDTH_OF_ALL: f32 = 480.0;
/// Smallest width of the timeline (points).
const MIN_TIMELINE_WIDTH: f32 = 90.0;

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
    fn new(face: &str, about: &str, action: impl Into<Action>) -> Self {
        Self { face: face.into(), about: about.into(), action: action.into(), colour: TEXT }
    }

    /// Returns the width of the button (points), if one with a symbol is `least` wide.
    fn width(&self, ui: &Ui, least: f32) -> f32 {
        let size = self.size();
        if size > 14.0 {
            return least;
        }
        let (face, font) = (self.face.clone(), FontId::proportional(size));
        let words = ui.painter().layout_no_wrap(face, font, self.colour);
        words.size().x + 20.0
    }

    /// Returns the size of the face (points): symbols are larger than words.
    fn size(&self) -> f32 {
        if self.face.chars().count() == 1 { 18.0 } else { 13.5 }
    }

    /// Draws the button in a rectangle.
    fn show(&self, ui: &Ui, rect: Rect) {
        let response = ui.interact(rect, Id::unique(("bar", &self.about)), Sense::click());
        let painter = ui.painter();
        if response.hovered() {
            painter.rect_filled(rect.shrink2(vec2(1.0, 5.0)), 6.0, CHOSEN);
        }
        let (at, size) = (rect.center(), self.size());
        write(painter, at, MIDDLE, &self.face, size, self.colour);
        response.on_hover_text(&self.about).asks(self.action);
    }
}

/// Draws the bar, if the window has room for it.
pub fn show(ctx: &Context, session: &Session) {
    let (window, picture) = (ctx.viewport_rect(), ctx.content_rect());
    let [above, buttons] = layout::bar_rows(session, [window.width(), window.height()]);
    if buttons == 0.0 {
        return;
    }
    let right = if layout::is_bar_whole(session, window.width()) {
        window.right()
    } else {
        picture.right()
    };
    let left = picture.left();
    let rect = window.with_min_y(window.bottom() - above - buttons);
    let rect = rect.with_min_x(left).with_max_x(right);
    docked(ctx, "controls", rect, |ui| {
        contents(ui, rect.shrink2(vec2(8.0, 0.0)), above, session);
    });
}

/// Draws the buttons at both ends of a rectangle, and the timeline between them, or above them if
/// it has a height there (points).
fn contents(ui: &Ui, whole: Rect, above: f32, session: &Session) {
    let rect = whole.with_min_y(whole.top() + above);
    let place = |button: &Button, left: f32, width: f32| {
        let room = Rect::from_x_y_ranges(left..=left + width, rect.y_range());
        button.show(ui, room);
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
    let room = right - left - if above > 0.0 { 0.0 } else { MIN_TIMELINE_WIDTH };
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
    let strip = whole.with_max_y(rect.top()).shrink2(vec2(14.0, 0.0));
    let between = rect.with_min_x(left + 14.0).with_max_x(right - 14.0);
    let room = if above > 0.0 { strip } else { between };
    if let Some(position) = session.readings.timeline.filter(|_| room.width() > 60.0) {
        timeline(ui, room, &position);
    }
}

/// Returns the buttons for the run: reset, back, play or pause, and a step.
fn running(session: &Session) -> [Button; 4] {
    let (play, does) =
        if session.animated() { ("⏸", "Pause (Space)") } else { ("▶", "Play (Space)") };
    let step = if session.readings.rewound() { "One frame on (.)" } else { "One step (.)" };
    [
        Button::new("⟲", "Start again (r)", RunAction::Reset),
        Button::new("⏮", "One frame back (,)", RunAction::Scrub(-1)),
        Button::new(play, does, RunAction::Pause),
        Button::new("⏭", step, RunAction::Step),
    ]
}

/// Returns the other buttons: scene, solver, and what can be left out in a narrow bar, before the
/// help.
fn others(session: &Session) -> Vec<Button> {
    let first = session.runs.first();
    let scene = format!("{} ⏷", first.scene().name);
    let solver: String = match session.runs.panes.len() {
        1 if session.panel.hidden.solvers => first.method().name.into(),
        1 => format!("{} ⏷", first.method().name),
        _ => "solvers ⏷".into(),
    };
    let live = session.readings.film.as_ref().is_some_and(|film| film.live);
    let (film, does) =
        if live { ("⏹", "Stop and write the film (m)") } else { ("⏺", "Film from now on (m)") };
    [
        Button::new(&scene, "Choose a scene (o)", RunAction::Scenes),
        Button::new(&solver, "Choose a solver (e)", RunAction::Solvers),
        Button::new("📈", "Measure: chart, limits, choice, parts (q)", RunAction::Measure),
        Button::new("⚙", "Tune and plot (Tab)", RunAction::Panel),
        Button::new("📖", "Lessons (F1)", RunAction::Lessons),
        Button::new("⛶", "Full screen (F11)", WindowAction::FullScreen),
        Button::new("🗠", "Plot particles, bodies and springs (F3)", RunAction::Plots),
        Button::new("⚽", "Throw a ball; with Shift, a heavy one (F4)", WindowAction::Throw),
        Button::new("✏", "Throw, add, join, delete (F2)", RunAction::Edit),
        Button::new("⮪", "Undo (z)", WindowAction::Undo),
        Button::new("📷", "Save a picture (p)", WindowAction::Picture),
        Button::new(film, does, WindowAction::Record),
        Button::new("?", "Help, and everything else (h)", RunAction::Help),
    ]
    .into_iter()
    .filter(|button| is_there(session, button.action))
    .map(|button| Button { colour: colour(session, button.action), ..button })
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
        Action::Run(RunAction::Edit) => session.panel.editor.open,
        Action::Run(pane) => session.panel.has(pane),
        _ => false,
    };
    if is_open { FAINT } else { TEXT }
}

/// Draws the timeline in a room: a track with a thumb at the chosen moment, and a cross at the end
/// if the run blew up there.
fn timeline(ui: &Ui, room: Rect, position: &TimelinePosition) {
    let (wide, id) = (room.expand2(vec2(8.0, 0.0)), Id::unique("timeline"));
    let response = ui.interact(wide, id, Sense::click_and_drag());
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let (painter, y) = (ui.painter(), room.bottom() - 0.325 * room.height());
    let at = room.left() + position.share * room.width();
    let line = |from, to, color| {
        painter.hline(from..=to, y, Stroke::new(4.0, color));
    };
    line(room.left(), room.right(), FAINT.gamma_multiply(0.35));
    line(room.left(), at, INK);
    if position.blew_up {
        let stroke = Stroke::new(2.0, ALARM.colour);
        for way in [-4.0, 4.0] {
            let end = room.right() + 8.0;
            painter.line_segment([pos2(end - 4.0, y - way), pos2(end + 4.0, y + way)], stroke);
        }
    }
    painter.circle_filled(pos2(at, y), 6.5, INK);
    painter.circle_filled(pos2(at, y), 2.5, PAPER);
    let say = |x, align, words: String, color| {
        let place = pos2(x, room.top() + 0.125 * room.height());
        write(painter, place, align, words, 12.0, color);
    };
    if position.share < 1.0 {
        let back = format!("{} s back", digits(position.back));
        say(room.left(), Align2::LEFT_TOP, back, TEXT);
    }
    if room.width() > 150.0 {
        let (words, color) = if position.blew_up {
            ("✖ it blew up".into(), ALARM.colour)
        } else {
            (format!("{:.1} s kept", position.span), FAINT)
        };
        say(room.right(), Align2::RIGHT_TOP, words, color);
    }
    let held = response.dragged() || response.clicked();
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| held) {
        let share = (pointer.x - room.left()) / room.width();
        ask(ui, PanelRequest::GoTo(share.clamp(0.0, 1.0)));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use egui::Pos2;

    use super::*;
    use crate::hud::all::show_all;
    use crate::hud::window::Window;
    use crate::session::session;

    /// Draws the bar in a window, and clicks at a place. Returns its text, the places of its parts,
    /// and the action.
    fn draw(
        window: &mut Window,
        session: &Session,
        at: Pos2,
    ) -> (String, Vec<Rect>, Option<Action>) {
        let bottom = layout::bar_height(session, window.place.size().into());
        let action = window.click([0.0, bottom], at, |ctx| show(ctx, session));
        let places = window.read().into_iter().map(|(_, place)| place);
        (window.words(), places.collect(), action)
    }

    /// Returns a session whose runs are in the middle of their timeline.
    fn rewound() -> Session {
        let mut session = session(&["t", "0.01", "--paused"]);
        session.readings.timeline =
            Some(TimelinePosition { share: 0.5, back: 1.5, span: 3.0, blew_up: false });
        session
    }

    #[test]
    fn buttons_have_symbols_in_the_fonts_and_never_overlap() {
        let (session, away) = (rewound(), pos2(5.0, 5.0));
        for width in [280.0, 400.0, 600.0, 700.0, 1280.0, 1920.0] {
            let mut window = Window::new([width, 600.0]);
            let (words, places, _) = draw(&mut window, &session, away);
            for (k, a) in places.iter().enumerate() {
                let apart = places[..k].iter().all(|b| !a.shrink(1.0).intersects(*b));
                assert!(apart, "{words} in {width}");
            }
            assert!(words.contains('▶') && words.contains('?'), "{words} in {width}");
        }
        let mut window = Window::new([1280.0, 720.0]);
        let (words, ..) = draw(&mut window, &session, away);
        for said in ["cloth ⏷", "trapezoid ⏷", "1.50 s back", "3.0 s kept"] {
            assert!(words.contains(said), "{said} in {words}");
        }
        let font = FontId::proportional(18.0);
        for symbol in words.chars().chain("⏸⏹☰∫✖⛶".chars()).filter(|c| *c != '\n') {
            let known = window.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, symbol));
            assert!(known, "{symbol}");
        }
        // Fingers have larger buttons, and on a phone the lessons are among them.
        let mut touched = rewound();
        touched.readings.touch = true;
        for width in [360.0, 390.0, 844.0] {
            let mut window = Window::new([width, 600.0]);
            let (words, places, _) = draw(&mut window, &touched, away);
            assert!(words.contains('📖') && words.contains('▶'), "{words}");
            assert_eq!(words.contains('⏭'), width > 500.0, "{words}");
            // The timeline is above the buttons of a phone.
            let buttons = places.iter().filter(|place| place.center().y > 552.0);
            let middles = buttons.map(|place| place.center().x);
            let middles: Vec<_> = middles.filter(|x| *x > 0.5 * width).collect();
            let apart =
                middles.iter().filter(|x| middles.iter().any(|y| y - *x > 0.0 && y - *x < 40.0));
            assert_eq!(apart.count(), 0, "{words}");
        }
        // A tiny window has no bar.
        let mut tiny = Window::new([200.0, 150.0]);
        assert_eq!(draw(&mut tiny, &session, away).0, "");
    }

    #[test]
    fn a_press_plays_and_goes_along_the_timeline() {
        let (mut window, session) = (Window::new([1280.0, 720.0]), rewound());
        let mut click = |x, y| draw(&mut window, &session, pos2(x, y)).2;
        assert_eq!(click(93.0, 700.0), Some(RunAction::Pause.into()));
        let request = click(400.0, 705.0);
        let Some(Action::Panel(PanelRequest::GoTo(share))) = request else {
            panic!("{request:?}");
        };
        assert!(share > 0.2 && share < 0.4, "{share}");
        assert_eq!(click(400.0, 600.0), None);
    }

    /// What is beside the picture leaves the bar to the mouse, also after it has opened.
    #[test]
    fn panes_beside_the_picture_cover_no_button() {
        let (mut window, mut session) = (Window::new([1280.0, 720.0]), session(&["t", "0.01"]));
        for action in [RunAction::Panel, RunAction::Lessons] {
            session.act(action, 0);
            let taken = layout::insets(&session, (1280, 720), 1.0);
            for _ in 0..4 {
                window.frame(taken, vec![], |ctx| {
                    show_all(ctx, &session, &HashMap::new());
                });
            }
            let at = pos2(1280.0 - taken[0] - 30.0, 700.0);
            let layer = window.ctx.layer_id_at(at).unwrap();
            assert_eq!(layer.id, Id::unique("controls"), "{action:?}");
        }
    }
}
