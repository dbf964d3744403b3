//! Data of charts, as JSON or CSV depending on the first byte.
#![no_main]

#[allow(dead_code, missing_docs)]
#[path = "../../crates/a3/src/commands/chart/record.rs"]
mod record;
/// The modules that this record uses, by the same names.
#[path = "."]
mod files {
    #[allow(dead_code, missing_docs)]
    #[path = "."]
    pub mod rows {
        #[path = "../../crates/a3/src/files/rows/row.rs"]
        mod row;
        #[path = "../../crates/a3/src/files/rows/text.rs"]
        pub mod text;
        pub use row::Row;
    }
}

use files::rows::text;
use record::Record;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = text::read::<Record>(text, text.starts_with(['[', '{']));
});
