//! The shaders parse and validate without a GPU, ask for nothing special, and can be said in the
//! language of WebGL 2.

use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;

const SOURCE: &str = concat!(
    include_str!("../src/scene.wgsl"),
    include_str!("../src/lines.wgsl")
);

fn valid() -> (naga::Module, naga::valid::ModuleInfo) {
    let module = naga::front::wgsl::parse_str(SOURCE)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(SOURCE)));
    let info = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(SOURCE)));
    (module, info)
}

#[test]
fn the_shader_is_valid() {
    valid();
}

#[test]
fn every_shader_can_be_said_in_the_language_of_webgl() {
    let (module, info) = valid();
    let options = glsl::Options {
        version: glsl::Version::Embedded {
            version: 300,
            is_webgl: true,
        },
        ..Default::default()
    };
    assert!(module.entry_points.len() > 20);
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
