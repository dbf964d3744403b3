//! Films that are refused, blow up, or are interrupted.

use std::fs;
use std::process::Command;
use std::time::{Duration, Instant};

use super::frames;
use crate::common::{Folder, a3, asked, command, complaint, gpu_is_missing, is_missing};

#[test]
fn films_that_cannot_be_are_refused_before_the_work() {
    let folder = &Folder::new();
    let long = |more: &str| format!("render v 0.01 --until 1e6 --output {more}");
    for (words, says) in [
        ("x.mov", ".png, .gif or .mp4"),
        ("x.png --fps 25", "film-####.png"),
        ("x.png --from 1", "film-####.png"),
        ("x.gif --fps 0", "such as 30"),
        ("x.gif --fps nan", "such as 30"),
        ("x.gif --from -1", "such as 2.5"),
        ("x.gif --from 2e6", "later than --until"),
        ("x.gif", "25000001 frames"),
        ("x-##.png --fps 0.1", "6 digits"),
        ("x-#-#.png --fps 0.1", "side by side"),
        ("x.mp4 --fps 0.1 --size 161x120", "162x120"),
        ("x.mp4 --fps 0.1 --transparent", ".gif"),
        ("x.gif --fps 0.1 --size 70000x10", "65535"),
    ] {
        let line = complaint(&a3(folder, long(words)), 2);
        assert!(line.starts_with("error: ") && line.contains(says), "{words:?}: {line}");
    }
    let nowhere =
        command(folder, long("x.mp4 --fps 0.1")).env("PATH", "/nowhere").output().unwrap();
    let line = complaint(&nowhere, 1);
    assert!(line.contains("apt install ffmpeg") && line.contains(".gif"), "{line}");
    assert_eq!(folder.count(), 0);
}

#[test]
fn a_film_that_blows_up_keeps_what_was_before() {
    let folder = &Folder::new();
    let words = "render rk4 0.04 --scene mit --until 8 --size 80x60";
    let output = a3(folder, format!("{words} --output x.gif"));
    if gpu_is_missing(&output) {
        return;
    }
    let line = complaint(&output, 1);
    let film = frames(&folder.join("x.gif"));
    assert!((2..200).contains(&film.len()), "{}", film.len());
    assert!(line.contains("blew up at step"), "{line}");
    let kept = format!("x.gif has the first {} of 201 frames", film.len());
    assert!(line.contains(&kept), "{line}");
    // A run that blows up before the film begins leaves nothing.
    let later = format!("{words} --output y.gif --from 7");
    let line = complaint(&a3(folder, later), 1);
    assert!(line.contains("nothing was filmed; a step of "), "{line}");
    assert_eq!(folder.count(), 1);
}

#[test]
#[cfg(unix)]
fn an_interrupted_film_keeps_what_was_before() {
    let folder = &Folder::new();
    let names = if is_missing("ffmpeg") { &["x.gif"][..] } else { &["x.gif", "x.mp4"] };
    for name in names {
        let words = format!("render v 0.01 --until 1000 --size 80x60 --output {name}");
        let mut child = command(folder, words);
        // Like Ctrl-C in a terminal, which interrupts the whole process group.
        std::os::unix::process::CommandExt::process_group(&mut child, 0);
        let child = child.spawn().unwrap();
        let begun = Instant::now();
        // Its first frames are in a temporary file.
        let is_writing = || {
            let mut sizes = fs::read_dir(folder).unwrap().flatten().map(|entry| {
                let beside = entry.file_name().to_string_lossy().starts_with(".a3-");
                if beside { entry.metadata().map_or(0, |about| about.len()) } else { 0 }
            });
            sizes.any(|size| size > 0)
        };
        while !is_writing() && begun.elapsed() < Duration::from_secs(5) {
            std::thread::sleep(Duration::from_millis(50));
        }
        let interrupt = Command::new("kill")
            .args(["-INT", "--", &format!("-{}", child.id())])
            .status()
            .unwrap();
        assert!(interrupt.success());
        let output = child.wait_with_output().unwrap();
        if gpu_is_missing(&output) {
            return;
        }
        let line = complaint(&output, 130);
        assert!(line.starts_with(&format!("interrupted: {name} has the first")), "{line}");
        if *name == "x.gif" {
            let film = frames(&folder.join("x.gif"));
            assert!(line.contains(&format!(" first {} of 25001", film.len())), "{line}");
        } else {
            let words = "-v error -count_frames -show_streams x.mp4";
            let says = asked(folder, "ffprobe", words);
            let count: usize = line.split(' ').nth(5).unwrap().parse().unwrap();
            assert!(says.contains(&format!("nb_read_frames={count}\n")), "{line}\n{says}");
        }
    }
    assert_eq!(folder.count(), names.len());
}
