//! The adapter that draws to the window: how it is opened, and the formats and textures of its
//! output.

use std::sync::Arc;

use a3_render::{Gpu, GpuError, Transfer};
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

/// Returns the number of samples per pixel in the window. A software adapter gets one: at 1280 x
/// 720 on two cores, an offscreen frame takes 11 ms instead of 43. Lines are smooth even then, and
/// saved pictures always use several samples.
pub fn window_samples(gpu: &Gpu, format: wgpu::TextureFormat) -> u32 {
    if gpu.is_software() {
        1
    } else {
        gpu.samples(format)
    }
}

/// Returns the size of the window (px), clamped to the limits of the device.
pub fn clamped(gpu: &Gpu, window: &Window) -> (u32, u32) {
    let (size, limit) = (window.inner_size(), gpu.largest_side());
    (size.width.clamp(1, limit), size.height.clamp(1, limit))
}

/// Opens an adapter that can draw to the window, and its surface. Fails if there is none.
pub async fn open(
    window: Arc<Window>,
    display: OwnedDisplayHandle,
) -> Result<(Gpu, wgpu::Surface<'static>), GpuError> {
    let mut result = Err(GpuError::no_adapter());
    for backends in Gpu::backends() {
        // GL needs the display handle to present.
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

/// Chooses the format of the surface: without sRGB conversion, because text is blended in sRGB
/// values. Pictures are drawn to an sRGB view of the same texture.
pub fn choose_format(gpu: &Gpu, surface: &wgpu::Surface, config: &mut wgpu::SurfaceConfiguration) {
    use wgpu::TextureFormat::{Bgra8Unorm, Rgba8Unorm};
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    let bytes = |f: &wgpu::TextureFormat| matches!(f, Bgra8Unorm | Rgba8Unorm);
    config.format = formats.into_iter().find(bytes).unwrap_or(config.format);
    if has_two_views(gpu) {
        config.view_formats = vec![config.format.add_srgb_suffix()];
    }
}

/// Returns whether a surface can have views in two formats. On GL it cannot.
fn has_two_views(gpu: &Gpu) -> bool {
    let flags = gpu.adapter.get_downlevel_capabilities().flags;
    flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS)
}

/// Creates the texture for the picture, if the surface cannot have views in two formats.
pub fn transfer(gpu: &Gpu, config: &wgpu::SurfaceConfiguration) -> Option<Transfer> {
    let size = (config.width, config.height);
    let needed = !has_two_views(gpu) && !config.format.is_srgb();
    needed.then(|| Transfer::new(gpu, size, config.format))
}
