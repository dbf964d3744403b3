//! The panel: tuning, and saving a tuned run.

use crate::display::{Display, until};

/// Knobs turn by keys and by the mouse, which then acts on nothing else; a scene file keeps the
/// tuning.
#[test]
fn tuning() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("r 0.01");
    app.press_for("Tab", "panel", "true");
    app.press("Down");
    app.press_for("Right", "step", "0.0126");
    app.press_for("shift+Right", "step", "0.0129");
    app.press_for("Return", "step", "0.01");
    app.press_for("s", "swing", "true");
    // Drag the slider of the same row to its end, past the edge of the panel.
    app.point_and(1120, 70, "mousedown 1");
    app.expect_frames();
    app.point(700, 300);
    app.expect("step", "0.00001");
    assert_eq!(app.get("grabbed"), "-");
    display.xdotool("mouseup 1");
    app.expect_frames();
    app.point_and(1250, 70, "click --repeat 2 --delay 60 1");
    app.expect("step", "0.01");
    // While a value is typed, letters and Esc do not act as keys.
    app.point(1250, 70);
    std::thread::sleep(std::time::Duration::from_millis(600));
    display.xdotool("click 1");
    app.expect_frames();
    display.xdotool("type 0.t");
    app.press("BackSpace");
    display.xdotool("type 02");
    app.press_for("Return", "step", "0.02");
    assert_eq!(app.get("scene"), "cloth");
    app.point_and(1250, 70, "click --repeat 2 --delay 60 1");
    app.expect("step", "0.01");
    app.press("u");
    let table = display.home.join("a3-cloth-1.csv");
    until("the plots in a file", || table.exists().then_some(()));
    let table = std::fs::read_to_string(table).unwrap();
    assert!(table.starts_with("solver,time (s),") && table.lines().count() > 3, "{table}");
    app.press_for("F11", "size", "1400x900");
    app.press_for("F11", "size", "1280x720");
    app.press("f");
    let file = display.home.join("a3-cloth-1.toml");
    until("a scene file", || file.exists().then_some(()));
    app.press_for("Tab", "panel", "false");
    app.quit();
    let app = display.open_app("--scene a3-cloth-1.toml");
    for (key, value) in [("scene", "cloth"), ("solver", "rk4"), ("step", "0.01")] {
        assert_eq!(app.get(key), value);
    }
    app.quit();
}

/// Key k saves the run, and key l and the command line load it, with its tuning.
#[test]
fn saving_and_loading() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("r 0.01");
    app.press_for("s", "swing", "true");
    app.press("k");
    let file = display.home.join("a3-cloth-1.checkpoint");
    until("a checkpoint", || file.exists().then_some(()));
    app.press_for("s", "swing", "false");
    app.press_for("plus", "step", "0.012");
    app.press_for("l", "swing", "true");
    app.expect("step", "0.01");
    app.quit();
    let app = display.open_app("--resume a3-cloth-1.checkpoint");
    for (key, value) in [("solver", "rk4"), ("step", "0.01"), ("swing", "true")] {
        assert_eq!(app.get(key), value);
    }
    app.quit();
}
