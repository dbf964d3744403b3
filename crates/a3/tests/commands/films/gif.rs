//! GIFs: their frames, their rates, and their transparency.

use super::{difference, frames, made, picture, with};
use crate::common::{Folder, a3, gpu_is_missing, text};
use image::RgbaImage;

#[test]
fn a_gif_shows_the_pictures_of_its_times() {
    let folder = &Folder::new();
    if !made(folder, with("film.gif")) {
        return;
    }
    let film = frames(&folder.join("film.gif"));
    assert_eq!(film.len(), 13, "0, 0.04, ... 0.48");
    for frame in &film {
        assert_eq!(frame.delay().numer_denom_ms(), (40, 1));
    }
    // With steps that end at the frames, a picture of that time shows the same state.
    for (k, time) in [(0, "0"), (5, "0.2"), (12, "0.48")] {
        let words = format!("render v 0.01 --until {time} --size 160x120 --output x.png");
        assert!(made(folder, words));
        let (_, mean) = difference(film[k].buffer(), &picture(folder, "x.png"));
        assert!(mean < 1.2, "frame {k}: mean difference {mean}");
    }
    let (_, mean) = difference(film[0].buffer(), film[12].buffer());
    assert!(mean > 4.0, "it moves: {mean}");
    let bytes = folder.bytes("film.gif");
    let forever = b"NETSCAPE2.0\x03\x01\x00\x00";
    assert!(bytes.windows(forever.len()).any(|bytes| bytes == forever));
    assert!(bytes.len() < 100_000, "{} bytes", bytes.len());
    // The same film again, to the byte.
    assert!(made(folder, with("again.gif")));
    assert!(folder.bytes("again.gif") == bytes);
    assert_eq!(folder.count(), 3);
}

#[test]
fn a_gif_says_what_rate_it_can_have() {
    let folder = &Folder::new();
    for (asked, has, delay) in [("30", "33.3333", 30), ("100", "50.0000", 20)] {
        let output = a3(folder, with(&format!("film.gif --fps {asked}")));
        if gpu_is_missing(&output) {
            return;
        }
        assert!(output.status.success());
        let stderr = text(&output.stderr);
        assert!(stderr.contains(has) && stderr.lines().count() == 1, "{stderr}");
        let film = frames(&folder.join("film.gif"));
        assert_eq!(film[0].delay().numer_denom_ms(), (delay, 1));
        assert_eq!(film.len() as u32, 500 / delay + 1, "as long as asked for");
    }
}

#[test]
fn transparent_films_have_nothing_behind_the_cloth() {
    let folder = &Folder::new();
    if !made(folder, with("x.png --transparent")) {
        return;
    }
    let bare = picture(folder, "x.png");
    let count =
        |picture: &RgbaImage, opacity: u8| picture.pixels().filter(|p| p.0[3] == opacity).count();
    let (clear, solid, all) = (count(&bare, 0), count(&bare, 255), 160 * 120);
    assert!(clear > all / 2 && solid > all / 20 && clear + solid < all, "{clear} {solid}");
    assert!(made(folder, with("#.png --transparent --fps 2")));
    assert_eq!(picture(folder, "2.png"), bare);

    // The pixels of a GIF are opaque or transparent, and a moved object leaves no pixels behind.
    assert!(made(folder, with("film.gif --transparent")));
    let film = frames(&folder.join("film.gif"));
    let words = "render v 0.01 --until 0.48 --size 160x120 --output y.png --transparent";
    assert!(made(folder, words));
    let (last, bare) = (film.last().unwrap().buffer(), picture(folder, "y.png"));
    for (p, q) in last.pixels().zip(bare.pixels()) {
        assert_eq!(p.0[3], if q.0[3] < 128 { 0 } else { 255 });
        assert!(p.0[3] == 0 || (0..3).all(|c| p.0[c].abs_diff(q.0[c]) < 24), "{p:?} {q:?}");
    }
}
