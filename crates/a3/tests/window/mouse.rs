//! The mouse: pulling, pinning, listing springs, drawing boxes, and going back on the timeline.

use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::display::{Display, until};
use crate::screen::{is_amber, is_red};

#[test]
fn pulling() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    app.wait("time", |time| time > 2.0);
    // Convert to positions in the window.
    let (x, y) = display.screen().middle(is_red);
    let (left, top) = app.corner();
    let (x, y) = (x - left, y - top);
    let go = |x: i32, y: i32| {
        app.point(x, y);
    };
    // The shape of the pointer tells the effect of a press.
    go(30, 600);
    app.expect("cursor", "Default");
    go(x, y);
    app.expect("cursor", "Grab");
    display.xdotool("mousedown 1");
    until("a grip", || (app.get("grabbed") != "-").then_some(()));
    app.expect("cursor", "Grabbing");
    let particle = app.get("grabbed");
    let hand = || {
        let (x, y) = app.get("hand").split_once(',').map(|(x, y)| (x.parse(), y.parse()))?;
        Some((x.ok()?, y.ok()?))
    };
    let (hx, hy): (i32, i32) = until("a hand", hand);
    assert!(
        hx.abs_diff(x) < 40 && hy.abs_diff(y) < 40,
        "the particle {hx},{hy} is near the pointer {x},{y}"
    );
    // The mark is a small ball, half of it in the shade. Folds may hide it later.
    until("the mark of the grabbed particle", || {
        (display.screen().count(is_amber) > 2).then_some(())
    });
    // A fast drag, in jumps, as far as the springs may stretch: the particle keeps its offset from
    // the pointer.
    let off = (hx - x, hy - y);
    for (dx, dy) in [(150, -60), (-170, -40), (90, 40)] {
        go(x + dx, y + dy);
        until("the particle under the pointer", || {
            let (hx, hy) = hand()?;
            (hx.abs_diff(x + dx + off.0) < 3 && hy.abs_diff(y + dy + off.1) < 3).then_some(())
        });
        assert_eq!(app.get("grabbed"), particle);
        app.expect_frames();
    }
    display.xdotool("mouseup 1");
    app.expect("grabbed", "-");
    app.expect("blown", "false");
    // Beside the cloth, there is nothing to grab.
    app.point_and(1200, 650, "mousedown 1");
    app.expect_frames();
    assert_eq!(app.get("grabbed"), "-");
    display.xdotool("mouseup 1");
    go(x, y);
    app.expect("cursor", "Grab");
    app.press_for("i", "parallel", "true");
    app.press_for("i", "parallel", "false");
    app.press("j");
    until("a particle to follow", || (app.get("followed") != "-").then_some(()));
    // Where there is no particle, the camera stops following.
    go(30, 600);
    app.press_for("j", "followed", "-");
    app.quit();
}

/// A right click pins and frees, a right drag does not; a double click lists springs; time goes
/// slowly, and back.
#[test]
fn clicks_slow_motion_and_going_back() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    app.wait("time", |time| time > 1.5);
    app.press_for("bracketleft", "slowness", "1");
    app.press_for("bracketleft", "slowness", "2");
    let (time, begun) = (app.number("time").unwrap(), Instant::now());
    sleep(Duration::from_secs(2));
    let factor = (app.number("time").unwrap() - time) / begun.elapsed().as_secs_f64();
    assert!((0.1..0.32).contains(&factor), "{factor} times real time");
    app.press_for("bracketright", "slowness", "1");
    app.press_for("space", "paused", "true");
    let now = app.number("time").unwrap();
    app.press_for("comma", "scrubbed", "true");
    app.press("less");
    app.wait("time", |time| time < now - 0.15);
    app.press("period");
    app.press_for("greater", "scrubbed", "false");
    app.wait("time", |time| time == now);
    // Drag along the timeline.
    app.press_for("comma", "scrubbed", "true");
    let go = |x: &str| app.point(x, 707);
    go("740");
    display.xdotool("mousedown 1");
    go("190");
    app.wait("time", |time| time < 0.4 * now);
    go("1200");
    app.expect("scrubbed", "false");
    display.xdotool("mouseup 1");
    app.wait("time", |time| time == now);

    let (x, y) = app.still_screen().middle(is_red);
    let (left, top) = app.corner();
    let click = |words: &str| app.point_and(x - left, y - top, words);
    assert_eq!(app.get("pins"), "20");
    click("click 3");
    app.expect("pins", "21");
    click("click 3");
    app.expect("pins", "20");
    click("click --repeat 2 --delay 60 1");
    until("springs", || (app.get("springs_of") != "-").then_some(()));
    // Two clicks far apart are no double click.
    let second = format!("click 1 mousemove --window {} 1200 600 click 1", app.window);
    app.point_and(1100, 600, &second);
    // A paused run draws frames only after a change.
    let before = app.still_screen();
    assert_ne!(app.get("springs_of"), "-");
    click("mousedown 3 mousemove_relative 60 20 mouseup 3");
    until("another view", || (display.screen().difference(&before) > 0.5).then_some(()));
    assert_eq!(app.get("pins"), "20");
    app.point(1200, 650);
    display.xdotool("click --repeat 2 --delay 60 1");
    app.expect("springs_of", "-");
    app.quit();
}

/// With Shift, the left button draws a box and pins the particles in it, and the right one frees
/// them. Delete frees all. Key z undoes that, and with Shift redoes it.
#[test]
fn boxes_and_undoing() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01 --paused");
    let drag = |button: &str, [x, y]: [i32; 2], [to_x, to_y]: [i32; 2]| {
        app.point(x, y);
        display.xdotool("keydown shift");
        app.expect("cursor", "Crosshair");
        display.xdotool(["mousedown", button]);
        app.point(500, 300);
        app.point(to_x, to_y);
        display.xdotool(["mouseup", button, "keyup", "shift"]);
    };
    app.expect("pins", "20");
    drag("1", [300, 20], [1000, 670]);
    app.expect("pins", "400");
    drag("3", [300, 20], [1000, 670]);
    app.expect("pins", "0");
    app.press_for("z", "pins", "400");
    app.press_for("z", "pins", "20");
    app.press_for("shift+z", "pins", "400");
    app.press_for("ctrl+z", "pins", "20");
    app.press_for("Delete", "pins", "0");
    app.press_for("z", "pins", "20");
    // A box around nothing changes nothing.
    drag("1", [20, 500], [60, 600]);
    app.still_screen();
    app.expect("pins", "20");
    // A drag of a slider is one change.
    app.press_for("Tab", "panel", "true");
    for (x, words) in [(1120, ""), (1120, "mousedown 1"), (1090, ""), (900, "")] {
        app.point_and(x, 70, words);
        app.still_screen();
    }
    app.expect("step", "0.00001");
    display.xdotool("mouseup 1");
    app.press_for("z", "step", "0.01");
    app.quit();
}
