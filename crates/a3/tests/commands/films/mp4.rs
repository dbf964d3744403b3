//! MP4 films, which ffmpeg encodes.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use super::{difference, made, picture, with};
use crate::common::{Folder, asked, command, complaint, gpu_is_missing, is_missing, text};

#[test]
fn an_mp4_is_what_it_should_be() {
    let folder = &Folder::new();
    if is_missing("ffmpeg") || is_missing("ffprobe") || !made(folder, with("film.mp4 --fps 50")) {
        return;
    }
    let words = "-v error -count_frames -show_streams film.mp4";
    let says = asked(folder, "ffprobe", words);
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
    let words = "-v error -i film.mp4 -vf select=eq(n\\,25) -frames:v 1 last.png";
    asked(folder, "ffmpeg", words);
    assert!(made(folder, with("x.png")));
    let (_, mean) = difference(&picture(folder, "last.png"), &picture(folder, "x.png"));
    assert!(mean < 2.0, "mean difference {mean}");
    assert_eq!(folder.count(), 3);
}

/// Writes a script in the place of ffmpeg.
#[cfg(unix)]
fn stand_in(folder: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("ffmpeg");
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

/// ffmpeg may fail at once or after all frames: its first line says why, and the others name
/// consequences. It may also report success for an incomplete film.
#[test]
#[cfg(unix)]
fn when_ffmpeg_fails_nothing_is_left_but_its_reason() {
    let (folder, programs) = (&Folder::new(), &Folder::new());
    for (script, why) in [
        ("echo no such codec >&2; echo no film >&2; exit 1", "no such codec"),
        ("cat >/dev/null; echo no such codec >&2; echo no film >&2; exit 1", "no such codec"),
        ("cat >/dev/null; kill -9 $$", "signal: 9 (SIGKILL)"),
        (
            "cat >/dev/null; for file; do :; done; printf '\\0\\0\\0\\020ftyp' >\"${file#file:}\"",
            "the film is incomplete",
        ),
    ] {
        stand_in(programs, script);
        let path = format!("{}:/usr/bin:/bin", programs.display());
        let output = command(folder, with("film.mp4")).env("PATH", path).output().unwrap();
        if gpu_is_missing(&output) {
            return;
        }
        assert_eq!(
            complaint(&output, 1),
            format!("error: film.mp4: could not be written: ffmpeg failed: {why}")
        );
        assert_eq!(folder.count(), 0);
    }
}

/// The first interrupt waits for an ffmpeg that takes its time, the second does not.
#[test]
#[cfg(unix)]
fn a_second_interrupt_ends_at_once_and_leaves_nothing() {
    let (folder, programs) = (&Folder::new(), &Folder::new());
    stand_in(programs, "cat >/dev/null; sleep 5");
    let words = "render v 0.01 --until 1000 --size 80x60 --output x.mp4";
    let path = format!("{}:/usr/bin:/bin", programs.display());
    let child = command(folder, words).env("PATH", path).spawn().unwrap();
    let id = child.id().to_string();
    std::thread::sleep(Duration::from_secs(2));
    let begun = Instant::now();
    for _ in 0..2 {
        asked(folder, "kill", ["-INT", &id]);
        std::thread::sleep(Duration::from_millis(500));
    }
    let output = child.wait_with_output().unwrap();
    if gpu_is_missing(&output) {
        return;
    }
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(begun.elapsed() < Duration::from_secs(4));
    assert_eq!(folder.count(), 0);
}
