//! Plots of what is picked, and their files.

use crate::display::{Display, until};
use crate::screen::is_red;

/// The first particle of the palette is drawn in this blue.
fn is_blue(pixel: [u8; 3]) -> bool {
    let near = |(a, b): (u8, u8)| a.abs_diff(b) <= 3;
    pixel.into_iter().zip([0x00, 0x72, 0xb2]).all(near)
}

/// The particle of the pendulum is plotted at once; the modes change by keys, and files are
/// written.
#[test]
fn plotting() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("r 0.005 --scene pendulum");
    app.press_for("F3", "plots", "1");
    app.wait("time", |time| time > 2.0);
    app.press_for("space", "paused", "true");
    let curve = app.still_screen().count(is_blue);
    assert!(curve > 300, "{curve} pixels of curves");
    app.press("u");
    let table = display.home.join("a3-pendulum-1.csv");
    let picture = display.home.join("a3-pendulum-1.png");
    until("files of the plots", || picture.exists().then_some(()));
    let table = std::fs::read_to_string(table).unwrap();
    let heading = "scene,solver,step or tolerance,of,time (s),x (m),y (m)";
    assert_eq!(table.lines().next(), Some(heading));
    let row: Vec<_> = table.lines().nth(100).unwrap().split(',').collect();
    assert_eq!(row[..4], ["pendulum", "rk4", "0.005", "particle 1"]);
    let bytes = std::fs::read(picture).unwrap();
    assert!(bytes.starts_with(b"\x89PNG"));
    // A double click on the particle ends its plot; another one begins it again.
    let (x, y) = app.still_screen().block(60..800, 300..800, 6, is_red).unwrap();
    for plots in ["0", "1"] {
        display.xdotool(format!("mousemove {x} {y} click --repeat 2 --delay 60 1"));
        app.expect("plots", plots);
        // The next press is no third click.
        std::thread::sleep(std::time::Duration::from_millis(500));
    }
    app.expect("springs_of", "1");
    app.press_for("F3", "plots", "-");
    app.press_for("F3", "plots", "1");
    app.press_for("Escape", "plots", "-");
    app.quit();
}
