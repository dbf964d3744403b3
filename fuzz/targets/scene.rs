//! Scenes in TOML, built without files.
#![no_main]

use a3_scenes::Description;

libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(description) = Description::parse(text) {
        let built = description.build(None, &mut |_| Err("there are no files here".into()));
        let _ = built.map_err(|fault| fault.locate(text).to_string());
    }
});
