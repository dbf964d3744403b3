//! A session in place of another one, in the same window.

use super::looks;
use super::state::Session;

/// Shows another session in place of the present one, with the settings of the window.
pub fn replace(session: &mut Session, next: Session) {
    let former = std::mem::replace(session, next);
    let dark = former.runs.panes[0].show.dark;
    looks::set_dark(&mut session.runs.panes, dark);
    session.panel = former.panel;
    (session.panel.pane, session.panel.typed) = (0, None);
    session.panel.editor.forget(&session.runs);
    session.pulled = former.pulled;
    session.scenes.adopt(former.scenes);
    session.readings.in_window = former.readings.in_window;
    session.readings.film = former.readings.film;
}
