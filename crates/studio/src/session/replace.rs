//! A session in place of another one, in the same window, or a scene in place of its edited one.

use a3_scenes::Description;

use super::looks;
use super::origin::Origin;
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
    session.measuring.answerer = former.measuring.answerer;
    session.scenes.adopt(former.scenes);
    session.readings.in_window = former.readings.in_window;
    session.readings.touch = former.readings.touch;
    session.readings.film = former.readings.film;
}

/// Shows the present scene as it was edited, or without edits, unless it is shown so already. Fails
/// if such a scene cannot be built.
pub fn show_edited(session: &mut Session, edited: Option<&Description>) -> Result<(), String> {
    let own = session.scenes.unedited();
    let next = match edited {
        Some(description) => Origin {
            source: own.source.described(description.clone()),
            grid: None,
            edited: true,
            ..own
        },
        None => own,
    };
    let shown = &session.scenes.shown;
    if next.source.description == shown.source.description && next.edited == shown.edited {
        return Ok(());
    }
    let setup = next.build().map_err(|error| error.to_string())?;
    session.scenes.shown = next;
    session.set_scene(&setup);
    Ok(())
}
