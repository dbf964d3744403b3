//! The files of a scene: ordinary files of limited size, in the scene's folder or below it.

use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

use a3_scenes::unmarked;

use super::read::read;
use crate::terminal;

/// Largest size of a scene file (bytes).
const MAX_SIZE: u64 = 16 << 20;
/// Largest length of a line in a scene file (bytes).
const MAX_LINE: usize = 8 << 20;

/// Reads the text of a scene file.
pub fn read_text(path: &Path) -> Result<String, String> {
    text_of(&read(path, MAX_SIZE)?)
}

/// Returns the text of standard input, which is read at the first call.
pub fn read_input() -> Result<String, String> {
    static TEXT: OnceLock<Result<String, String>> = OnceLock::new();
    let read = || {
        let mut bytes = vec![];
        let mut input = io::stdin().lock().take(MAX_SIZE + 1);
        let read = input.read_to_end(&mut bytes);
        read.map_err(|why| format!("it could not be read: {}", terminal::reason(&why)))?;
        if bytes.len() as u64 > MAX_SIZE {
            return Err(format!("it is larger than {} MiB", MAX_SIZE >> 20));
        }
        text_of(&bytes)
    };
    TEXT.get_or_init(read).clone()
}

/// Decodes UTF-8 text without its byte order mark. If no line ends in LF, each CR becomes an LF.
///
/// # Errors
/// The bytes are not UTF-8, or a line is too long.
fn text_of(bytes: &[u8]) -> Result<String, String> {
    let text = str::from_utf8(unmarked(bytes)?)
        .map_err(|e| format!("it is not UTF-8 text: see byte {}", e.valid_up_to()))?;
    let text = if text.contains('\n') {
        text.to_owned()
    } else {
        text.replace('\r', "\n")
    };
    match text.lines().position(|line| line.len() > MAX_LINE) {
        Some(k) => Err(format!(
            "line {} is longer than {} MiB",
            k + 1,
            MAX_LINE >> 20
        )),
        None => Ok(text),
    }
}

/// Returns the path of a file that a scene names, relative to the scene's folder.
///
/// # Errors
/// The file is outside that folder.
pub fn beside(scene: Option<&Path>, name: &str) -> Result<PathBuf, String> {
    let below = Path::new(name)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !below || name.is_empty() {
        return Err(format!(
            "`{name}` must be in the scene's folder or below it, without `..`"
        ));
    }
    let folder = scene.and_then(Path::parent).unwrap_or(Path::new(""));
    let path = folder.join(name);
    if let (Ok(end), Ok(folder)) = (
        path.canonicalize(),
        Path::new(".").join(folder).canonicalize(),
    ) && !end.starts_with(folder)
    {
        return Err(format!(
            "`{name}` leads out of the scene's folder by a link: put the file itself there"
        ));
    }
    Ok(path)
}
