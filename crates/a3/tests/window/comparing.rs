//! Several methods side by side.

use crate::app::App;
use crate::display::{Display, until};
use crate::keys::SCENES;
use crate::screen::{Screen, is_amber, is_red};

/// Returns the positions of the grabbed particles in the left and the right pane (px).
fn hands(app: &App) -> Option<((i32, i32), (i32, i32))> {
    let hands = app.get("hands");
    let place = |hand: &str| {
        let (x, y) = hand.split_once(',')?;
        Some((x.parse().ok()?, y.parse().ok()?))
    };
    let (a, b) = hands.split_once(';')?;
    Some((place(a)?, place(b)?))
}

/// Colours both panes by their errors, and then as before.
#[test]
fn errors_in_colour() {
    let Some(display) = Display::open() else {
        return;
    };
    let words = "compare r:0.05 r:0.02 --scene simple";
    let app = display.open_app(words);
    // The button that films is red, too.
    let (left, top) = app.corner();
    let reds = || {
        let above_bar = top..top + 680;
        let screen = display.screen();
        screen.count_within(left..left + 1280, above_bar, is_red)
    };
    let red = until("two red balls", || Some(reds()).filter(|red| *red > 100));
    for colour in ["speed", "error"] {
        app.press_for("v", "colour", colour);
    }
    until("no red ball", || (reds() < red / 4).then_some(()));
    app.press_for("v", "colour", "-");
    until("red balls", || (reds() > red / 2).then_some(()));
}

/// Each method has its pane and its error; keys and pulls act on all.
#[test]
fn comparing() {
    let Some(display) = Display::open() else {
        return;
    };
    let words = "compare e:0.05 r:0.05 --scene simple";
    let app = display.open_app(words);
    assert_eq!(app.get("solvers"), "euler,rk4");
    let both = |key: &str| -> Option<(f64, f64)> {
        let values = app.get(key);
        let (a, b) = values.split_once(',')?;
        Some((a.parse().ok()?, b.parse().ok()?))
    };
    until("two errors", || {
        let (euler, rk4) = both("errors")?;
        (euler > 0.05 && rk4 < 1e-5).then_some(())
    });
    let (a, b) = both("times").unwrap();
    assert!((a - b).abs() < 0.051, "{a} {b}");

    // Plus acts on all panes, a digit on the pane under the pointer.
    app.press_for("plus", "step_sizes", "0.06,0.06");
    app.point(1000, 600);
    app.press_for("2", "solvers", "euler,trapezoid");
    app.point(200, 600);
    app.press_for("4", "solvers", "rk4,trapezoid");

    app.press("p");
    let picture = display.home.join("a3-simple-1.png");
    until("a picture", || picture.exists().then_some(()));
    let picture = image::open(&picture).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 720));

    // Sizes with other layouts of the panes.
    for [width, height] in [[260, 860], [90, 70], [1280, 720]] {
        app.resize([width, height]);
        app.expect("size", &format!("{width}x{height}"));
        app.expect_frames();
    }

    // Another scene is shown in both panes, and a pull in the right one acts on both.
    for scene in &SCENES[1..] {
        app.press_for("t", "scene", scene);
    }
    for _ in 0..12 {
        app.press("minus");
    }
    app.press_for("r", "lost", "false,false");
    app.wait("time", |time| time > 1.0);
    let (left, top) = app.corner();
    let halves = |screen: &Screen, is: fn([u8; 3]) -> bool| {
        let half = |k: i32| left + 642 * k..left + 642 * k + 638;
        [0, 1].map(|k| screen.count_within(half(k), top + 40..top + 720, is))
    };
    let screen = display.screen();
    assert!(
        halves(&screen, is_red).into_iter().all(|red| red > 3000),
        "{:?}",
        halves(&screen, is_red)
    );
    let (x, y) = (1280 * 3 / 4 + 40, 330);
    let go = |x: i32, y: i32| app.point(x, y);
    go(x, y);
    display.xdotool("mousedown 1");
    let hands = || hands(&app);
    let (_, near) = until("a hand in each pane", hands);
    assert!(near.0.abs_diff(x) < 40 && near.1.abs_diff(y) < 40, "{near:?}");
    go(x + 60, y - 40);
    until("both hands at the same place of their panes", || {
        let (a, b) = hands()?;
        let moved = b.0.abs_diff(near.0 + 60) < 4 && b.1.abs_diff(near.1 - 40) < 4;
        (moved && a.0.abs_diff(b.0 - 641) < 4 && a.1.abs_diff(b.1) < 4).then_some(())
    });
    // A fold of the cloth may hide a mark for a while.
    let mut elsewhere = [(-120, -60), (60, -40)].into_iter().cycle();
    until("a mark in each pane", || {
        let marked = halves(&display.screen(), is_amber);
        if marked.into_iter().all(|amber| amber > 5) {
            return Some(());
        }
        let (dx, dy) = elsewhere.next()?;
        go(x + dx, y + dy);
        None
    });
    display.xdotool("mouseup 1");
    app.expect("grabbed", "-");
    app.expect("lost", "false,false");

    // Both pictures come back after the loss of the device.
    app.press_for("F12", "devices", "2");
    app.expect_frames();
    assert!(halves(&display.screen(), is_red).into_iter().all(|red| red > 3000));
    app.quit();
}
