//! The GPU: an open adapter that records errors until they are checked, instead of panicking.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// The format of depth and stencil. The stencil makes a shadow darken each pixel once.
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth24PlusStencil8;

/// The reason why nothing can be drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GpuError {
    /// No driver offers an adapter, and why.
    NoAdapter(String),
    /// The adapter cannot be opened, and why.
    Device(String),
    /// A picture has no pixels, or more than the device can draw.
    Size {
        /// Requested width and height (px).
        asked: (u32, u32),
        /// Largest width and height (px).
        limit: u32,
    },
    /// The device was lost. Another must be opened.
    Lost,
    /// The device refused a call, and why.
    Refused(String),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter(why) => write!(
                f,
                "no graphics adapter ({why}); without a GPU, install a software adapter: `apt install mesa-vulkan-drivers` \
                 on Debian and Ubuntu, `dnf install mesa-vulkan-drivers` on Fedora"
            ),
            Self::Device(why) => write!(f, "the graphics adapter cannot be opened: {why}"),
            Self::Size { asked, limit } => write!(
                f,
                "a picture of {}x{} pixels is not possible here: each side must have 1 to {limit} pixels",
                asked.0, asked.1
            ),
            Self::Lost => f.write_str("the graphics device was lost"),
            Self::Refused(why) => write!(f, "the graphics device reported an error: {why}"),
        }
    }
}

impl std::error::Error for GpuError {}

impl GpuError {
    /// Returns the error if no driver is found, with the backends from the environment.
    #[must_use]
    pub fn no_adapter() -> Self {
        Self::NoAdapter(match std::env::var("WGPU_BACKEND") {
            Ok(backend) => format!("none for WGPU_BACKEND={backend}"),
            Err(_) => "no driver was found".into(),
        })
    }
}

/// An open device.
pub struct Gpu {
    /// The instance of the adapter, which creates surfaces.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// The queue of the device.
    pub queue: wgpu::Queue,
    lost: Arc<AtomicBool>,
    refusal: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens an adapter for offscreen pictures, as requested by the environment variables of wgpu.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if there is none, [`GpuError::Device`] if it does not open.
    pub async fn headless() -> Result<Self, GpuError> {
        let mut result = Err(GpuError::no_adapter());
        for backends in Self::backends() {
            let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
            descriptor.backends = backends;
            result = Self::open(wgpu::Instance::new(descriptor), None).await;
            if result.is_ok() {
                break;
            }
        }
        result
    }

    /// Lists the sets of backends to try in turn: those of `WGPU_BACKEND`, or else first the modern
    /// ones and then GL. GL comes last because the search for it takes time and writes to the
    /// terminal.
    #[must_use]
    pub fn backends() -> Vec<wgpu::Backends> {
        match wgpu::Backends::from_env() {
            Some(backends) => vec![backends],
            None => vec![wgpu::Backends::PRIMARY, wgpu::Backends::GL],
        }
    }

    /// Opens the adapter that suits `surface` best, or the one whose name contains
    /// `WGPU_ADAPTER_NAME`.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if there is none, [`GpuError::Device`] if it does not open.
    pub async fn open(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let adapter = match std::env::var("WGPU_ADAPTER_NAME") {
            Ok(name) => named_adapter(&instance, surface, &name).await?,
            Err(_) => instance
                .request_adapter(&wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    compatible_surface: surface,
                    ..Default::default()
                })
                .await
                .map_err(|_| GpuError::no_adapter())?,
        };
        let offered = adapter.limits();
        let mut limits = wgpu::Limits::downlevel_defaults()
            .or_worse_values_from(&offered)
            .using_resolution(offered.clone());
        // Large cloth needs the largest buffers that the adapter supports.
        limits.max_buffer_size = offered.max_buffer_size;
        limits.max_storage_buffer_binding_size = offered.max_storage_buffer_binding_size;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("a3"),
                required_limits: limits,
                memory_hints: wgpu::MemoryHints::MemoryUsage,
                ..Default::default()
            })
            .await
            .map_err(|e| GpuError::Device(one_line(&e.to_string())))?;
        let lost = Arc::new(AtomicBool::new(false));
        let flag = lost.clone();
        device.set_device_lost_callback(move |_, _| flag.store(true, Ordering::SeqCst));
        let refusal = Arc::new(Mutex::new(None));
        let note = refusal.clone();
        // Without a handler, wgpu panics at an error.
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            if let Ok(mut note) = note.lock() {
                note.get_or_insert_with(|| one_line(&e.to_string()));
            }
        }));
        Ok(Self { instance, adapter, device, queue, lost, refusal })
    }

    /// Returns the name and the backend of the adapter.
    #[must_use]
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    }

    /// Returns whether the adapter is software that runs on the processor.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Returns the largest width and height of a picture (px).
    #[must_use]
    pub fn largest_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Returns the number of samples a pixel: 4 if the adapter can multisample colour and depth,
    /// else 1.
    #[must_use]
    pub fn samples(&self, color: wgpu::TextureFormat) -> u32 {
        let flags = |format| self.adapter.get_texture_format_features(format).flags;
        let four = |format| flags(format).sample_count_supported(4);
        if four(color) && four(DEPTH) { 4 } else { 1 }
    }

    /// Polls the device, and returns the first error since the last check.
    ///
    /// # Errors
    /// [`GpuError::Lost`] if the device was lost, [`GpuError::Refused`] if it refused a call.
    pub fn check(&self) -> Result<(), GpuError> {
        // Polling fails only if the device was lost, which the flag also tells.
        let _ = self.device.poll(wgpu::PollType::Poll);
        if self.lost.load(Ordering::SeqCst) {
            return Err(GpuError::Lost);
        }
        match self.refusal.lock().ok().and_then(|mut note| note.take()) {
            Some(why) => Err(GpuError::Refused(why)),
            None => Ok(()),
        }
    }
}

/// Returns the description of a texture of a size (px), with one sample a pixel.
pub(crate) fn flat(
    label: &str,
    (width, height): (u32, u32),
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureDescriptor<'_> {
    wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(width, height),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    }
}

/// Returns the extent of a part of a texture (px).
pub(crate) fn extent(width: u32, height: u32) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

/// The first adapter whose name contains `name`, in upper or lower case.
async fn named_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    name: &str,
) -> Result<wgpu::Adapter, GpuError> {
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    adapters.retain(|adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface)));
    let names: Vec<_> = adapters.iter().map(|it| it.get_info().name).collect();
    let wanted = name.to_lowercase();
    let fits = |name: &String| name.to_lowercase().contains(&wanted);
    let found = names.iter().position(fits);
    let why = format!("WGPU_ADAPTER_NAME is {name}, but the adapters are {names:?}");
    let found = found.ok_or(GpuError::NoAdapter(why));
    found.map(|k| adapters.swap_remove(k))
}

/// Replaces all white space of a text by single spaces.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
