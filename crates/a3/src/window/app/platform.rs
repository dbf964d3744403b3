//! What the window does through the system or, in a page, through the browser.

#[cfg(not(target_arch = "wasm32"))]
pub use super::native::{Event, Platform, attributes, open_lessons, quit};
#[cfg(target_arch = "wasm32")]
pub use super::page::{Event, Platform, attributes, connect, open_lessons, quit, send};
