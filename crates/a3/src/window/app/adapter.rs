//! The adapter that draws to the window: how it is opened, and what it draws to.

use std::sync::Arc;

use a3_render::{Gpu, GpuError, Transfer};
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

/// Samples of a pixel in the window. A software adapter gets one: at 1280 x 720 on two cores a
/// frame takes 11 ms offscreen instead of 43. Lines have smooth edges all the same, and saved
/// pictures have them everywhere.
pub fn window_samples(gpu: &Gpu, format: wgpu::TextureFormat) -> u32 {
    if gpu.is_software() {
        1
    } else {
        gpu.samples(format)
    }
}

/// The size of the window (px) within the limits of the device.
pub fn clamped(gpu: &Gpu, window: &Window) -> (u32, u32) {
    let (size, limit) = (window.inner_size(), gpu.largest_side());
    (size.width.clamp(1, limit), size.height.clamp(1, limit))
}

/// Opens an adapter that can draw to the window.
pub async fn open(
    window: Arc<Window>,
    display: OwnedDisplayHandle,
) -> Result<(Gpu, wgpu::Surface<'static>), GpuError> {
    let mut result = Err(GpuError::no_adapter());
    for backends in Gpu::backends() {
        // GL needs the display's handle to present.
        let mut descriptor =
            wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display.clone()));
        descriptor.backends = backends;
        let instance = wgpu::Instance::new(descriptor);
        let Ok(surface) = instance.create_surface(window.clone()) else {
            continue;
        };
        result = Gpu::open(instance, Some(&surface))
            .await
            .map(|gpu| (gpu, surface));
        if result.is_ok() {
            break;
        }
    }
    result
}

/// Chooses the format of the surface: bytes that are blended as they are, for text. Pictures are
/// drawn to the sRGB format of the same bytes.
pub fn choose_format(gpu: &Gpu, surface: &wgpu::Surface, config: &mut wgpu::SurfaceConfiguration) {
    use wgpu::TextureFormat::{Bgra8Unorm, Rgba8Unorm};
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    let bytes = |f: &wgpu::TextureFormat| matches!(f, Bgra8Unorm | Rgba8Unorm);
    config.format = formats.into_iter().find(bytes).unwrap_or(config.format);
    if has_two_views(gpu) {
        config.view_formats = vec![config.format.add_srgb_suffix()];
    }
}

/// Whether a surface can be seen in two formats. On GL it cannot.
fn has_two_views(gpu: &Gpu) -> bool {
    let flags = gpu.adapter.get_downlevel_capabilities().flags;
    flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS)
}

/// What is drawn into where the surface cannot be seen in two formats.
pub fn transfer(gpu: &Gpu, config: &wgpu::SurfaceConfiguration) -> Option<Transfer> {
    let size = (config.width, config.height);
    let needed = !has_two_views(gpu) && !config.format.is_srgb();
    needed.then(|| Transfer::new(gpu, size, config.format))
}
