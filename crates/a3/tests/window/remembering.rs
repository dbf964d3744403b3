//! Settings that are saved between windows.

use std::fs;

use crate::display::Display;

#[test]
fn settings_come_back_unless_they_are_not_wanted() {
    let Some(display) = Display::open() else {
        return;
    };
    let own = display.home.join("own.toml");
    let chain =
        "[[chain]]\nparticles = 3\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 25\n";
    fs::write(&own, chain).unwrap();
    let app = display.open_app("t 0.01 --scene own.toml --dark");
    app.expect("dark", "true");
    app.press_for("Tab", "panel", "true");
    app.press_for("ctrl+plus", "scale", "1.15");
    app.press_for("ctrl+plus", "scale", "1.3");
    app.press_for("ctrl+minus", "scale", "1.15");
    // With Ctrl, plus and minus do not change the step.
    app.expect("step", "0.01");
    app.quit();
    let file = display.home.join("a3").join("settings.toml");
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains("own.toml"), "{text}");
    let app = display.open_app("--scene chain");
    app.expect("panel", "true");
    app.expect("scale", "1.15");
    // The dark theme of the command line was for that window.
    app.expect("dark", "false");
    // The fourth row from below, which Up reaches first, is for all.
    for _ in 0..4 {
        app.press("Up");
    }
    app.press_for("Return", "dark", "true");
    app.press_for("ctrl+0", "scale", "1");
    // The file of the earlier window is in the list.
    app.press_for("o", "list", "true");
    for letter in ["o", "w", "n"] {
        app.press(letter);
    }
    app.press_for("Return", "scene", "own");
    app.quit();
    for (words, dark) in [("--light", "false"), ("", "true")] {
        let app = display.open_app(words);
        app.expect("dark", dark);
        app.quit();
    }
    let app = display.open_app("--no-config");
    app.expect("panel", "false");
    app.expect("dark", "false");
    app.press_for("Tab", "panel", "true");
    app.press_for("Tab", "panel", "false");
    app.quit();
    // An invalid settings file is reported and not overwritten.
    fs::write(&file, "colour = 'red'\n").unwrap();
    let app = display.open_app("");
    app.expect("panel", "false");
    app.press_for("Tab", "panel", "true");
    app.quit();
    assert_eq!(fs::read_to_string(&file).unwrap(), "colour = 'red'\n");
}
