//! Data of charts, as JSON or CSV depending on the first byte.
#![no_main]

use a3_files::rows::text;
use a3_lab::chart::Record;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = text::read::<Record>(text, text.starts_with(['[', '{']));
});
