//! States of two particles by other programs: an archive, JSON or CSV depending on the first byte.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let ending = match bytes.first() {
        Some(b'P') => "npz",
        Some(b'[' | b'{') => "json",
        _ => "csv",
    };
    let _ = a3_files::states::parse(bytes, ending, 2);
});
