//! Functions of the browser that the page uses: its window, the query of its address, and
//! downloads.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::JsCast;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, Document, HtmlAnchorElement, HtmlCanvasElement, Storage, Url, Window};

/// Returns the window of the browser.
pub fn window() -> Option<Window> {
    web_sys::window()
}

/// Returns the document of the page.
fn document() -> Option<Document> {
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

/// Returns the words of the query, as in `?t+0.01+--scene+flag`.
pub fn words() -> Vec<String> {
    let search = window().and_then(|window| window.location().search().ok());
    let search = search.unwrap_or_default().replace('+', " ");
    let text = js_sys::decode_uri_component(search.trim_start_matches('?'));
    let text = text.map_or(search, String::from);
    text.split_whitespace().map(str::to_owned).collect()
}

/// Returns the address of this page with another query.
pub fn address(words: &str) -> String {
    let here = window().map(|window| window.location());
    let part =
        |part: Option<Result<String, JsValue>>| part.and_then(Result::ok).unwrap_or_default();
    let [origin, path] = [
        part(here.as_ref().map(web_sys::Location::origin)),
        part(here.as_ref().map(web_sys::Location::pathname)),
    ];
    let words: String = js_sys::encode_uri_component(words).into();
    // These may stand in a query, and are easier to read.
    let words = words.replace("%20", "+").replace("%3A", ":").replace("%2F", "/");
    format!("{origin}{path}?{words}")
}

/// Sets the query of the address, without loading the page again.
pub fn set_words(words: &str) {
    let history = window().and_then(|window| window.history().ok());
    if let Some(history) = history {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&address(words)));
    }
}

/// Offers bytes as a download with this name.
pub fn download(name: &str, bytes: &[u8]) -> Result<(), &'static str> {
    let parts = Array::of1(&Uint8Array::from(bytes));
    let blob = Blob::new_with_u8_array_sequence(&parts);
    blob.map_err(|_| "the browser has no memory for the file").and_then(|blob| offer(name, &blob))
}

/// Offers the present picture of the canvas as a download with this name.
pub fn download_picture(name: String) {
    let offer = Closure::once_into_js(move |blob: Option<Blob>| {
        if let Some(blob) = blob {
            let _ = offer(&name, &blob);
        }
    });
    if let Some(canvas) = canvas() {
        let _ = canvas.to_blob(offer.unchecked_ref());
    }
}

fn offer(name: &str, blob: &Blob) -> Result<(), &'static str> {
    let refused = "the browser refused the download";
    let url = Url::create_object_url_with_blob(blob).map_err(|_| refused)?;
    let link = document().and_then(|document| document.create_element("a").ok());
    let link = link.and_then(|link| link.dyn_into::<HtmlAnchorElement>().ok());
    let link = link.ok_or(refused)?;
    link.set_href(&url);
    link.set_download(name);
    link.click();
    let _ = Url::revoke_object_url(&url);
    Ok(())
}

pub mod files {
    //! The files of a page: those that were dropped on it, and those that it wrote.

    use std::cell::RefCell;
    use std::collections::BTreeMap;
    use std::path::{Path, PathBuf};

    thread_local! {
        static FILES: RefCell<BTreeMap<PathBuf, Vec<u8>>> = const { RefCell::new(BTreeMap::new()) };
    }

    /// Stores a file, in place of one of the same name.
    pub fn keep(path: &Path, bytes: &[u8]) {
        FILES.with_borrow_mut(|files| files.insert(path.into(), bytes.into()));
    }

    /// Returns the bytes of a file, if there is one.
    pub fn read(path: &Path) -> Option<Vec<u8>> {
        FILES.with_borrow(|files| files.get(path).cloned())
    }
}
