//! Output of a page, which has no terminal: text goes to the console of the browser.

use std::io;

use super::browser::log;
use super::failure::Failure;

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
