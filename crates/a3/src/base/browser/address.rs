//! The address of the page: what comes after its question mark is a command line.

use wasm_bindgen::JsValue;

use super::window::window;

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
