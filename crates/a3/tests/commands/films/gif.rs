//! GIFs: their frames, their rates, and their transparency.

use std::fs;

use super::{CLOTH, difference, frames, made, picture, with};
use crate::common::{a3, gpu_is_missing, text};
use image::RgbaImage;

#[test]
fn a_gif_shows_the_pictures_of_its_times() {
    let folder = tempfile::tempdir().unwrap();
    if !made(folder.path(), &CLOTH) {
        return;
    }
    let film = frames(&folder.path().join("film.gif"));
    assert_eq!(film.len(), 13, "0, 0.04, ... 0.48");
    for frame in &film {
        assert_eq!(frame.delay().numer_denom_ms(), (40, 1));
    }
    // With steps that end at the frames, a picture of that time shows the same state.
    for (k, time) in [(0, "0"), (5, "0.2"), (12, "0.48")] {
        let words = [
            "render", "v", "0.01", "--until", time, "--size", "160x120", "--output", "x.png",
        ];
        assert!(made(folder.path(), &words));
        let (_, mean) = difference(film[k].buffer(), &picture(folder.path(), "x.png"));
        assert!(mean < 1.2, "frame {k}: mean difference {mean}");
    }
    let (_, mean) = difference(film[0].buffer(), film[12].buffer());
    assert!(mean > 4.0, "it moves: {mean}");
    let bytes = fs::read(folder.path().join("film.gif")).unwrap();
    let forever = b"NETSCAPE2.0\x03\x01\x00\x00";
    assert!(bytes.windows(forever.len()).any(|bytes| bytes == forever));
    assert!(bytes.len() < 100_000, "{} bytes", bytes.len());
    // The same film again, to the byte.
    assert!(made(folder.path(), &with("again.gif", &[])));
    assert!(fs::read(folder.path().join("again.gif")).unwrap() == bytes);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn a_gif_says_what_rate_it_can_have() {
    let folder = tempfile::tempdir().unwrap();
    for (asked, has, delay) in [("30", "33.3333", 30), ("100", "50.0000", 20)] {
        let output = a3(folder.path(), &with("film.gif", &["--fps", asked]));
        if gpu_is_missing(&output) {
            return;
        }
        assert!(output.status.success());
        let stderr = text(&output.stderr);
        assert!(
            stderr.contains(has) && stderr.lines().count() == 1,
            "{stderr}"
        );
        let film = frames(&folder.path().join("film.gif"));
        assert_eq!(film[0].delay().numer_denom_ms(), (delay, 1));
        assert_eq!(film.len() as u32, 500 / delay + 1, "as long as asked for");
    }
}

#[test]
fn transparent_films_have_nothing_behind_the_cloth() {
    let folder = tempfile::tempdir().unwrap();
    if !made(folder.path(), &with("x.png", &["--transparent"])) {
        return;
    }
    let bare = picture(folder.path(), "x.png");
    let count =
        |picture: &RgbaImage, opacity: u8| picture.pixels().filter(|p| p.0[3] == opacity).count();
    let (clear, solid, all) = (count(&bare, 0), count(&bare, 255), 160 * 120);
    assert!(
        clear > all / 2 && solid > all / 20 && clear + solid < all,
        "{clear} {solid}"
    );
    assert!(made(
        folder.path(),
        &with("#.png", &["--transparent", "--fps", "2"])
    ));
    assert_eq!(picture(folder.path(), "2.png"), bare);

    // The pixels of a GIF are opaque or transparent, and a moved object leaves no pixels behind.
    assert!(made(folder.path(), &with("film.gif", &["--transparent"])));
    let film = frames(&folder.path().join("film.gif"));
    let words = [
        "render",
        "v",
        "0.01",
        "--until",
        "0.48",
        "--size",
        "160x120",
        "--output",
        "y.png",
        "--transparent",
    ];
    assert!(made(folder.path(), &words));
    let (last, bare) = (
        film.last().unwrap().buffer(),
        picture(folder.path(), "y.png"),
    );
    for (p, q) in last.pixels().zip(bare.pixels()) {
        assert_eq!(p.0[3], if q.0[3] < 128 { 0 } else { 255 });
        assert!(
            p.0[3] == 0 || (0..3).all(|c| p.0[c].abs_diff(q.0[c]) < 24),
            "{p:?} {q:?}"
        );
    }
}
