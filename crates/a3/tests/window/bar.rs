//! The bar below the picture: buttons, lists, the timeline; and the help, whose rows are buttons.

use crate::display::Display;
use crate::screen::is_red;

/// Height of the middle of the bar in the window (px).
const BAR: i32 = 700;

#[test]
fn the_bar_does_what_keys_do() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    // A button shows under the pointer before it is pressed.
    let click = |x: i32, y: i32| {
        app.point(x, y);
        app.expect_frames();
        display.xdotool("click 1");
    };
    let still = |x: i32, y: i32| {
        app.point(x, y);
        app.still_screen();
        display.xdotool("click 1");
    };
    app.wait("time", |time| time > 1.0);
    click(93, BAR);
    app.expect("paused", "true");
    let time = app.number("time").unwrap();
    still(127, BAR);
    app.wait("time", |t| t > time + 0.009);
    still(59, BAR);
    app.expect("scrubbed", "true");
    // Scenes and solvers, by their lists. A second press closes a list.
    still(806, BAR);
    app.expect("list", "true");
    still(806, BAR);
    app.expect("list", "false");
    still(806, BAR);
    app.expect("list", "true");
    still(450, 390);
    app.expect("list", "false");
    app.expect("scene", "mit");
    app.press_for("Prior", "scene", "chain");
    app.press_for("Prior", "scene", "pendulum");
    app.press_for("Prior", "scene", "simple");
    app.press_for("Prior", "scene", "cloth");
    still(984, BAR);
    app.expect("panel", "true");
    app.press_for("Tab", "panel", "false");
    // A row of the help is a button, too; a click beside the help closes it.
    still(1255, BAR);
    app.expect("help", "true");
    still(280, 341);
    app.expect("wind", "true");
    app.expect("help", "false");
    app.press_for("h", "help", "true");
    still(100, 640);
    app.expect("help", "false");
    app.press_for("d", "wind", "false");
    // A live film begins and ends.
    still(1221, BAR);
    app.expect("film", "true");
    still(1221, BAR);
    app.expect("film", "false");
    // Undo.
    app.press_for("Delete", "pins", "0");
    still(1153, BAR);
    app.expect("pins", "20");
    still(25, BAR);
    app.expect("time", "0.0000");
    // The pointer on the bar pulls nothing.
    assert_eq!(app.get("grabbed"), "-");
    app.quit();
}

/// The hint is there until something is pulled for the first time, also in later windows.
#[test]
fn the_hint_goes_at_the_first_pull() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    app.expect("hint", "true");
    app.wait("time", |time| time > 1.0);
    let (x, y) = display.screen().middle(is_red);
    let (left, top) = app.corner();
    app.point(x - left, y - top);
    app.expect("cursor", "Grab");
    display.xdotool("mousedown 1");
    app.expect("hint", "false");
    display.xdotool("mouseup 1");
    app.expect("grabbed", "-");
    app.quit();
    let app = display.open_app("t 0.01");
    app.expect("hint", "false");
    app.quit();
}
