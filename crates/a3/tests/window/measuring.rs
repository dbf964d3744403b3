//! Measuring the scene in its window, and running what was measured beside the present run.

use crate::display::{Display, until};

/// Whether a pixel has the colour of the classical Runge-Kutta method on charts.
fn is_rk4(pixel: [u8; 3]) -> bool {
    let near = |(a, b): (u8, u8)| a.abs_diff(b) <= 3;
    pixel.into_iter().zip([0x88, 0x22, 0x55]).all(near)
}

/// A chart of the scene is measured while the run goes on; a click on a point of it adds a pane
/// with that solver. Buttons on the panes close one, and choose a solver for another.
#[test]
fn charting() {
    let Some(display) = Display::open() else {
        return;
    };
    let app = display.open_app("t 0.01 --scene simple");
    app.press_for("q", "measure", "true");
    assert_eq!(app.get("known"), "false");
    app.press_for("Return", "known", "true");
    app.press_for("space", "paused", "true");
    let click = |x: i32, y: i32| {
        let (x, y) = (x.to_string(), y.to_string());
        app.point(x, y);
        app.still_screen();
        display.xdotool("click 1");
    };
    // The first point of the curve from above is on the right half of the screen, below the legend.
    let found = app.still_screen().block(800..1380, 350..880, 4, is_rk4);
    let (x, y) = found.expect("a point of the curve");
    display.xdotool(format!("mousemove {x} {y}"));
    app.still_screen();
    display.xdotool("click 1");
    app.expect("panes", "2");
    assert_eq!(app.get("solvers"), "trapezoid,rk4");
    assert_ne!(app.get("step_sizes"), "0.01,0.01");
    app.press_for("space", "paused", "false");
    until("two errors", || {
        let errors = app.get("errors");
        let (heun, rk4) = errors.split_once(',')?;
        (heun.parse::<f64>().is_ok() && rk4.parse::<f64>().is_ok()).then_some(())
    });
    app.press_for("space", "paused", "true");
    // The cross of the second pane, and the plus of the only one.
    click(670, 54);
    app.expect("panes", "1");
    assert_eq!(app.get("solvers"), "trapezoid");
    click(670, 21);
    app.expect("list", "true");
    display.xdotool("type midp");
    app.press_for("Return", "panes", "2");
    assert_eq!(app.get("solvers"), "trapezoid,midpoint");
    app.press_for("Escape", "measure", "false");
    app.quit();
}
