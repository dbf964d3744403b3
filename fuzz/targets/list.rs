//! Lists of particles and springs in JSON.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok((description, _)) = a3_scenes::parse_json(text) {
        let _ = description.build(None, &mut |_| Err("there are no files here".into()));
    }
});
