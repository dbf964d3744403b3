//! The shaders parse and validate without a GPU, require no special features, and can be translated
//! to the language of WebGL 2.

use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;

const SOURCES: [&str; 2] = [
    concat!(
        include_str!("../src/scene.wgsl"),
        include_str!("../src/floor.wgsl"),
        include_str!("../src/lines.wgsl")
    ),
    include_str!("../src/transfer.wgsl"),
];

fn valid(source: &str) -> (naga::Module, naga::valid::ModuleInfo) {
    let module = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
    let info = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
    (module, info)
}

#[test]
fn every_shader_is_valid_and_can_be_said_in_the_language_of_webgl() {
    let options = glsl::Options {
        version: glsl::Version::Embedded { version: 300, is_webgl: true },
        ..Default::default()
    };
    for (source, least) in SOURCES.into_iter().zip([20, 2]) {
        let (module, info) = valid(source);
        assert!(module.entry_points.len() >= least);
        for entry in &module.entry_points {
            let pipeline = glsl::PipelineOptions {
                shader_stage: entry.stage,
                entry_point: entry.name.clone(),
                multiview: None,
            };
            let mut text = String::new();
            let policies = BoundsCheckPolicies::default();
            glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, policies)
                .and_then(|mut writer| writer.write())
                .unwrap_or_else(|why| panic!("{}: {why}", entry.name));
        }
    }
}
