//! MP4 films with H.264. An installed `ffmpeg` encodes the frames that are sent to it.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::Film;
use crate::failure::Failure;
use crate::output::Draft;

/// An MP4 in the making, which `ffmpeg` writes to a temporary file beside the target.
pub struct Mp4 {
    /// The target, until the film is complete.
    draft: Option<Draft>,
    ffmpeg: Child,
    /// The messages of `ffmpeg`.
    log: File,
}

impl Mp4 {
    /// A film of this size (px), with so many frames a second.
    pub fn new(path: &Path, (width, height): (u32, u32), fps: f64) -> Result<Self, Failure> {
        if width % 2 + height % 2 > 0 {
            let even = [width, height].map(|side| side + side % 2);
            return Err(Failure::usage(format!(
                "the sides of an MP4 must be even, such as {}x{}, not {width}x{height}",
                even[0], even[1]
            )));
        }
        let draft = Draft::new(path)?;
        let Some(beside) = draft.beside() else {
            return Err(Failure::run(format!(
                "{}: an MP4 can only be written to an ordinary file",
                path.display()
            )));
        };
        // The protocol is named, because a file name may begin with - or contain a colon.
        let target = [OsString::from("file:"), beside.into()]
            .into_iter()
            .collect::<OsString>();
        let log = tempfile::tempfile().map_err(Failure::run)?;
        let mut command = Command::new("ffmpeg");
        command
            .args(["-hide_banner", "-loglevel", "error", "-y"])
            .args(["-f", "rawvideo", "-pixel_format", "rgba"])
            .args(["-video_size", &format!("{width}x{height}")])
            .args(["-framerate", &fps.to_string(), "-i", "-"])
            // The colour space is that of high definition, and is named, so that players need not
            // guess.
            .args(["-vf", "scale=out_color_matrix=bt709:out_range=tv"])
            .args([
                "-colorspace",
                "bt709",
                "-color_primaries",
                "bt709",
                "-color_trc",
                "bt709",
            ])
            .args(["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"])
            .args(["-movflags", "+faststart", "-f", "mp4"])
            .arg(target)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(log.try_clone().map_err(Failure::run)?);
        // In a process group of its own, ffmpeg is not interrupted by Ctrl-C. It ends when there
        // are no more frames.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let ffmpeg = command.spawn().map_err(|e| match e.kind() {
            io::ErrorKind::NotFound => Failure::run(
                "an MP4 is written by ffmpeg, which is not here: install it (apt install ffmpeg), or write a .gif or a \
                 sequence such as film-####.png",
            ),
            _ => Failure::run(format!("ffmpeg could not be started: {e}")),
        })?;
        Ok(Self {
            draft: Some(draft),
            ffmpeg,
            log,
        })
    }

    /// The failure with the last message of `ffmpeg`, which must have ended.
    fn complaint(&mut self) -> Failure {
        let mut said = String::new();
        let read = self
            .log
            .rewind()
            .and_then(|()| self.log.read_to_string(&mut said));
        let last = said.lines().rev().find(|line| !line.trim().is_empty());
        let why = last.filter(|_| read.is_ok()).unwrap_or("it gave no reason");
        Failure::run(format!("ffmpeg failed: {}", why.trim()))
    }
}

impl Film for Mp4 {
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure> {
        let sent = self
            .ffmpeg
            .stdin
            .as_mut()
            .map_or(Ok(()), |pipe| pipe.write_all(pixels));
        sent.map_err(|_| {
            // ffmpeg has closed its end of the pipe.
            let _ = self.ffmpeg.wait();
            self.complaint()
        })
    }

    fn finish(mut self: Box<Self>) -> Result<(), Failure> {
        drop(self.ffmpeg.stdin.take());
        let status = self.ffmpeg.wait().map_err(Failure::run)?;
        match self.draft.take() {
            Some(draft) if status.success() => draft.place(),
            _ => Err(self.complaint()),
        }
    }
}

impl Drop for Mp4 {
    fn drop(&mut self) {
        // This ends ffmpeg if the film was given up, and does nothing if ffmpeg has ended.
        let _ = self.ffmpeg.kill();
        let _ = self.ffmpeg.wait();
    }
}
