//! The settings of a page, which the browser stores.

use std::path::{Path, PathBuf};

use a3_files::browser;
use a3_files::failure::Failure;

/// Reads the text that the browser stores under a name.
pub fn text_of(path: &Path) -> Result<Option<String>, String> {
    let storage = browser::storage();
    Ok(storage.and_then(|it| it.get_item(&path.to_string_lossy()).ok().flatten()))
}

/// Stores a text in the browser under a name, if the browser allows it.
pub fn store(path: &Path, text: &str) -> Result<(), Failure> {
    if let Some(storage) = browser::storage() {
        let _ = storage.set_item(&path.to_string_lossy(), text);
    }
    Ok(())
}

/// Returns the name under which the browser stores the settings.
pub fn file() -> PathBuf {
    "a3 settings".into()
}
