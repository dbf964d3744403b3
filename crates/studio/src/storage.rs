//! The file of the settings.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

use a3_files::failure::Failure;
use a3_files::{output, terminal};

/// Largest size of a settings file (bytes).
const MAX_FILE_SIZE: u64 = 1 << 20;

/// Reads the text of a file, `None` if it does not exist. Fails if it is not a regular file, too
/// large, or unreadable.
pub fn text_of(path: &Path) -> Result<Option<String>, String> {
    let place = path.display();
    match fs::metadata(path) {
        Ok(there) if there.is_file() && there.len() <= MAX_FILE_SIZE => {}
        Ok(_) => {
            return Err(format!(
                "{place}: this is not a regular file of at most 1 MiB: the settings are neither read nor saved"
            ));
        }
        Err(why) if why.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(why) => return Err(format!("{place}: {}", terminal::reason(&why))),
    }
    let text = fs::read_to_string(path);
    text.map(Some).map_err(|why| format!("{place}: {}", terminal::reason(&why)))
}

/// Writes a file, and creates its folder if need be. Fails if that is not possible.
pub fn store(path: &Path, text: &str) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)
            .map_err(|why| Failure::run(format!("{}: {why}", folder.display())))?;
    }
    output::write(path, text.as_bytes())
}

/// Returns the path of the settings file.
pub fn file() -> PathBuf {
    let named = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = |below: &str| env::home_dir().map(|home| home.join(below));
    let folder = if cfg!(windows) {
        named("APPDATA")
    } else if cfg!(target_os = "macos") {
        home("Library/Application Support")
    } else {
        named("XDG_CONFIG_HOME").or_else(|| home(".config"))
    };
    let folder = folder.unwrap_or_else(env::temp_dir);
    folder.join("a3").join("settings.toml")
}
