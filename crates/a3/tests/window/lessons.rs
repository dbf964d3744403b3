//! Lessons in the window (key F1): a step begins its run, and another one replaces it.

use crate::display::Display;

#[test]
fn a_key_opens_the_lessons_and_keys_go_through_them() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("r 0.01 --scene chain");
    app.press("F1");
    app.expect("lesson", "list");
    app.press("Return");
    app.expect("lesson", "1.1");
    app.expect("panes", "2");
    app.expect("scene", "simple");
    // From two panes to one, and to another scene.
    app.press("Right");
    app.expect("lesson", "1.2");
    app.expect("panes", "1");
    app.expect("solver", "euler");
    app.press("Left");
    app.expect("panes", "2");
    app.press("Left");
    app.expect("lesson", "list");
    app.press("Tab");
    app.expect("panel", "true");
    app.expect("lesson", "-");
    app.expect_frames();
}
