//! The address of the page, whose query (after the question mark) is a command line.

use wasm_bindgen::JsValue;

use super::window::window;

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
    let words = words
        .replace("%20", "+")
        .replace("%3A", ":")
        .replace("%2F", "/");
    format!("{origin}{path}?{words}")
}

/// Sets the query of the address, without loading the page again.
pub fn set_words(words: &str) {
    let history = window().and_then(|window| window.history().ok());
    if let Some(history) = history {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&address(words)));
    }
}
