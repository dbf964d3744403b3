//! MP4 films with H.264. An installed `ffmpeg` encodes the frames that are sent to it.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use a3_files::failure::Failure;
use a3_files::interrupt::{self, Cleanup, Temporary};
use a3_files::output::{Draft, not_written};
use a3_files::terminal;

use super::shoot::Film;

/// An MP4 that is being written: `ffmpeg` writes to a temporary file beside the target.
pub struct Mp4 {
    /// The draft of the target, until the film is complete.
    draft: Option<Draft>,
    ffmpeg: Child,
    /// Kills `ffmpeg` if the program ends at once.
    running: Option<Temporary>,
    /// The messages of `ffmpeg`.
    log: File,
}

impl Mp4 {
    /// Creates a film of this size (px) at a rate of `fps` (frames per second).
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
        let target = [OsString::from("file:"), beside.into()].into_iter().collect::<OsString>();
        let log = tempfile::tempfile().map_err(Failure::run)?;
        let mut command = Command::new("ffmpeg");
        command
            .args("-hide_banner -loglevel error -y -f rawvideo -pixel_format rgba".split(' '))
            .args(["-video_size", &format!("{width}x{height}")])
            .args(["-framerate", &fps.to_string(), "-i", "-"])
            // The colour space is that of high definition. It is stored, so that players need not
            // guess.
            .args("-vf scale=out_color_matrix=bt709:out_range=tv -colorspace bt709".split(' '))
            .args("-color_primaries bt709 -color_trc bt709 -c:v libx264 -crf 18".split(' '))
            .args("-pix_fmt yuv420p -movflags +faststart -f mp4".split(' '))
            .arg(target)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(log.try_clone().map_err(Failure::run)?);
        // In a process group of its own, ffmpeg is not interrupted by Ctrl-C. It ends when there
        // are no more frames.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let spawned = interrupt::temporary(|| command.spawn(), |it| Cleanup::Program(it.id()));
        let (ffmpeg, running) = spawned.map_err(|e| match e.kind() {
            io::ErrorKind::NotFound => Failure::run(
                "an MP4 is written by ffmpeg, which is not installed: install it (apt install ffmpeg), or write a .gif or a \
                 sequence such as film-####.png",
            ),
            _ => Failure::run(format!("ffmpeg could not be started: {}", terminal::reason(&e))),
        })?;
        Ok(Self { draft: Some(draft), ffmpeg, running: Some(running), log })
    }

    /// Waits until `ffmpeg` has ended, and removes its registration for clean-up.
    fn wait(&mut self) -> io::Result<ExitStatus> {
        drop(self.ffmpeg.stdin.take());
        self.running = None;
        self.ffmpeg.wait()
    }

    /// Returns the failure of `ffmpeg`, which must have ended: the error of the disk, or else its
    /// first message, because later ones only name consequences.
    fn complaint(&mut self, status: io::Result<ExitStatus>) -> Failure {
        let Some(mut draft) = self.draft.take() else {
            return Failure::run("ffmpeg failed");
        };
        let path = draft.path().to_owned();
        if let Err(cause) = draft.grow() {
            return not_written(&path, &cause);
        }
        let mut said = String::new();
        let read = self.log.rewind();
        let read = read.and_then(|()| self.log.read_to_string(&mut said));
        let first = said.lines().find(|line| !line.trim().is_empty());
        let why = match (first.filter(|_| read.is_ok()), status) {
            (Some(line), _) => line.trim().to_owned(),
            (None, Ok(status)) if status.success() => "the film is incomplete".to_owned(),
            (None, Ok(status)) => status.to_string(),
            (None, Err(e)) => e.to_string(),
        };
        Failure::run(format!("{}: could not be written: ffmpeg failed: {why}", path.display()))
    }
}

impl Film for Mp4 {
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure> {
        let sent = self.ffmpeg.stdin.as_mut();
        let sent = sent.map_or(Ok(()), |pipe| pipe.write_all(pixels));
        sent.map_err(|_| {
            // ffmpeg has closed its end of the pipe.
            let status = self.wait();
            self.complaint(status)
        })
    }

    fn finish(mut self: Box<Self>) -> Result<(), Failure> {
        let status = self.wait();
        // When the disk is full, some versions of ffmpeg report success for an incomplete file.
        let succeeded = matches!(&status, Ok(status) if status.success());
        let is_whole = |draft: &mut Draft| {
            let path = draft.beside().filter(|_| succeeded);
            path.is_some_and(|path| is_whole(path).unwrap_or(false))
        };
        match self.draft.take_if(is_whole) {
            Some(draft) => draft.place(),
            None => Err(self.complaint(status)),
        }
    }
}

/// Returns whether the boxes of an MP4 end where the file does and include the index of its frames.
/// A box begins with its length, in 4 bytes or, after its name, in 8.
fn is_whole(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let (mut at, mut has_index) = (0, false);
    while at < length {
        let (mut short, mut name, mut long) = ([0; 4], [0; 4], [0; 8]);
        file.seek(io::SeekFrom::Start(at))?;
        file.read_exact(&mut short)?;
        file.read_exact(&mut name)?;
        let bytes = match u32::from_be_bytes(short) {
            1 => {
                file.read_exact(&mut long)?;
                u64::from_be_bytes(long)
            }
            bytes => u64::from(bytes),
        };
        at = at.saturating_add(bytes.max(8));
        has_index |= &name == b"moov";
    }
    Ok(at == length && has_index)
}

impl Drop for Mp4 {
    fn drop(&mut self) {
        // This kills ffmpeg if the film was abandoned, and does nothing if ffmpeg has ended.
        let _ = self.ffmpeg.kill();
        let _ = self.ffmpeg.wait();
    }
}
