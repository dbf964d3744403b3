//! Editing the scene: the tools, and obstacles that the mouse drags.

use std::fs::read_to_string;

use crate::display::{Display, until};
use crate::screen::is_red;

#[test]
fn a_ball_is_thrown_at_the_cloth_and_deleted() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    app.expect("particles", "400");
    app.wait("time", |time| time > 1.0);
    app.press_for("F2", "tools", "true");
    let (x, y) = display.screen().middle(is_red);
    let (left, top) = app.corner();
    app.point(x - left, y - top);
    app.expect("cursor", "Crosshair");
    display.xdotool("click 1");
    app.expect("particles", "402");
    let time = app.number("time").unwrap();
    app.wait("time", |t| t > time + 1.0);
    app.expect("blown", "false");
    app.press_for("z", "particles", "400");
    app.press_for("Z", "particles", "402");
    // A click on a tool is none on the scene. This one adds a particle.
    app.point(640, 595);
    app.expect_frames();
    display.xdotool("click 1");
    app.expect("cursor", "Default");
    app.point(300, 500);
    app.expect("cursor", "Crosshair");
    display.xdotool("click 1");
    app.expect("particles", "403");
    // With a tool that throws, a drag does.
    app.point(391, 600);
    app.expect_frames();
    display.xdotool("click 1");
    app.point(300, 450);
    app.expect("cursor", "Crosshair");
    display.xdotool("mousedown 1");
    app.expect_frames();
    app.point(400, 300);
    app.expect_frames();
    display.xdotool("mouseup 1");
    app.expect("particles", "405");
    app.press_for("Escape", "tools", "false");
    // Without tools, a key throws, again and again.
    app.press_for("F4", "particles", "407");
    app.press_for("shift+F4", "particles", "409");
    app.press_for("z", "particles", "407");
    app.quit();
}

#[test]
fn a_box_is_dragged_and_written() {
    let Some(display) = Display::open() else {
        return;
    };
    let scene = "[particles]\npositions = [[0, 3, 0]]\nmass = 1\n\
        [[box]]\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\n\
        [camera]\neye = [0, 0, 8]\ntarget = [0, 0, 0]\n";
    std::fs::write(display.home.join("block.toml"), scene).unwrap();
    let app = display.open_app("t 0.01 --scene block.toml");
    let go = |x: &str| {
        app.point(x, 340);
        app.expect_frames();
    };
    go("790");
    app.expect("cursor", "Move");
    display.xdotool("mousedown 1");
    app.expect("cursor", "Grabbing");
    go("950");
    let time = app.number("time").unwrap();
    app.wait("time", |t| t > time + 0.5);
    display.xdotool("mouseup 1");
    app.expect("cursor", "Move");
    let place = |name: &str| {
        let path = display.home.join(name);
        display.xdotool("key f");
        let text = until("a file", || read_to_string(&path).ok());
        let line = text.lines().find_map(|line| line.strip_prefix("center = ["));
        let first = line.and_then(|line| line.split(',').next()).unwrap();
        first.parse::<f64>().unwrap()
    };
    let moved = place("a3-block-1.toml");
    assert!(moved > 0.5, "{moved}");
    display.xdotool("key z");
    app.expect("cursor", "Default");
    assert_eq!(place("a3-block-2.toml"), 0.0);
    app.quit();
}
