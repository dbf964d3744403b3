//! Settings of the window that are saved between sessions.

use std::path::{Path, PathBuf};

use a3_files::ending::Ending;
use a3_files::failure::Failure;
use serde::{Deserialize, Serialize};

use super::storage::{file, store, text_of};
use crate::session::{DEFAULT_FILM_SECONDS, SPAN};

/// Largest number of recent files.
const MAX_RECENT_FILES: usize = 12;
/// Scale factors that text and panel can have.
pub const SCALES: [f32; 8] = [0.75, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0];

/// The settings that do not belong to a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "each is a setting of its own")]
pub struct Settings {
    /// Scale factor of text and panel, on top of the screen's own.
    pub interface_scale: f32,
    /// Whether the window fills the screen.
    pub full_screen: bool,
    /// Whether the dark theme is on.
    pub dark: bool,
    /// Whether the panel is open.
    pub panel: bool,
    /// Whether the user has pulled something, and needs no hint.
    pub pulled: bool,
    /// Largest frame rate (1/s), or 0 for that of the screen.
    pub frame_limit: u32,
    /// The format of films.
    pub film: Ending,
    /// Simulated time that a film of the last seconds covers (s).
    pub film_seconds: f64,
    /// Scene files, the most recently opened first.
    pub recent: Vec<PathBuf>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            interface_scale: 1.0,
            full_screen: false,
            dark: false,
            panel: false,
            pulled: false,
            frame_limit: 0,
            film: Ending::default(),
            film_seconds: DEFAULT_FILM_SECONDS,
            recent: vec![],
        }
    }
}

impl Settings {
    /// Reads the settings from the user's folder; returns the defaults if there are none. Fails if
    /// they cannot be read or are not valid.
    pub fn read() -> Result<Self, String> {
        Self::read_from(&file())
    }

    fn read_from(path: &Path) -> Result<Self, String> {
        let place = path.display();
        let Some(text) = text_of(path)? else {
            return Ok(Self::default());
        };
        let read: Self = toml::from_str(&text).map_err(|why| {
            let line = why.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            format!("{place}:{line}: this is not a setting of a3")
        })?;
        let [least, .., most] = SCALES.map(f64::from);
        let scale = read.interface_scale.into();
        for (name, value, low, high) in [
            ("interface_scale", scale, least, most),
            ("film_seconds", read.film_seconds, 1.0, SPAN),
            ("frame_limit", read.frame_limit.into(), 0.0, 1000.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(format!("{place}: {name} must be from {low} to {high}"));
            }
        }
        Ok(read)
    }

    /// Writes the settings to the user's folder. Fails if that is not possible.
    pub fn write(&self) -> Result<(), Failure> {
        self.write_to(&file())
    }

    fn write_to(&self, path: &Path) -> Result<(), Failure> {
        let text = toml::to_string(self).map_err(Failure::run)?;
        store(path, &text)
    }

    /// Puts `files`, the most recent first, before the recent files.
    pub fn remember(&mut self, files: impl Iterator<Item = PathBuf>) {
        let mut all: Vec<PathBuf> = files.chain(std::mem::take(&mut self.recent)).collect();
        let mut seen = std::collections::HashSet::new();
        all.retain(|file| seen.insert(file.clone()));
        all.truncate(MAX_RECENT_FILES);
        self.recent = all;
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn written_settings_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a3").join("settings.toml");
        assert_eq!(Settings::read_from(&path), Ok(Settings::default()));
        let mut settings = Settings {
            interface_scale: 1.5,
            panel: true,
            film: Ending::Mp4,
            ..Settings::default()
        };
        let files = ["/b.toml", "/a.toml", "/b.toml"].map(PathBuf::from);
        settings.remember(files.into_iter());
        settings.remember(std::iter::once(PathBuf::from("/c.toml")));
        let names: Vec<_> = settings.recent.iter().map(|p| p.to_str().unwrap()).collect();
        assert_eq!(names, ["/c.toml", "/b.toml", "/a.toml"]);
        assert!(settings.write_to(&path).is_ok());
        assert_eq!(Settings::read_from(&path), Ok(settings));
    }

    /// Devices and pipes are refused without blocking, and large files without reading them.
    #[test]
    fn only_small_regular_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("settings.toml");
        let refused = |path: &Path| {
            let why = Settings::read_from(path).unwrap_err();
            assert!(why.contains("not a regular file of at most 1 MiB"), "{why}");
        };
        refused(folder.path());
        fs::write(&path, vec![b'#'; (1 << 20) + 1]).unwrap();
        refused(&path);
        #[cfg(unix)]
        {
            refused(Path::new("/dev/zero"));
            fs::remove_file(&path).unwrap();
            let made = std::process::Command::new("mkfifo").arg(&path).status();
            assert!(made.unwrap().success());
            refused(&path);
        }
    }

    #[test]
    fn invalid_settings_are_refused_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("settings.toml");
        for (text, line) in [
            ("panel = true\nscale = 2\n", ":2: "),
            ("panel = 3\n", ":1: "),
            ("interface_scale = 1e9\n", ": interface_scale must be from 0.75 to 2"),
            ("\u{0}", ":1: "),
        ] {
            fs::write(&path, text).unwrap();
            let why = Settings::read_from(&path).unwrap_err();
            assert!(why.contains(line) && !why.contains('\n'), "{why}");
        }
    }
}
