//! Films: the frames that were asked for, as others read them, and what is kept of those that end early.

#![allow(missing_docs, reason = "a test")]

mod common;

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::time::{Duration, Instant};

use common::{TEARING, a3, asked, command, complaint, gpu_is_missing, is_missing, text};
use image::codecs::gif::GifDecoder;
use image::{AnimationDecoder, Frame, RgbaImage};

const CLOTH: [&str; 9] = [
    "render", "v", "0.01", "--until", "0.5", "--size", "160x120", "--output", "film.gif",
];

/// The words of `CLOTH` with another file, and more of them.
fn with<'a>(name: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&CLOTH[..8], &[name], more].concat()
}

/// Whether it was made: not where nothing can be drawn.
fn made(folder: &Path, words: &[&str]) -> bool {
    let output = a3(folder, words);
    if gpu_is_missing(&output) {
        return false;
    }
    assert!(
        output.status.success(),
        "{words:?}: {}",
        text(&output.stderr)
    );
    true
}

fn frames(path: &Path) -> Vec<Frame> {
    let decoder = GifDecoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
    decoder.into_frames().collect_frames().unwrap()
}

fn picture(folder: &Path, name: &str) -> RgbaImage {
    image::open(folder.join(name)).unwrap().to_rgba8()
}

/// The largest and the mean difference of a channel.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (u8, f64) {
    assert_eq!(a.dimensions(), b.dimensions());
    let off: Vec<u8> = a
        .iter()
        .zip(b.iter())
        .map(|(a, b)| a.abs_diff(*b))
        .collect();
    let sum: f64 = off.iter().map(|off| f64::from(*off)).sum();
    (
        off.iter().copied().max().unwrap_or(0),
        sum / off.len() as f64,
    )
}

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
    // In steps that end at the frames, so that a picture of that time is of the same state.
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
fn numbered_pictures_are_those_of_their_times() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("film")).unwrap();
    let words = with("film/f-##.png", &["--fps", "10", "--from", "0.2"]);
    if !made(folder.path(), &words) {
        return;
    }
    let mut names: Vec<_> = fs::read_dir(folder.path().join("film"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["f-01.png", "f-02.png", "f-03.png", "f-04.png"]);
    for (name, time) in [
        ("film/f-01.png", "0.2"),
        ("film/f-03.png", "0.4"),
        ("film/f-04.png", "0.5"),
    ] {
        let words = [
            "render", "v", "0.01", "--until", time, "--size", "160x120", "--output", "x.png",
        ];
        assert!(made(folder.path(), &words));
        let off = difference(
            &picture(folder.path(), name),
            &picture(folder.path(), "x.png"),
        );
        assert_eq!(off, (0, 0.0), "{name}");
    }
}

#[test]
fn trails_and_highlighted_springs_are_filmed_too() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "render", "r", "0.05", "--scene", "simple", "--until", "6", "--size", "320x240",
    ];
    let words = |more: &[&'static str]| [&words[..], more].concat();
    if !made(folder.path(), &words(&["--output", "#.png", "--fps", "1"])) {
        return;
    }
    let teal = |name: &str| {
        let picture = picture(folder.path(), name);
        let teal = |p: &&image::Rgba<u8>| p.0[2].saturating_sub(p.0[0]) > 40;
        picture.pixels().filter(teal).count()
    };
    let counts = ["1.png", "4.png", "7.png"].map(teal);
    assert!(
        counts[0] == 0 && counts[1] > 20 && counts[2] > counts[1],
        "{counts:?}"
    );
    let plain = with("plain-#.png", &["--fps", "2"]);
    assert!(made(folder.path(), &plain));
    let marked = with("marked-#.png", &["--fps", "2", "--springs-of", "210"]);
    assert!(made(folder.path(), &marked));
    let (most, _) = difference(
        &picture(folder.path(), "plain-2.png"),
        &picture(folder.path(), "marked-2.png"),
    );
    assert!(most > 100);
}

