//! The actions that a session leaves out, as pages for teaching do.

use super::actions::RunAction;
use super::list::Topic;

/// The actions that a session leaves out; none, unless the address of a page says so.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hidden {
    /// The panel, and with it all tuning.
    pub panel: bool,
    /// All other solvers than the first.
    pub solvers: bool,
    /// The lessons.
    pub lessons: bool,
}

impl Hidden {
    /// Returns why an action is left out; `None` if it is not.
    pub fn refusal(&self, action: RunAction) -> Option<&'static str> {
        match action {
            RunAction::Panel if self.panel => Some("This page has no panel."),
            RunAction::Lessons if self.lessons => Some("This page has no lessons."),
            RunAction::Solvers | RunAction::Solver(_) => self.refusal_of_solvers(),
            _ => None,
        }
    }

    /// Returns why a list is left out; `None` if it is not.
    pub fn refusal_of_list(&self, topic: Topic) -> Option<&'static str> {
        match topic {
            Topic::Scenes => None,
            Topic::Solvers { .. } | Topic::Beside { .. } => self.refusal_of_solvers(),
        }
    }

    fn refusal_of_solvers(&self) -> Option<&'static str> {
        self.solvers.then_some("This page has this solver alone.")
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::window::session::session;

    #[test]
    fn what_is_hidden_is_refused_and_nothing_changes() {
        let mut session = session(&["t", "0.01"]);
        session.panel.hidden = Hidden {
            panel: true,
            solvers: true,
            lessons: true,
        };
        for action in [
            RunAction::Panel,
            RunAction::Lessons,
            RunAction::Solvers,
            RunAction::Solver(3),
        ] {
            session.readings.message = None;
            assert!(!session.act(action, 0));
            let said = session.readings.message.take().unwrap();
            assert!(said.starts_with("This page has"), "{said}");
        }
        session.toggle_list(Topic::Beside { pane: 0 });
        assert!(session.list.is_none() && !session.panel.open && !session.panel.lessons.open);
        assert_eq!(session.runs.first().method().name, "trapezoid");
    }

    #[test]
    fn scenes_that_are_not_offered_cannot_be_shown() {
        let strip = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/strip.toml");
        let tear = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/tear.toml");
        let mut session = session(&["t", "0.01", "--scene", "mit"]);
        session.scenes.offer(vec!["mit".into(), strip.into()]);
        assert_eq!(session.scenes.entries().len(), 2);
        let name =
            |session: &crate::window::session::Session| session.runs.first().scene().name.clone();
        for shown in ["strip", "mit", "strip"] {
            session.act(RunAction::NextScene, 0);
            assert_eq!(name(&session), shown);
        }
        assert!(!session.open(Path::new(tear)));
        assert_eq!(name(&session), "strip");
        assert!(session.open(Path::new(strip)));
    }
}
