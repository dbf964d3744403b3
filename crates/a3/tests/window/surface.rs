//! The window's size, minimising, a lost device, and closing.

use std::thread::sleep;
use std::time::Duration;

use crate::display::Display;
use crate::screen::is_red;

#[test]
fn sizes_minimising_a_lost_device_and_closing() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("r 0.01 --wind");
    for [width, height] in [[90, 70], [4000, 3000], [333, 777], [1280, 720]] {
        app.resize([width, height]);
        app.expect("size", &format!("{width}x{height}"));
        app.expect_frames();
    }
    // Many sizes in quick succession.
    for k in 0..40 {
        app.resize([300 + 17 * k, 700 - 11 * k]);
    }
    app.resize([1280, 720]);
    app.expect("size", "1280x720");

    display.xdotool(["windowminimize", &app.window]);
    app.expect("visible", "false");
    let (time, frames) = (app.number("time").unwrap(), app.number("frames").unwrap());
    sleep(Duration::from_secs(2));
    assert!(app.number("frames").unwrap() <= frames + 1.0, "drawn while minimised");
    display.xdotool(["windowmap", &app.window, "windowactivate", &app.window]);
    app.expect("visible", "true");
    app.expect_frames();
    assert!(app.number("time").unwrap() < time + 1.5, "time ran on while minimised");

    // After the loss of the device, the picture comes back, and the run continues.
    for lost in 1..=3 {
        let steps = app.number("steps").unwrap();
        app.press_for("F12", "devices", &(1 + lost).to_string());
        app.expect_frames();
        assert!(app.number("steps").unwrap() > steps);
    }
    assert!(display.screen().count(is_red) > 10_000);

    display.command("wmctrl").args(["-i", "-c", &app.window]).status().unwrap();
    assert!(app.exit().success());
}

/// Nothing is wrong where no session has named a folder for sockets, and nothing is said of it.
#[test]
fn a_picture_is_drawn_without_a_word_on_sockets() {
    let Some(display) = Display::open() else {
        return;
    };
    let output = display
        .command(env!("CARGO_BIN_EXE_a3"))
        .args(["render", "--until", "0.1", "--output", "x.png"])
        .current_dir(&display.home)
        .env_remove("XDG_RUNTIME_DIR")
        .stderr(std::process::Stdio::piped())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.is_empty() && output.status.success(), "{said}");
    assert!(display.home.join("x.png").exists());
}
