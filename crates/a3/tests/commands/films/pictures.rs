//! Numbered pictures, and their contents.

use std::fs;

use super::{difference, made, picture, with};
use crate::common::{Folder, TEARING};

#[test]
fn numbered_pictures_are_those_of_their_times() {
    let folder = &Folder::new();
    fs::create_dir(folder.join("film")).unwrap();
    let words = with("film/f-##.png --fps 10 --from 0.2");
    if !made(folder, &words) {
        return;
    }
    let mut names: Vec<_> = fs::read_dir(folder.join("film"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["f-01.png", "f-02.png", "f-03.png", "f-04.png"]);
    for (name, time) in
        [("film/f-01.png", "0.2"), ("film/f-03.png", "0.4"), ("film/f-04.png", "0.5")]
    {
        let words = format!("render v 0.01 --until {time} --size 160x120 --output x.png");
        assert!(made(folder, words));
        let off = difference(&picture(folder, name), &picture(folder, "x.png"));
        assert_eq!(off, (0, 0.0), "{name}");
    }
}

#[test]
fn trails_and_highlighted_springs_are_filmed_too() {
    let folder = &Folder::new();
    let words = "render r 0.05 --scene simple --until 6 --size 320x240";
    if !made(folder, format!("{words} --output #.png --fps 1")) {
        return;
    }
    let teal = |name: &str| {
        let picture = picture(folder, name);
        let teal = |p: &&image::Rgba<u8>| p.0[2].saturating_sub(p.0[0]) > 40;
        picture.pixels().filter(teal).count()
    };
    let counts = ["1.png", "4.png", "7.png"].map(teal);
    assert!(counts[0] == 0 && counts[1] > 20 && counts[2] > counts[1], "{counts:?}");
    let plain = with("plain-#.png --fps 2");
    assert!(made(folder, &plain));
    let marked = with("marked-#.png --fps 2 --springs-of 210");
    assert!(made(folder, &marked));
    let (most, _) = difference(&picture(folder, "plain-2.png"), &picture(folder, "marked-2.png"));
    assert!(most > 100);
}

/// No cloth is drawn across a tear.
#[test]
fn what_has_torn_is_not_drawn() {
    let folder = &Folder::new();
    folder.write("tearing.toml", TEARING);
    let words = "render --scene tearing.toml --until 0.8 --size 320x120 --fps 10 --output f-#.png";
    if !made(folder, words) {
        return;
    }
    let last = "render --scene tearing.toml --until 0.8 --size 320x120 --output last.png";
    assert!(made(folder, last));
    for name in ["f-1.png", "f-9.png", "last.png"] {
        let picture = picture(folder, name);
        let is_red = |x: u32, y: u32| {
            let [r, g, b, _] = picture.get_pixel(x, y).0;
            r > 100 && g < 90 && b < 90
        };
        let red: Vec<_> = (0..320).filter(|x| (0..120).any(|y| is_red(*x, y))).collect();
        // The pins are 2.8 m apart, which are 83 px; the torn-off cloth is 1 m wide at most.
        assert!((15..35).contains(&red.len()), "{name}: {red:?}");
    }
}
