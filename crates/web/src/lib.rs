//! The program as a page of the web: the window in a canvas, and messages to it.

#![cfg(target_arch = "wasm32")]

mod page;
