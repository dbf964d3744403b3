//! The platform: the operating system, or the browser in a page.

#[cfg(not(target_arch = "wasm32"))]
pub use super::native::{Event, Platform, attributes, open_lessons, quit};
#[cfg(target_arch = "wasm32")]
pub use super::page::{Event, Platform, attributes, connect, open_lessons, quit, send};
