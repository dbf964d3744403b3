//! Reading the files of a scene: ordinary files of limited length, from the scene's folder
//! downwards.

use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

use a3_scenes::unmarked;

use super::read::read;
use crate::base::terminal;

/// The longest scene file (bytes).
const LONGEST: u64 = 16 << 20;
/// The longest line of a scene file (bytes): a longer one was not written by hand.
const LONGEST_LINE: usize = 8 << 20;

/// The text of a scene file.
pub fn read_text(path: &Path) -> Result<String, String> {
    text_of(&read(path, LONGEST)?)
}

/// The text of a scene that comes by standard input, which is read once.
pub fn read_input() -> Result<String, String> {
    static TEXT: OnceLock<Result<String, String>> = OnceLock::new();
    let read = || {
        let mut bytes = vec![];
        let mut input = io::stdin().lock().take(LONGEST + 1);
        let read = input.read_to_end(&mut bytes);
        read.map_err(|why| format!("it could not be read: {}", terminal::reason(&why)))?;
        if bytes.len() as u64 > LONGEST {
            return Err(format!("it is larger than {} MiB", LONGEST >> 20));
        }
        text_of(&bytes)
    };
    TEXT.get_or_init(read).clone()
}

/// The text in bytes, without a byte order mark; lines that end in CR alone end in LF.
fn text_of(bytes: &[u8]) -> Result<String, String> {
    let text = str::from_utf8(unmarked(bytes)?)
        .map_err(|e| format!("it is not UTF-8 text: see byte {}", e.valid_up_to()))?;
    let text = if text.contains('\n') {
        text.to_owned()
    } else {
        text.replace('\r', "\n")
    };
    match text.lines().position(|line| line.len() > LONGEST_LINE) {
        Some(k) => Err(format!(
            "line {} is longer than {} MiB",
            k + 1,
            LONGEST_LINE >> 20
        )),
        None => Ok(text),
    }
}

/// The path of a file that a scene names: beside the scene or in a folder beside it.
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
