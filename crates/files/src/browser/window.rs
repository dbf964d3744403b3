//! The window of the browser: its document, storage, console and clipboard.

use wasm_bindgen::JsCast;
use web_sys::{Document, HtmlCanvasElement, Storage, Window};

/// Returns the window of the browser.
pub fn window() -> Option<Window> {
    web_sys::window()
}

/// Returns the document of the page.
pub fn document() -> Option<Document> {
    window()?.document()
}

/// Returns the canvas of the page.
pub fn canvas() -> Option<HtmlCanvasElement> {
    document()?.get_element_by_id("a3")?.dyn_into().ok()
}

/// Returns the storage of the browser for this page, which lasts from one visit to the next.
pub fn storage() -> Option<Storage> {
    window()?.local_storage().ok().flatten()
}

/// Writes a line to the console.
pub fn log(line: &str) {
    web_sys::console::log_1(&line.into());
}

/// Shows a text in place of the picture.
pub fn show(words: &str) {
    if let Some(place) = document().and_then(|document| document.get_element_by_id("words")) {
        place.set_text_content(Some(words));
    }
}

/// Copies a text to the clipboard, if the browser allows it.
pub fn copy(text: &str) {
    if let Some(window) = window() {
        let _ = window.navigator().clipboard().write_text(text);
    }
}
