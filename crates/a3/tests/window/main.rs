//! The window for real: the built program on a virtual display, with real keys, a real mouse and a
//! window manager.
//!
//! Needs Xvfb, openbox, xdotool, wmctrl and xclip. Without them the tests are skipped with a loud
//! word, unless `A3_REQUIRE_DISPLAY` forbids that.

#![cfg(target_os = "linux")]
#![allow(missing_docs, reason = "a test")]

mod app;
mod choosing;
mod comparing;
mod display;
mod filming;
mod keys;
mod lessons;
mod mouse;
mod panel;
mod remembering;
mod screen;
mod surface;
mod watching;
