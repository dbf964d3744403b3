//! Films of the window: of the last seconds, live, and completed when the window closes.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use image::AnimationDecoder;
use image::codecs::gif::GifDecoder;

use crate::display::{Display, until};

/// Returns the frames of a GIF.
fn frames(path: &Path) -> Vec<image::Frame> {
    let file = BufReader::new(File::open(path).unwrap());
    let frames = GifDecoder::new(file).unwrap().into_frames();
    frames.collect_frames().unwrap()
}

/// Checks that a film has at least `least` frames of 50 ms, of which fewer than a third equal the
/// previous one.
fn check(path: &Path, least: usize) {
    until("a film", || path.exists().then_some(()));
    let frames = frames(path);
    assert!(frames.len() >= least, "{} frames", frames.len());
    let mut same = 0;
    for pair in frames.windows(2) {
        assert_eq!(pair[0].delay().numer_denom_ms(), (50, 1));
        same += usize::from(pair[0].buffer() == pair[1].buffer());
    }
    assert!(3 * same < frames.len(), "{same} of {} equal the previous one", frames.len());
}

#[test]
fn filming() {
    let Some(display) = Display::open() else {
        return;
    };
    let words = "v 0.005 --scene chain";
    let app = display.open_app(words);
    let later = |by: f64| {
        let time = app.number("time").unwrap();
        app.wait("time", |t| t > time + by);
    };
    let file = |name: &str| display.home.join(name);
    later(1.5);
    // The last seconds, while the run continues.
    app.press_for("n", "film", "true");
    later(0.1);
    app.expect("film", "false");
    check(&file("a3-chain-1.gif"), 25);
    // A live film, until the key is pressed again.
    app.press_for("m", "film", "true");
    later(1.0);
    assert_eq!(app.get("film"), "true");
    app.press_for("m", "film", "false");
    check(&file("a3-chain-2.gif"), 18);
    // Numbered pictures: the second last row of the panel.
    app.press_for("Tab", "panel", "true");
    for key in ["Up", "Up", "Left"] {
        app.press(key);
    }
    app.press_for("Tab", "panel", "false");
    app.press_for("m", "film", "true");
    later(0.5);
    // Another scene ends a live film.
    app.press_for("t", "film", "false");
    let pictures = (1..).take_while(|k| file(&format!("a3-chain-1-{k:04}.png")).exists());
    assert!(pictures.count() >= 12);
    // Closing the window completes the film.
    app.press_for("Prior", "scene", "chain");
    later(1.0);
    app.press_for("n", "film", "true");
    app.quit();
    let pictures = (1..).take_while(|k| file(&format!("a3-chain-2-{k:04}.png")).exists());
    assert!(pictures.count() >= 25);
}
