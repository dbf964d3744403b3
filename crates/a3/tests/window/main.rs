//! Tests of the built program in its window, on a virtual display with keys, a mouse and a window
//! manager.
//!
//! They need Xvfb, openbox, xdotool, wmctrl and xclip. Without these they are skipped with a
//! message, or fail if `A3_REQUIRE_DISPLAY` is set.

#![cfg(target_os = "linux")]
#![allow(missing_docs, reason = "a test")]

mod app;
mod bar;
mod choosing;
#[path = "../common/mod.rs"]
mod common;
mod comparing;
mod display;
mod editing;
mod filming;
mod keys;
mod lessons;
mod measuring;
mod mouse;
mod panel;
mod plotting;
mod remembering;
mod screen;
mod surface;
mod watching;
