//! Data of charts, as JSON or CSV depending on the first byte.
#![no_main]

use a3_files::rows;
use a3_lab::chart::Record;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = rows::read::<Record>(text, text.starts_with(['[', '{']));
});
