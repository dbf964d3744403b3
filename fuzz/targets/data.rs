//! Data of charts, as JSON or CSV by the first byte.
#![no_main]

#[allow(dead_code, missing_docs)]
#[path = "../../crates/a3/src/commands/chart/record.rs"]
mod record;
#[allow(dead_code, missing_docs)]
#[path = "../../crates/a3/src/commands/chart/text.rs"]
mod text;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = text::read(text, text.starts_with(['[', '{']));
});
