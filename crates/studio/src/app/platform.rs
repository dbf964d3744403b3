//! The operating system's part of the window: clipboard, films, watched files, and an adapter that
//! is opened synchronously.

use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};
use std::{fs, thread};

use a3_files::failure::Failure;
use a3_files::{output, terminal};
use a3_render::{GpuError, Offscreen};
use arboard::Clipboard;
use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
#[cfg(target_os = "linux")]
use winit::platform::wayland::WindowAttributesExtWayland;
use winit::window::{Window, WindowAttributes};

use super::graphics::{Graphics, open_adapter};
use super::screen::Screen;
use crate::hud::{Studio, layout};
use crate::recorder::Recorder;
use crate::session::{Readings, Session};

/// Size of the window (points) where the screen has room for it.
const SIZE: [f64; 2] = [1280.0, 720.0];
/// Height that the window leaves to its title and to the bars of the desktop (points).
const BARS: f64 = 64.0;

/// Returns the initial attributes of the window, which fits on the screen.
pub fn attributes(event_loop: &ActiveEventLoop) -> WindowAttributes {
    let first = || event_loop.available_monitors().next();
    let monitor = event_loop.primary_monitor().or_else(first);
    let room = monitor.map(|it| it.size().to_logical(it.scale_factor()));
    let attributes = Window::default_attributes()
        .with_inner_size(room.map_or(SIZE.into(), fitting))
        .with_min_inner_size(LogicalSize::new(64.0, 48.0));
    // A desktop finds the icon by this name. On X11, winit sets this name by itself.
    #[cfg(target_os = "linux")]
    let attributes = WindowAttributesExtWayland::with_name(attributes, "a3", "a3");
    attributes
}

/// Returns the size of a window for a screen of a size (points).
fn fitting(screen: LogicalSize<f64>) -> LogicalSize<f64> {
    let [width, height] = SIZE;
    // A monitor of unknown size has none.
    if screen.width < 1.0 || screen.height <= BARS {
        return SIZE.into();
    }
    LogicalSize::new(width.min(screen.width), height.min(screen.height - BARS))
}

/// Whether the program closes its window; a page is closed by the browser.
pub const CAN_QUIT: bool = true;

/// Events from outside the window: none.
pub type Event = ();

/// Services of the operating system for the window.
#[derive(Default)]
pub struct Platform {
    /// The clipboard, opened on first use. Its contents are lost when it is dropped.
    clipboard: Option<Clipboard>,
    pub films: Films,
    /// Watch over the files of the scene, if it was requested.
    watch: Option<Watch>,
}

impl Platform {
    /// Creates the services, with a watch over `files`, if there are any.
    pub fn new(files: Vec<PathBuf>) -> Self {
        Self { watch: (!files.is_empty()).then(|| Watch::new(files)), ..Self::default() }
    }

    /// Opens an adapter, and creates the graphics for the window. Returns `None` if there is no
    /// window.
    pub fn open_graphics(
        &mut self,
        screen: &mut Screen,
        session: &mut Session,
    ) -> Option<Result<Graphics, GpuError>> {
        let window = screen.window.clone()?;
        // The recorder draws with the old device.
        self.films.finish(&mut session.readings);
        // The window cannot have two surfaces.
        screen.graphics = None;
        let opened = pollster::block_on(open_adapter(window.clone(), screen.display.clone()));
        Some(opened.and_then(|(gpu, surface)| Graphics::new(gpu, surface, window, session)))
    }

    /// Saves a picture, and returns a message about it.
    #[expect(clippy::unused_self, reason = "a page saves the next frame")]
    pub fn save_picture(&mut self, session: &mut Session, graphics: Option<&Graphics>) -> String {
        match write_picture(session, graphics) {
            Ok(name) => format!("Saved {name}."),
            Err(failure) => failure.to_string(),
        }
    }

    /// Writes a command line to the terminal and the clipboard, and returns a message about it.
    pub fn copy(&mut self, line: &str) -> String {
        // Copy the line even if the terminal is closed.
        let _ = terminal::say(&format!("{line}\n"));
        if self.clipboard.is_none() {
            self.clipboard = Clipboard::new().ok();
        }
        let copied = self.clipboard.as_mut().map(|board| board.set_text(line));
        match copied {
            Some(Ok(())) => format!("Copied: {line}"),
            _ => format!("Written to the terminal: {line}"),
        }
    }

    /// Returns whether a file of the scene has changed since the last check.
    pub fn files_changed(&mut self) -> bool {
        self.watch.as_mut().is_some_and(Watch::changed)
    }

    /// Returns the time of the next check of the watched files, if there are any.
    pub fn next_check(&self) -> Option<Instant> {
        self.watch.as_ref().map(|watch| watch.next)
    }
}

/// Writes a picture under the first free name, and returns its path. Several panes have their text,
/// a single one has none. Fails if drawing or writing does.
fn write_picture(session: &mut Session, graphics: Option<&Graphics>) -> Result<String, Failure> {
    let closed = || Failure::run("the graphics adapter is not open");
    let graphics = graphics.ok_or_else(closed)?;
    let (gpu, size) = (&graphics.gpu, graphics.size());
    let offscreen = Offscreen::new(gpu, size).map_err(Failure::run)?;
    let readings = Readings { no_error: session.readings.no_error, ..Readings::default() };
    let (panes, scale) = (&mut session.runs.panes, graphics.scale());
    let mut studio = Studio::new(gpu, offscreen, panes);
    let pixels = studio.draw(gpu, panes, session.view.camera, scale, &readings)?;
    let scene = &session.runs.first().scene().name;
    let path = output::write_new("".as_ref(), scene, "png", &output::png(&pixels, size)?)?;
    Ok(path.display().to_string())
}

