//! Choosing scenes and solvers in lists, by typing and by the mouse; and copying the command line.

use std::fs;
use std::process::Stdio;

use crate::display::{Display, until};

#[test]
fn lists() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01");
    // In a list, letters are typed: otherwise t would show the next scene, and Esc would quit.
    app.press_for("o", "list", "true");
    for letter in ["d", "o", "u", "b", "t"] {
        app.press(letter);
    }
    app.press("BackSpace");
    app.press_for("Return", "list", "false");
    app.expect("scene", "double-pendulum");
    app.press_for("Prior", "scene", "mit-sphere");
    app.press_for("Next", "scene", "double-pendulum");
    app.press_for("o", "list", "true");
    app.press_for("Escape", "list", "false");
    // By arrows: choose the solver below the present one.
    app.press_for("e", "list", "true");
    app.press("Down");
    app.press_for("Return", "solver", "midpoint");
    // By the mouse: click an entry, then outside the list.
    app.press_for("space", "paused", "true");
    app.press_for("o", "list", "true");
    app.still_screen();
    app.point(450, 400);
    display.xdotool("click 1");
    app.expect("list", "false");
    assert_ne!(app.get("scene"), "double-pendulum");
    app.press_for("o", "list", "true");
    app.point(1200, 650);
    display.xdotool("click 1");
    app.expect("list", "false");
    app.quit();
}

#[test]
fn copying_the_command_line() {
    let Some(display) = Display::open() else {
        return;
    };
    let words = "v 0.005 --scene chain --paused";
    // The clipboard is lost when the program ends.
    let app = display.open_app(words);
    app.press("y");
    until("a line on the terminal", || {
        let text = app.said();
        text.contains("a3 verlet 0.005 --scene chain --paused").then_some(())
    });
    // A run that has advanced starts again; one whose pins were released is in a file.
    app.press_for("v", "colour", "speed");
    app.press("period");
    app.press("y");
    until("another line", || {
        let text = app.said();
        text.contains("a3 verlet 0.005 --scene chain --colour speed --paused").then_some(())
    });
    let file = display.home.join("a3-chain-1.toml");
    assert!(!file.exists());
    app.press_for("Delete", "pins", "0");
    app.press("y");
    let file = display.home.join("a3-chain-1.toml");
    until("a scene file", || file.exists().then_some(()));
    until("a line that names it", || {
        let text = app.said();
        text.contains("a3 verlet 0.005 --scene a3-chain-1.toml --colour speed --paused")
            .then_some(())
    });
    let mut xclip = display.command("xclip");
    let board = xclip.args(["-o", "-selection", "clipboard"]);
    let board = board.stdout(Stdio::piped()).output().unwrap().stdout;
    assert!(app.said().ends_with(&String::from_utf8(board).unwrap()));
    assert!(fs::read_to_string(&file).unwrap().contains("[state]"));
    app.quit();
}
