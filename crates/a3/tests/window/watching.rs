//! Reloading of changed scene files.

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use crate::display::Display;

/// A changed scene file is reloaded, also while the run is paused. A file with an error leaves the
/// scene unchanged until it is corrected.
#[test]
fn watching() {
    let Some(display) = Display::open() else {
        return;
    };
    let file = display.home.join("mine.toml");
    let save = |step: &str, pins: &str| {
        let cloth = "[[cloth]]\ngrid = [5, 5]\nwidth = 1\nmass = 0.1\nstiffness = [20, 10, 5]\n";
        let pin = format!("pin = [{{ at = [{pins}] }}]\n");
        fs::write(&file, format!("solver = 'r'\nstep = {step}\n{cloth}{pin}")).unwrap();
    };
    save("0.01", "'top'");
    let app = display.open_app("--scene mine.toml --watch");
    app.expect("pins", "5");
    app.expect_frames();
    save("0.005", "'top-left', 'top-right'");
    app.expect("pins", "2");
    app.expect("step", "0.005");
    fs::write(&file, "step = 0.002\n[[cloth]]\ngrid = [5,").unwrap();
    sleep(Duration::from_secs(1));
    app.expect_frames();
    assert_eq!((app.get("pins"), app.get("step")), ("2".into(), "0.005".into()));
    app.press_for("space", "paused", "true");
    save("0.002", "'bottom'");
    app.expect("pins", "5");
    app.expect("step", "0.002");
    app.quit();
}
