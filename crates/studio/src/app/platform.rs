//! The platform: the operating system, or the browser in a page.

#[cfg(not(target_arch = "wasm32"))]
pub use super::native::{CAN_QUIT, Event, Platform, attributes};
#[cfg(target_arch = "wasm32")]
pub use super::page::{CAN_QUIT, Event, Platform, attributes, connect, send};
