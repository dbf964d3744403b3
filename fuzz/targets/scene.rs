//! Scenes in TOML, built without files.
#![no_main]

use a3_scenes::parse_toml;

libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok((description, places)) = parse_toml(text) {
        let built = description.build(None, &mut |_| Err("there are no files here".into()));
        let _ = built.map_err(|fault| places.locate(fault).to_string());
    }
});
