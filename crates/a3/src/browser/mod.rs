//! What the page asks of the browser.

pub mod files;

use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Blob, Document, HtmlAnchorElement, HtmlCanvasElement, Storage, Url, Window};

/// The window of the browser.
pub fn window() -> Option<Window> {
    web_sys::window()
}

fn document() -> Option<Document> {
    window()?.document()
}

/// The canvas that is drawn to.
pub fn canvas() -> Option<HtmlCanvasElement> {
    document()?.get_element_by_id("a3")?.dyn_into().ok()
}

/// What the browser remembers for this page from one time to the next.
pub fn storage() -> Option<Storage> {
    window()?.local_storage().ok().flatten()
}

/// Writes a line to the console.
pub fn log(line: &str) {
    web_sys::console::log_1(&line.into());
}

/// Shows words in place of the picture.
pub fn show(words: &str) {
    if let Some(place) = document().and_then(|document| document.get_element_by_id("words")) {
        place.set_text_content(Some(words));
    }
}

/// The words of the address behind the question mark: `?t+0.01+--scene+flag`.
pub fn words() -> Vec<String> {
    let search = window().and_then(|window| window.location().search().ok());
    let search = search.unwrap_or_default().replace('+', " ");
    let text = js_sys::decode_uri_component(search.trim_start_matches('?'));
    let text = text.map_or(search, String::from);
    text.split_whitespace().map(str::to_owned).collect()
}

/// The address of this page with other words.
pub fn address(words: &str) -> String {
    let here = window().map(|window| window.location());
    let part =
        |part: Option<Result<String, JsValue>>| part.and_then(Result::ok).unwrap_or_default();
    let [origin, path] = [
        part(here.as_ref().map(web_sys::Location::origin)),
        part(here.as_ref().map(web_sys::Location::pathname)),
    ];
    let words: String = js_sys::encode_uri_component(words).into();
    // What stays readable in an address.
    let words = words
        .replace("%20", "+")
        .replace("%3A", ":")
        .replace("%2F", "/");
    format!("{origin}{path}?{words}")
}

/// Puts words into the address, without loading the page again.
pub fn set_words(words: &str) {
    let history = window().and_then(|window| window.history().ok());
    if let Some(history) = history {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&address(words)));
    }
}

/// Copies a text to the clipboard, if the browser lets it.
pub fn copy(text: &str) {
    if let Some(window) = window() {
        let _ = window.navigator().clipboard().write_text(text);
    }
}

/// Opens another page beside this one.
pub fn open(address: &str) {
    if let Some(window) = window() {
        let _ = window.open_with_url_and_target(address, "_blank");
    }
}

/// Offers bytes as a file of that name.
pub fn download(name: &str, bytes: &[u8]) -> Result<(), &'static str> {
    let parts = Array::of1(&Uint8Array::from(bytes));
    let blob = Blob::new_with_u8_array_sequence(&parts);
    blob.map_err(|_| "the browser has no memory for the file")
        .and_then(|blob| offer(name, &blob))
}

/// Offers the picture in the canvas, as it is now, as a file of that name.
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