/// The recorder of the film, if one is being made.
#[derive(Default)]
pub struct Films {
    recorder: Option<Recorder>,
}

impl Films {
    /// Starts a live film or, with `past`, one of the last seconds, unless another film is being
    /// made. Completes a live film in place of starting another.
    pub fn record(&mut self, session: &mut Session, graphics: Option<&Graphics>, past: bool) {
        let is_live = self.recorder.as_ref().is_some_and(Recorder::is_live);
        if is_live && !past {
            return self.finish(&mut session.readings);
        }
        let Some(graphics) = graphics else {
            return;
        };
        if self.recorder.is_some() {
            session.readings.say("Another film is being made.");
            return;
        }
        let scale = graphics.scale();
        let size = layout::picture_size(session, graphics.size(), scale);
        let begin = if past { Recorder::of_past } else { Recorder::from_now };
        match begin(&graphics.gpu, session, (size, scale)) {
            Ok(recorder) => self.recorder = Some(recorder),
            Err(why) => session.readings.warn(why.to_string()),
        }
        self.show_progress(&mut session.readings);
    }

    /// Draws the next frame of the film, if one is due. Returns whether the window must draw
    /// another frame, because the film of the last seconds continues.
    pub fn draw(&mut self, session: &mut Session, graphics: Option<&Graphics>) -> bool {
        let (Some(recorder), Some(graphics)) = (&mut self.recorder, graphics) else {
            return false;
        };
        match recorder.draw_next(&graphics.gpu, session) {
            Ok(true) => {}
            Ok(false) => self.finish(&mut session.readings),
            Err(why) => {
                self.recorder = None;
                session.readings.warn(why.to_string());
            }
        }
        self.show_progress(&mut session.readings);
        self.recorder.as_ref().is_some_and(|film| !film.is_live())
    }

    /// Completes a live film, because the scene has changed.
    pub fn finish_live(&mut self, readings: &mut Readings) {
        if self.recorder.as_ref().is_some_and(Recorder::is_live) {
            self.finish(readings);
        }
    }

    /// Returns the real time (s) by which the session may advance in a frame of `real` (s), limited
    /// by a live film.
    pub fn time_to_advance(&self, session: &Session, real: f64) -> f64 {
        let recorder = self.recorder.as_ref();
        recorder.map_or(real, |recorder| recorder.time_to_advance(session, real))
    }

    /// Completes the film, and shows a message.
    pub fn finish(&mut self, readings: &mut Readings) {
        let Some(recorder) = self.recorder.take() else {
            return;
        };
        match recorder.finish() {
            Ok(said) => readings.say(said),
            Err(why) => readings.warn(why.to_string()),
        }
        self.show_progress(readings);
    }

    /// Completes the film before the window closes. A film of the last seconds gets all of its
    /// frames.
    pub fn complete(&mut self, session: &mut Session, graphics: Option<&Graphics>) {
        while self.recorder.as_ref().is_some_and(|film| !film.is_live())
            && self.draw(session, graphics)
        {
            thread::sleep(Duration::from_millis(1));
        }
        self.finish(&mut session.readings);
        if let Some(said) = session.readings.message.take() {
            terminal::warn(&said);
        }
    }

    /// Shows the progress of the film.
    fn show_progress(&self, readings: &mut Readings) {
        readings.film = self.recorder.as_ref().map(Recorder::progress);
    }
}

/// Time between two checks. Checking works whether an editor renames, truncates or rewrites the
/// file.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// Modification time and length of a file, which identify its version; `None` if there is no file.
type Stamp = Option<(SystemTime, u64)>;

/// A watch over the files of a scene.
pub struct Watch {
    files: Vec<PathBuf>,
    seen: Vec<Stamp>,
    next: Instant,
}

impl Watch {
    /// Starts to watch files in their present versions.
    pub fn new(files: Vec<PathBuf>) -> Self {
        Self {
            seen: files.iter().map(stamp).collect(),
            files,
            next: Instant::now() + CHECK_INTERVAL,
        }
    }

    /// Checks the files if that is due. Returns whether one has changed and all of them exist.
    pub fn changed(&mut self) -> bool {
        if Instant::now() < self.next {
            return false;
        }
        self.next = Instant::now() + CHECK_INTERVAL;
        let now: Vec<_> = self.files.iter().map(stamp).collect();
        // A file that is being replaced does not exist for a moment.
        if now == self.seen || now.iter().any(Option::is_none) {
            return false;
        }
        self.seen = now;
        true
    }
}

fn stamp(path: &PathBuf) -> Stamp {
    let meta = fs::metadata(path).ok()?;
    Some((meta.modified().ok()?, meta.len()))
}

#[cfg(test)]
mod tests {
    use std::thread::sleep;

    use super::*;

    #[test]
    fn the_window_fits_on_the_screen() {
        for (screen, expected) in [
            ([1920.0, 1080.0], [1280.0, 720.0]),
            ([1024.0, 768.0], [1024.0, 704.0]),
            ([0.0, 0.0], [1280.0, 720.0]),
        ] {
            let fitted: [f64; 2] = fitting(screen.into()).into();
            assert_eq!(fitted, expected);
        }
    }

    #[test]
    fn a_changed_file_is_reported_once_and_a_missing_one_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, "a").unwrap();
        let mut watch = Watch::new(vec![path.clone()]);
        let mut look = || {
            sleep(CHECK_INTERVAL + Duration::from_millis(20));
            watch.changed()
        };
        assert!(!look());
        fs::write(&path, "ab").unwrap();
        assert!(look() && !look());
        fs::remove_file(&path).unwrap();
        assert!(!look());
        fs::write(&path, "abc").unwrap();
        assert!(look());
    }
}
