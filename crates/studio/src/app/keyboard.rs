//! Translation of winit's keys to those of the table of keys, of the panel, and of text.

use winit::event::KeyEvent;
use winit::keyboard::{Key, NamedKey};

use crate::session::{self, Action, PanelKey, TextKey, WindowAction};

/// Returns the action of a key, if it has one.
pub fn action(key: &Key) -> Option<Action> {
    let named;
    session::action(match key {
        Key::Named(NamedKey::Escape) => "Esc",
        Key::Named(NamedKey::Delete) => "Del",
        Key::Named(NamedKey::PageUp) => "PgUp",
        Key::Named(NamedKey::PageDown) => "PgDn",
        // Space, Tab and F1 to F11 have the same names here.
        Key::Named(key) => {
            named = format!("{key:?}");
            &named
        }
        Key::Character(text) if text == " " => "Space",
        Key::Character(text) if text.chars().count() == 1 => text,
        _ => return None,
    })
}

/// Returns the number of steps by which a key, with Ctrl, enlarges text and panel; 0 resets their
/// size.
pub fn zoom(key: &Key) -> Option<isize> {
    match key {
        Key::Character(text) if text == "+" || text == "=" => Some(1),
        Key::Character(text) if text == "-" => Some(-1),
        Key::Character(text) if text == "0" => Some(0),
        _ => None,
    }
}

/// Returns the action of a key that is pressed with Ctrl, if it has one.
pub fn control_action(key: &Key) -> Option<Action> {
    let Key::Character(text) = key else {
        return None;
    };
    let action = match text.to_lowercase().as_str() {
        "z" => WindowAction::Undo,
        "y" => WindowAction::Redo,
        "q" => WindowAction::Close,
        _ => return None,
    };
    Some(Action::Window(action))
}

/// Returns whether a key marks the whole text with Ctrl, while text is typed.
pub fn marks_all(key: &Key) -> bool {
    matches!(key, Key::Character(text) if text.eq_ignore_ascii_case("a"))
}

/// Returns the meaning of a key in the panel, if it has one.
pub fn panel_key(key: &Key) -> Option<PanelKey> {
    match key {
        Key::Named(NamedKey::ArrowUp) => Some(PanelKey::Up),
        Key::Named(NamedKey::ArrowDown) => Some(PanelKey::Down),
        Key::Named(NamedKey::ArrowLeft) => Some(PanelKey::Left),
        Key::Named(NamedKey::ArrowRight) => Some(PanelKey::Right),
        Key::Named(NamedKey::Enter) => Some(PanelKey::Toggle),
        _ => None,
    }
}

/// Returns the meaning of a key while text is typed, if it has one.
pub fn text_key(event: &KeyEvent) -> Option<TextKey> {
    Some(match &event.logical_key {
        Key::Named(NamedKey::ArrowUp) => TextKey::Move(-1),
        Key::Named(NamedKey::ArrowDown) => TextKey::Move(1),
        Key::Named(NamedKey::PageUp) => TextKey::Move(-10),
        Key::Named(NamedKey::PageDown) => TextKey::Move(10),
        Key::Named(NamedKey::Enter) => TextKey::Accept,
        Key::Named(NamedKey::Escape) => TextKey::Cancel,
        Key::Named(NamedKey::Backspace) => TextKey::Erase,
        _ => {
            let text = event.text.as_ref()?;
            TextKey::Type(text.chars().next().filter(|c| !c.is_control())?)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{RunAction, bindings};

    #[test]
    fn every_key_of_the_table_can_be_typed() {
        for binding in bindings() {
            for &key in binding.keys {
                let typed = match key {
                    "Space" => Key::Named(NamedKey::Space),
                    "Esc" => Key::Named(NamedKey::Escape),
                    "Tab" => Key::Named(NamedKey::Tab),
                    "Del" => Key::Named(NamedKey::Delete),
                    "F11" => Key::Named(NamedKey::F11),
                    "PgUp" => Key::Named(NamedKey::PageUp),
                    "PgDn" => Key::Named(NamedKey::PageDown),
                    "F1" => Key::Named(NamedKey::F1),
                    "F3" => Key::Named(NamedKey::F3),
                    "F2" => Key::Named(NamedKey::F2),
                    "F4" => Key::Named(NamedKey::F4),
                    key => Key::Character(key.into()),
                };
                assert_eq!(action(&typed), Some(binding.action));
            }
        }
        assert_eq!(action(&Key::Character(" ".into())), Some(Action::Run(RunAction::Pause)));
        assert_eq!(action(&Key::Character("10".into())), None);
        assert_eq!(action(&Key::Character("Tab".into())), None);
        assert_eq!(action(&Key::Named(NamedKey::F5)), None);
    }

    #[test]
    fn with_ctrl_few_letters_do_anything_and_none_what_it_does_alone() {
        let mut acting = String::new();
        for letter in 'a'..='z' {
            let key = Key::Character(letter.to_string().into());
            if let Some(with) = control_action(&key) {
                acting.push(letter);
                assert!(letter == 'z' || Some(with) != action(&key), "{letter}");
            }
        }
        assert_eq!(acting, "qyz");
    }
}
