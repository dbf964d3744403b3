//! Functions that the page calls: the program in a canvas, and messages to it.

#![cfg(target_arch = "wasm32")]

use wasm_bindgen::prelude::wasm_bindgen;

/// Starts the program as the address requests.
#[wasm_bindgen]
pub fn start() {
    a3::page::start();
}

/// Shows a message over the picture.
#[wasm_bindgen]
pub fn say(words: &str) {
    a3::page::say(words);
}

/// Takes steps of the run in a command line: returns a hash of the state, and the time of a step
/// (µs).
#[wasm_bindgen]
pub fn run_steps(words: &str, steps: u32) -> String {
    a3::page::run_steps(words, steps)
}

/// Stores a file that the scenes of the page may name.
#[wasm_bindgen]
pub fn keep_file(name: &str, bytes: &[u8]) {
    a3::page::keep_file(name, bytes);
}

/// Opens a file that was dropped on the page.
#[wasm_bindgen]
pub fn open_file(name: &str, bytes: &[u8]) {
    a3::page::open_file(name, bytes);
}
