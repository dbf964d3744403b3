//! What a page has in place of a disk, a terminal, and signals.

use std::path::Path;

use crate::browser::files;

/// Reads a file of at most `max_size` bytes that was dropped on the page.
pub fn read(path: &Path, max_size: u64) -> Result<Vec<u8>, String> {
    let bytes = files::read(path);
    let bytes = bytes.ok_or("it is not on this page: drop the files that it names first")?;
    if bytes.len() as u64 > max_size {
        return Err(format!("it is larger than {} MiB", max_size >> 20));
    }
    Ok(bytes)
}

/// Reads the bytes of a checkpoint.
pub fn read_checkpoint(path: &Path) -> Result<Vec<u8>, String> {
    files::read(path).ok_or_else(|| "there is no such file on this page".into())
}

pub mod bar {
    //! Long runs, which show no bar.

    /// The bar of a run.
    pub struct RunBar;

    impl RunBar {
        /// Creates the bar of a run.
        pub fn begin() -> Self {
            Self
        }

        /// Shows nothing.
        pub fn show(&mut self, _: f64) {}

        /// Shows nothing.
        pub fn clear(self) {}
    }
}

pub mod output {
    //! Files that a page writes, as downloads.

    use std::path::{Path, PathBuf};

    use crate::browser::{download, files};
    use crate::failure::Failure;
    use crate::visible::part_of_name;

    /// Gives `bytes` to the browser as a download, and stores them as a file of the page, both
    /// under the first free name a3-SCENE-k. Returns that name.
    pub fn write_new(
        _: &Path,
        scene: &str,
        extension: &str,
        bytes: &[u8],
    ) -> Result<PathBuf, Failure> {
        let scene = part_of_name(scene);
        let name = |k: usize| PathBuf::from(format!("a3-{scene}-{k}.{extension}"));
        let path = (1..=usize::MAX).map(name).find(|path| files::read(path).is_none());
        let path = path.unwrap_or_default();
        write(&path, bytes)?;
        Ok(path)
    }

    /// Gives `bytes` to the browser as a download of that name, and stores them as a file of the
    /// page.
    pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        files::keep(path, bytes);
        download(&path.to_string_lossy(), bytes).map_err(Failure::run)
    }
}

pub mod terminal {
    //! Text, which goes to the console of the browser.

    use std::io;

    use crate::browser::log;
    use crate::failure::Failure;

    /// Writes text to the console.
    pub fn say(text: &str) -> Result<(), Failure> {
        log(text.trim_end());
        Ok(())
    }

    /// Writes data to the console.
    pub fn send(data: &str) -> Result<(), Failure> {
        say(data)
    }

    /// Converts the result of a write to the console.
    pub fn check_write(written: io::Result<()>) -> Result<(), Failure> {
        written.map_err(Failure::run)
    }

    /// Writes a message to the console.
    pub fn warn(message: &str) {
        log(message);
    }

    /// Writes a note about a scene to the console.
    pub fn note(message: &str) {
        warn(&format!("note: {message}"));
    }

    /// Returns why a file could not be read, in words.
    pub fn reason(error: &io::Error) -> String {
        error.to_string()
    }
}
