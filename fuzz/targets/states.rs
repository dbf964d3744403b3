//! States of two particles by other programs: an archive, JSON or CSV depending on the first byte.
#![no_main]

#[allow(dead_code, missing_docs)]
#[path = "."]
mod states {
    #[path = "../../crates/a3/src/files/states/build.rs"]
    pub mod build;
    #[path = "../../crates/a3/src/files/states/columns.rs"]
    mod columns;
    #[path = "../../crates/a3/src/files/states/csv.rs"]
    mod csv;
    #[path = "../../crates/a3/src/files/states/digits.rs"]
    mod digits;
    #[path = "../../crates/a3/src/files/states/json.rs"]
    mod json;
    #[path = "../../crates/a3/src/files/states/npy.rs"]
    mod npy;
    #[path = "../../crates/a3/src/files/states/npz.rs"]
    mod npz;
    #[path = "../../crates/a3/src/files/states/parse.rs"]
    pub mod parse;
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let ending = match bytes.first() {
        Some(b'P') => "npz",
        Some(b'[' | b'{') => "json",
        _ => "csv",
    };
    let _ = states::parse::parse(bytes, ending, 2);
});
