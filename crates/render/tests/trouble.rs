//! Failures are errors, never panics.

mod common;

use a3_render::{Gpu, GpuError, OFFSCREEN_FORMAT, Offscreen, Renderer, Style};
use common::{Sheet, gpu, renderer};

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
            let pixels = offscreen.render(&gpu, &mut renderer, &sheet.picture(style));
            assert_eq!(pixels.unwrap().len(), 33 * 17 * 4);
        }
    }
    gpu.check().unwrap();
}

#[test]
fn impossible_sizes_are_refused() {
    let gpu = noop();
    let limit = gpu.largest_side();
    let most = (u32::MAX, u32::MAX);
    for asked in [(0, 5), (5, 0), (limit + 1, 5), (5, limit + 1), most] {
        let refused = Offscreen::new(&gpu, asked).err().unwrap();
        assert_eq!(refused, GpuError::Size { asked, limit });
        assert!(refused.to_string().contains(&limit.to_string()));
    }
}

#[test]
fn a_validation_error_is_reported() {
    let gpu = noop();
    gpu.check().unwrap();
    // A depth format is not a colour format.
    let depth = wgpu::TextureFormat::Depth32Float;
    let _ = Renderer::new(&gpu, depth, 1, &Sheet::new().topology);
    let Err(GpuError::Refused(why)) = gpu.check() else { panic!("not reported") };
    assert!(!why.contains('\n'), "{why}");
    gpu.check().unwrap();
}

#[test]
fn a_lost_device_is_reported_and_another_can_be_opened() {
    let Some(mut device) = gpu() else { return };
    let sheet = Sheet::new();
    for _ in 0..3 {
        let mut renderer = renderer(&device, &sheet.topology);
        let offscreen = Offscreen::new(&device, (64, 64)).unwrap();
        let picture = sheet.picture(Style::Shaded);
        offscreen.render(&device, &mut renderer, &picture).unwrap();
        device.device.destroy();
        let lost = offscreen.render(&device, &mut renderer, &picture);
        assert_eq!(lost, Err(GpuError::Lost));
        device = gpu().unwrap();
    }
}

/// Drawing nothing is no error.
#[test]
fn an_empty_picture() {
    let gpu = noop();
    let sheet = Sheet::empty([0.0, 0.0, 4.0], [0.0; 3]);
    for style in [Style::Shaded, Style::Wireframe] {
        common::draw(&gpu, (8, 8), &sheet.topology, sheet.picture(style));
    }
}
