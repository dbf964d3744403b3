//! Opens an adapter, and keeps what it complains about instead of panicking.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use crate::targets::DEPTH;

/// Why nothing can be drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GpuError {
    /// No driver offers an adapter.
    NoAdapter(String),
    /// The adapter does not open.
    Device(String),
    /// A picture of this size is beyond the device's limit.
    Size {
        /// What was asked for (px).
        asked: (u32, u32),
        /// The most it can (px).
        limit: u32,
    },
    /// The device is gone: open another.
    Lost,
    /// The device refused something.
    Refused(String),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter(why) => write!(
                f,
                "no graphics adapter ({why}); without a GPU a software one will do: `apt install mesa-vulkan-drivers` \
                 on Debian and Ubuntu, `dnf install mesa-vulkan-drivers` on Fedora"
            ),
            Self::Device(why) => write!(f, "the graphics adapter does not open: {why}"),
            Self::Size {
                asked: (w, h),
                limit,
            } => {
                write!(
                    f,
                    "a picture of {w}x{h} pixels is not possible here: each side has 1 to {limit}"
                )
            }
            Self::Lost => f.write_str("the graphics device was lost"),
            Self::Refused(why) => write!(f, "the graphics device refused: {why}"),
        }
    }
}

impl std::error::Error for GpuError {}

impl GpuError {
    /// No driver answered, perhaps because the environment names backends that are not there.
    #[must_use]
    pub fn no_adapter() -> Self {
        Self::NoAdapter(match std::env::var("WGPU_BACKEND") {
            Ok(backend) => format!("none for WGPU_BACKEND={backend}"),
            Err(_) => "no driver answers".into(),
        })
    }
}

/// An open device.
pub struct Gpu {
    /// Where the adapter came from; surfaces are made of it.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    lost: Arc<AtomicBool>,
    refusal: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens an adapter for offscreen pictures. `WGPU_BACKEND` and the like are honoured.
    ///
    /// # Errors
    /// There is no adapter, or it does not open.
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

    /// The backends to try, one set after the other: those of `WGPU_BACKEND`, or the modern ones and then GL, whose
    /// mere probing takes time and writes to the terminal.
    #[must_use]
    pub fn backends() -> Vec<wgpu::Backends> {
        match wgpu::Backends::from_env() {
            Some(backends) => vec![backends],
            None => vec![wgpu::Backends::PRIMARY, wgpu::Backends::GL],
        }
    }

    /// Opens the adapter that suits `surface` best, or the one whose name contains `WGPU_ADAPTER_NAME`.
    ///
    /// # Errors
    /// There is no adapter, or it does not open.
    pub async fn open(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let adapter = match std::env::var("WGPU_ADAPTER_NAME") {
            Ok(name) => named_adapter(&instance, surface, &name).await?,
            Err(_) => instance
                .request_adapter(&wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    force_fallback_adapter: false,
                    compatible_surface: surface,
                    apply_limit_buckets: false,
                })
                .await
                .map_err(|_| GpuError::no_adapter())?,
        };
        let offered = adapter.limits();
        let mut limits = wgpu::Limits::downlevel_defaults()
            .or_worse_values_from(&offered)
            .using_resolution(offered.clone());
        // Large cloth: as much in one buffer as the adapter gives.
        limits.max_buffer_size = offered.max_buffer_size;
        limits.max_storage_buffer_binding_size = offered.max_storage_buffer_binding_size;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("a3"),
                required_features: wgpu::Features::empty(),
                required_limits: limits,
                experimental_features: wgpu::ExperimentalFeatures::disabled(),
                memory_hints: wgpu::MemoryHints::MemoryUsage,
                trace: wgpu::Trace::Off,
            })
            .await
            .map_err(|e| GpuError::Device(one_line(&e.to_string())))?;
        let lost = Arc::new(AtomicBool::new(false));
        let flag = lost.clone();
        device.set_device_lost_callback(move |_, _| flag.store(true, Ordering::SeqCst));
        let refusal = Arc::new(Mutex::new(None));
        let note = refusal.clone();
        // Without a handler, wgpu panics.
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            if let Ok(mut note) = note.lock() {
                note.get_or_insert_with(|| one_line(&e.to_string()));
            }
        }));
        Ok(Self {
            instance,
            adapter,
            device,
            queue,
            lost,
            refusal,
        })
    }

    /// Name and backend of the adapter.
    #[must_use]
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    }

    /// Whether the adapter is a program rather than a chip.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// The longest side of a picture (px).
    #[must_use]
    pub fn largest_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// 4 where colour and depth can be drawn with as many samples, else 1.
    #[must_use]
    pub fn samples(&self, color: wgpu::TextureFormat) -> u32 {
        let four = |format| {
            self.adapter
                .get_texture_format_features(format)
                .flags
                .sample_count_supported(4)
        };
        if four(color) && four(DEPTH) { 4 } else { 1 }
    }

    /// What went wrong since the last look, if anything. Looks at the device, which tells of its loss only when asked.
    ///
    /// # Errors
    /// [`GpuError::Lost`], or the first thing it refused.
    pub fn check(&self) -> Result<(), GpuError> {
        // An error of poll is the loss of the device, which the flag tells too.
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

async fn named_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    name: &str,
) -> Result<wgpu::Adapter, GpuError> {
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    adapters.retain(|adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface)));
    let names: Vec<_> = adapters
        .iter()
        .map(|adapter| adapter.get_info().name)
        .collect();
    let fits = |adapter: &wgpu::Adapter| {
        adapter
            .get_info()
            .name
            .to_lowercase()
            .contains(&name.to_lowercase())
    };
    adapters.into_iter().find(fits).ok_or_else(|| {
        GpuError::NoAdapter(format!(
            "WGPU_ADAPTER_NAME is {name}, and there are {names:?}"
        ))
    })
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
