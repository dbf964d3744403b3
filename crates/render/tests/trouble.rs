//! Failures are errors, never panics.

mod common;

use a3_render::{Gpu, GpuError, OFFSCREEN_FORMAT, Offscreen, Renderer, Style};
use common::{Sheet, gpu};

/// A device without a driver: everything is validated, nothing is drawn.
fn noop() -> Gpu {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::NOOP;
    descriptor.backend_options.noop.enable = true;
    pollster::block_on(Gpu::open(wgpu::Instance::new(descriptor), None)).unwrap()
}

#[test]
fn pipelines_and_frames_validate_without_a_driver() {
    let gpu = noop();
    let sheet = Sheet::new();
    for samples in [1, 4] {
        let mut renderer = Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &sheet.topology);
        if samples != gpu.samples(OFFSCREEN_FORMAT) {
            continue;
        }
        let offscreen = Offscreen::new(&gpu, (33, 17)).unwrap();
        for style in [Style::Shaded, Style::Wireframe] {
            let pixels = offscreen
                .render(&gpu, &mut renderer, &sheet.picture(style))
                .unwrap();
            assert_eq!(pixels.len(), 33 * 17 * 4);
        }
    }
    gpu.check().unwrap();
}

#[test]
fn impossible_sizes_are_refused() {
    let gpu = noop();
    let limit = gpu.largest_side();
    for size in [
        (0, 5),
        (5, 0),
        (limit + 1, 5),
        (5, limit + 1),
        (u32::MAX, u32::MAX),
    ] {
        let refused = Offscreen::new(&gpu, size).err();
        assert_eq!(refused, Some(GpuError::Size { asked: size, limit }));
    }
    assert!(refused_in_words(limit).contains(&limit.to_string()));
}

fn refused_in_words(limit: u32) -> String {
    GpuError::Size {
        asked: (0, 0),
        limit,
    }
    .to_string()
}

#[test]
fn a_validation_error_is_reported() {
    let gpu = noop();
    gpu.check().unwrap();
    // A depth format is not a colour format.
    let _ = Renderer::new(
        &gpu,
        wgpu::TextureFormat::Depth32Float,
        1,
        &Sheet::new().topology,
    );
    let Err(GpuError::Refused(why)) = gpu.check() else {
        panic!("not reported")
    };
    assert!(!why.contains('\n'), "{why}");
    gpu.check().unwrap();
}

#[test]
fn a_lost_device_is_reported_and_another_can_be_opened() {
    let Some(mut device) = gpu() else { return };
    let sheet = Sheet::new();
    for _ in 0..3 {
        let mut renderer = Renderer::new(
            &device,
            OFFSCREEN_FORMAT,
            device.samples(OFFSCREEN_FORMAT),
            &sheet.topology,
        );
        let offscreen = Offscreen::new(&device, (64, 64)).unwrap();
        offscreen
            .render(&device, &mut renderer, &sheet.picture(Style::Shaded))
            .unwrap();
        device.device.destroy();
        assert_eq!(
            offscreen.render(&device, &mut renderer, &sheet.picture(Style::Shaded)),
            Err(GpuError::Lost)
        );
        device = gpu().unwrap();
    }
}

/// Drawing nothing is no error.
#[test]
fn an_empty_picture() {
    let gpu = noop();
    let mut sheet = Sheet::new();
    sheet.topology = a3_render::Topology::default();
    sheet.points.clear();
    sheet.balls.clear();
    sheet.lines.clear();
    let mut renderer = Renderer::new(
        &gpu,
        OFFSCREEN_FORMAT,
        gpu.samples(OFFSCREEN_FORMAT),
        &sheet.topology,
    );
    let offscreen = Offscreen::new(&gpu, (8, 8)).unwrap();
    for style in [Style::Shaded, Style::Wireframe] {
        offscreen
            .render(&gpu, &mut renderer, &sheet.picture(style))
            .unwrap();
    }
}
