//! Keys: the effect of each while a run advances, is paused, or has blown up.

use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::app::App;
use crate::display::{Display, until};
use crate::screen::is_red;

/// The scenes in the order of key t, after the cloth.
pub const SCENES: [&str; 16] = [
    "simple",
    "pendulum",
    "chain",
    "mit",
    "mit-sphere",
    "double-pendulum",
    "flag",
    "jelly",
    "t-handle",
    "boxes",
    "dominoes",
    "ball-on-cloth",
    "drop",
    "dam-break",
    "cantilever",
    "cloth",
];

#[test]
fn keys() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    for (key, value) in
        [("scene", "cloth"), ("solver", "trapezoid"), ("step", "0.01"), ("size", "1280x720")]
    {
        assert_eq!(app.get(key), value);
    }

    // Simulated time keeps up with real time, in steps of exactly the chosen size.
    let (time, begun) = (app.number("time").unwrap(), Instant::now());
    sleep(Duration::from_secs(2));
    let factor = (app.number("time").unwrap() - time) / begun.elapsed().as_secs_f64();
    assert!((0.5..1.25).contains(&factor), "{factor} times real time");
    let (time, steps) = (app.number("time").unwrap(), app.number("steps").unwrap());
    assert!((time - 0.01 * steps).abs() < 1e-3, "{time} s after {steps} steps");

    app.press_for("s", "swing", "true");
    app.press_for("d", "wind", "true");
    app.press_for("s", "swing", "false");
    app.press_for("d", "wind", "false");

    for colour in ["speed", "strain", "force", "contact", "-"] {
        app.press_for("v", "colour", colour);
    }
    for arrows in ["velocity", "force", "-"] {
        app.press_for("a", "arrows", arrows);
    }

    app.press_for("plus", "step", "0.012");
    app.press_for("minus", "step", "0.01");
    app.press_for("4", "solver", "rk4");
    app.press_for("6", "solver", "verlet");
    app.press_for("2", "solver", "trapezoid");

    app.press("p");
    let picture = display.home.join("a3-cloth-1.png");
    until("a picture", || picture.exists().then_some(()));
    let picture = image::open(&picture).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 720));

    for scene in SCENES {
        app.press_for("t", "scene", scene);
    }
    app.wait("time", |time| time > 1.0);
    app.press("r");
    app.wait("time", |time| time < 0.9);
    app.quit();
}

/// Esc closes the help, then asks; Esc or another key stays. Ctrl and a letter is no letter.
fn escape_closes_and_asks(app: &App) {
    app.press_for("h", "help", "true");
    app.press_for("Escape", "help", "false");
    assert_eq!(app.get("asks"), "false");
    app.press_for("Escape", "asks", "true");
    app.press_for("Escape", "asks", "false");
    app.press_for("Escape", "asks", "true");
    app.press_for("w", "style", "Wireframe");
    app.expect("asks", "false");
    for key in ["ctrl+w", "ctrl+t", "ctrl+v", "alt+w"] {
        app.press(key);
    }
    app.press_for("d", "wind", "true");
    for (key, value) in [("style", "Wireframe"), ("scene", "cloth"), ("colour", "-")] {
        assert_eq!(app.get(key), value);
    }
    app.press_for("d", "wind", "false");
    for _ in 0..2 {
        app.press("w");
    }
    app.expect("style", "Shaded");
}

#[test]
fn pausing_the_camera_and_help() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");

    // A paused run stands still, takes no computing time, and takes single steps.
    app.press_for("space", "paused", "true");
    let shaded = app.still_screen();
    let (steps, ticks) = (app.number("steps").unwrap(), app.processor_ticks());
    sleep(Duration::from_secs(2));
    assert!(
        app.processor_ticks() - ticks <= 4,
        "paused, it takes {} ticks",
        app.processor_ticks() - ticks
    );
    assert_eq!(app.number("steps").unwrap(), steps);
    app.press("period");
    app.wait("steps", |found| found == steps + 1.0);

    // The surface is red, the wires are not; the button that films is, a little.
    assert!(shaded.count(is_red) > 20_000, "{} red pixels", shaded.count(is_red));
    app.press_for("w", "style", "Wireframe");
    let wires = app.still_screen();
    assert!(wires.count(is_red) < 400, "{} red pixels", wires.count(is_red));
    assert!(wires.difference(&shaded) > 2.0);
    // The springs have three colours.
    app.press_for("w", "style", "Springs");
    let springs = app.still_screen();
    assert!(springs.difference(&wires) > 1.0);
    let amber = |[r, g, b]: [u8; 3]| r > 180 && g > 100 && r - 30 > g && g - 30 > b;
    let violet = |[r, g, b]: [u8; 3]| b > 120 && r > 60 && b - 20 > r && r - 20 > g;
    for (name, count) in [("amber", springs.count(amber)), ("violet", springs.count(violet))] {
        assert!(count > 1000, "{count} {name} pixels");
    }
    app.press_for("w", "style", "Shaded");

    // Closing the help restores the picture.
    let before = app.still_screen();
    app.press_for("h", "help", "true");
    until("the help", || (display.screen().difference(&before) > 1.0).then_some(()));
    app.press_for("question", "help", "false");
    until("no help", || (display.screen().difference(&before) < 0.1).then_some(()));

    escape_closes_and_asks(&app);

    // Wheel and drag move the camera, and c resets it.
    app.point_and(1150, 600, "click 4 click 4");
    display.xdotool("mousedown 1 mousemove_relative -- -200 20 mouseup 1");
    until("another view", || (display.screen().difference(&before) > 1.0).then_some(()));
    app.press("c");
    until("the first view", || (display.screen().difference(&before) < 0.1).then_some(()));

    app.press_for("space", "paused", "false");
    app.wait("steps", |found| found > steps + 5.0);
    app.quit();
}

/// When a run blows up, the window says so and stands still, and key r starts the run again.
#[test]
fn blowing_up() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("e 0.05 --scene mit");
    app.expect("blown", "true");
    let steps = app.number("steps").unwrap();
    sleep(Duration::from_millis(500));
    assert_eq!(app.number("steps").unwrap(), steps);
    // The text is red, on the second sheet, where nothing else can be red.
    let (left, top) = app.corner();
    let screen = app.still_screen();
    let told = screen.count_within(left + 12..left + 320, top + 200..top + 300, |[r, g, b]| {
        r > 150 && g < 90 && b < 90
    });
    assert!(told > 100, "it says so in red: {told} pixels");
    for _ in 0..40 {
        app.press("minus");
    }
    app.wait("step", |step| step < 0.0003);
    app.press_for("r", "blown", "false");
    app.expect_frames();
    app.quit();
}