/// There is no cloth between the pins and what they have let go.
#[test]
fn what_has_torn_is_not_drawn() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tearing.toml"), TEARING).unwrap();
    let words = [
        "render",
        "--scene",
        "tearing.toml",
        "--until",
        "0.8",
        "--size",
        "320x120",
        "--fps",
        "10",
        "--output",
        "f-#.png",
    ];
    if !made(folder.path(), &words) {
        return;
    }
    let last = [
        "render",
        "--scene",
        "tearing.toml",
        "--until",
        "0.8",
        "--size",
        "320x120",
    ];
    assert!(made(
        folder.path(),
        &[&last[..], &["--output", "last.png"]].concat()
    ));
    for name in ["f-1.png", "f-9.png", "last.png"] {
        let picture = picture(folder.path(), name);
        let is_red = |x: u32, y: u32| {
            let [r, g, b, _] = picture.get_pixel(x, y).0;
            r > 100 && g < 90 && b < 90
        };
        let red: Vec<_> = (0..320)
            .filter(|x| (0..120).any(|y| is_red(*x, y)))
            .collect();
        // The pins are 2.8 m apart, which are 83 px; the cloth that they let go is 1 m wide at most.
        assert!((15..35).contains(&red.len()), "{name}: {red:?}");
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

    // A GIF's pixels are there or not, and what has moved leaves nothing behind.
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

#[test]
fn an_mp4_is_what_it_should_be() {
    let folder = tempfile::tempdir().unwrap();
    if is_missing("ffmpeg")
        || is_missing("ffprobe")
        || !made(folder.path(), &with("film.mp4", &["--fps", "50"]))
    {
        return;
    }
    let says = asked(
        folder.path(),
        "ffprobe",
        &["-v", "error", "-count_frames", "-show_streams", "film.mp4"],
    );
    for line in [
        "codec_name=h264",
        "pix_fmt=yuv420p",
        "width=160",
        "height=120",
        "r_frame_rate=50/1",
        "nb_read_frames=26",
        "color_space=bt709",
    ] {
        assert!(says.lines().any(|said| said == line), "{line} in\n{says}");
    }
    // The last frame, decoded, is the picture of its time.
    asked(
        folder.path(),
        "ffmpeg",
        &[
            "-v",
            "error",
            "-i",
            "film.mp4",
            "-vf",
            "select=eq(n\\,25)",
            "-frames:v",
            "1",
            "last.png",
        ],
    );
    assert!(made(folder.path(), &with("x.png", &[])));
    let (_, mean) = difference(
        &picture(folder.path(), "last.png"),
        &picture(folder.path(), "x.png"),
    );
    assert!(mean < 2.0, "mean difference {mean}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn films_that_cannot_be_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let long = |name, more: &[&'static str]| {
        [
            &["render", "v", "0.01", "--until", "1e6", "--output", name],
            more,
        ]
        .concat()
    };
    for (words, says) in [
        (long("x.mov", &[]), ".png, .gif or .mp4"),
        (long("x.png", &["--fps", "25"]), "film-####.png"),
        (long("x.png", &["--from", "1"]), "film-####.png"),
        (long("x.gif", &["--fps", "0"]), "such as 30"),
        (long("x.gif", &["--fps", "nan"]), "such as 30"),
        (long("x.gif", &["--from", "-1"]), "such as 2.5"),
        (long("x.gif", &["--from", "2e6"]), "past --until"),
        (long("x.gif", &[]), "25000001 frames"),
        (long("x-##.png", &["--fps", "0.1"]), "6 digits"),
        (long("x-#-#.png", &["--fps", "0.1"]), "side by side"),
        (
            long("x.mp4", &["--fps", "0.1", "--size", "161x120"]),
            "162x120",
        ),
        (long("x.mp4", &["--fps", "0.1", "--transparent"]), ".gif"),
        (
            long("x.gif", &["--fps", "0.1", "--size", "70000x10"]),
            "65535",
        ),
    ] {
        let line = complaint(&a3(folder.path(), &words), 2);
        assert!(
            line.starts_with("error: ") && line.contains(says),
            "{words:?}: {line}"
        );
    }
    let nowhere = command(folder.path(), &long("x.mp4", &["--fps", "0.1"]))
        .env("PATH", "/nowhere")
        .output()
        .unwrap();
    let line = complaint(&nowhere, 1);
    assert!(
        line.contains("apt install ffmpeg") && line.contains(".gif"),
        "{line}"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A program that takes the place of ffmpeg.
#[cfg(unix)]
fn stand_in(folder: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("ffmpeg");
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

/// It may fail at once or when it has everything: its last line says why.
#[test]
#[cfg(unix)]
fn when_ffmpeg_fails_nothing_is_left_but_its_reason() {
    let (folder, programs) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for script in [
        "echo first >&2; echo no such codec >&2; exit 1",
        "cat >/dev/null; echo first >&2; echo no such codec >&2; exit 1",
    ] {
        stand_in(programs.path(), script);
        let path = format!("{}:/usr/bin:/bin", programs.path().display());
        let output = command(folder.path(), &with("film.mp4", &[]))
            .env("PATH", path)
            .output()
            .unwrap();
        if gpu_is_missing(&output) {
            return;
        }
        assert_eq!(complaint(&output, 1), "error: ffmpeg failed: no such codec");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn a_film_that_blows_up_keeps_what_was_before() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "render", "rk4", "0.04", "--scene", "mit", "--until", "8", "--size", "80x60",
    ];
    let words = |more: &[&'static str]| [&words[..], more].concat();
    let output = a3(folder.path(), &words(&["--output", "x.gif"]));
    if gpu_is_missing(&output) {
        return;
    }
    let line = complaint(&output, 1);
    let film = frames(&folder.path().join("x.gif"));
    assert!((2..200).contains(&film.len()), "{}", film.len());
    assert!(line.contains("blew up at step"), "{line}");
    let kept = format!("x.gif has the first {} of 201 frames", film.len());
    assert!(line.ends_with(&kept), "{line}");
    // One that does so before it begins leaves nothing.
    let line = complaint(
        &a3(folder.path(), &words(&["--output", "y.gif", "--from", "7"])),
        1,
    );
    assert!(line.ends_with("nothing was filmed"), "{line}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
#[cfg(unix)]
fn an_interrupted_film_keeps_what_was_before() {
    let folder = tempfile::tempdir().unwrap();
    let names = if is_missing("ffmpeg") {
        &["x.gif"][..]
    } else {
        &["x.gif", "x.mp4"]
    };
    for name in names {
        let words = [
            "render", "v", "0.01", "--until", "1000", "--size", "80x60", "--output", name,
        ];
        let mut child = command(folder.path(), &words);
        // As a terminal does it: a group, all of which is interrupted.
        std::os::unix::process::CommandExt::process_group(&mut child, 0);
        let child = child.spawn().unwrap();
        let begun = Instant::now();
        // Its first frames are in a file beside.
        let is_writing = || {
            let mut sizes = fs::read_dir(folder.path()).unwrap().flatten().map(|entry| {
                let beside = entry.file_name().to_string_lossy().starts_with(".a3-");
                if beside {
                    entry.metadata().map_or(0, |about| about.len())
                } else {
                    0
                }
            });
            sizes.any(|size| size > 0)
        };
        while !is_writing() && begun.elapsed() < Duration::from_secs(5) {
            std::thread::sleep(Duration::from_millis(50));
        }
        let interrupt = std::process::Command::new("kill")
            .args(["-INT", "--", &format!("-{}", child.id())])
            .status()
            .unwrap();
        assert!(interrupt.success());
        let output = child.wait_with_output().unwrap();
        if gpu_is_missing(&output) {
            return;
        }
        let line = complaint(&output, 130);
        assert!(
            line.starts_with(&format!("interrupted: {name} has the first")),
            "{line}"
        );
        if *name == "x.gif" {
            let film = frames(&folder.path().join("x.gif"));
            assert!(
                line.contains(&format!(" first {} of 25001", film.len())),
                "{line}"
            );
        } else {
            let words = ["-v", "error", "-count_frames", "-show_streams", "x.mp4"];
            let says = asked(folder.path(), "ffprobe", &words);
            let count: usize = line.split(' ').nth(5).unwrap().parse().unwrap();
            assert!(
                says.contains(&format!("nb_read_frames={count}\n")),
                "{line}\n{says}"
            );
        }
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), names.len());
}

/// The first interrupt waits for an ffmpeg that takes its time, the second does not.
#[test]
#[cfg(unix)]
fn a_second_interrupt_ends_at_once_and_leaves_nothing() {
    let (folder, programs) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    stand_in(programs.path(), "cat >/dev/null; sleep 5");
    let words = [
        "render", "v", "0.01", "--until", "1000", "--size", "80x60", "--output", "x.mp4",
    ];
    let path = format!("{}:/usr/bin:/bin", programs.path().display());
    let child = command(folder.path(), &words)
        .env("PATH", path)
        .spawn()
        .unwrap();
    let id = child.id().to_string();
    std::thread::sleep(Duration::from_secs(2));
    let begun = Instant::now();
    for _ in 0..2 {
        asked(folder.path(), "kill", &["-INT", &id]);
        std::thread::sleep(Duration::from_millis(500));
    }
    let output = child.wait_with_output().unwrap();
    if gpu_is_missing(&output) {
        return;
    }
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(begun.elapsed() < Duration::from_secs(4));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
