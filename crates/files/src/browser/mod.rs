//! Functions of the browser that the page uses.

mod address;
mod download;
pub mod files;
mod window;

pub use address::{address, set_words, words};
pub use download::{download, download_picture};
pub use window::{canvas, copy, log, show, storage, window};
