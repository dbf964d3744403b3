//! The shader parses and validates without a GPU, and asks for nothing special.

#[test]
fn the_shader_is_valid() {
    let source = concat!(
        include_str!("../src/scene.wgsl"),
        include_str!("../src/lines.wgsl")
    );
    let module = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
}
