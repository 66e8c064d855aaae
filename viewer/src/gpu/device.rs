//! The device that draws, without a window: a GPU, or Mesa's rasteriser on the processor.

use ode_visual_hull::{Error, Result};
use pollster::block_on;
use std::fmt::Display;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How long one picture may take before the device counts as lost. Software rasterisers take a tenth of a second.
const PATIENCE: Duration = Duration::from_secs(60);

/// A device that draws pictures. It lives longer than the scenes that are drawn with it; clones are the same device.
#[derive(Debug, Clone)]
pub struct Device {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    failure: Arc<Mutex<Failure>>,
    /// Held while a renderer works: with OpenGL, wgpu panics on a thread that has waited for another for a second.
    turn: Arc<Mutex<()>>,
}

/// What went wrong on a device, as its callbacks report it.
#[derive(Debug, Default)]
struct Failure {
    /// Why the device is lost, which it stays.
    lost: Option<String>,
    /// The first error since the last check.
    error: Option<String>,
}

impl Device {
    /// The best device: a GPU if there is one, else a rasteriser on the processor.
    ///
    /// # Errors
    /// There is none, or it cannot be opened.
    pub fn new() -> Result<Self> {
        let mut description = wgpu::InstanceDescriptor::new_without_display_handle();
        description.backends = wgpu::Backends::VULKAN | wgpu::Backends::GL;
        let instance = wgpu::Instance::new(description);
        let adapters = block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        let Some(adapter) = adapters.iter().min_by_key(|adapter| rank(&adapter.get_info())) else {
            return Err(Error::argument(
                "device: expected a GPU or a software rasteriser, found no adapter of Vulkan or OpenGL; install Mesa (Debian's \
                 packages libegl1 and libgl1-mesa-dri, or mesa-vulkan-drivers), or draw without one (--renderer cpu)",
            ));
        };
        Self::open(adapter)
    }

    fn open(adapter: &wgpu::Adapter) -> Result<Self> {
        let info = adapter.get_info();
        let found = adapter.limits();
        // Nothing but the size of textures exceeds what WebGL 2 promises, so that old and small devices draw as well.
        let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(found.clone());
        let description = wgpu::DeviceDescriptor {
            label: Some("viewer"),
            required_limits: limits.or_worse_values_from(&found),
            ..Default::default()
        };
        let (device, queue) = block_on(adapter.request_device(&description)).map_err(|found| {
            Error::argument(format!(
                "device: expected to open {}, found: {found}; update its driver, or draw without it (--renderer cpu)",
                info.name
            ))
        })?;

        // Without these wgpu panics at the first error.
        let failure = Arc::new(Mutex::new(Failure::default()));
        let (on_loss, on_error) = (Arc::clone(&failure), Arc::clone(&failure));
        device.set_device_lost_callback(move |reason, message| {
            locked(&on_loss).lost.get_or_insert_with(|| format!("{reason:?}: {message}"));
        });
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            locked(&on_error).error.get_or_insert_with(|| error.to_string());
        }));
        Ok(Self { device, queue, info, failure, turn: Arc::default() })
    }

    /// Its name, for messages: that of the GPU or rasteriser, and the interface by which it is reached.
    pub fn name(&self) -> String {
        format!("{} ({})", self.info.name, self.info.backend)
    }

    /// Whether pictures are drawn by the processor, much slower than by a GPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Gives the device up, as a driver that fails does: whatever is drawn with it from now on is an error.
    pub fn destroy(&self) {
        self.device.destroy();
        locked(&self.failure).lost.get_or_insert_with(|| "it was destroyed".to_owned());
    }

    pub(super) fn raw(&self) -> &wgpu::Device {
        &self.device
    }

    pub(super) fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Waits until no other renderer works with the device.
    pub(super) fn turn(&self) -> MutexGuard<'_, ()> {
        locked(&self.turn)
    }

    /// An error if anything has gone wrong since the last check.
    pub(super) fn check(&self) -> Result<()> {
        let mut failure = locked(&self.failure);
        if let Some(why) = &failure.lost {
            return Err(self.failed(format!(
                "expected it to draw, found it lost ({why}); open it again, or draw without it (--renderer cpu)"
            )));
        }
        match failure.error.take() {
            Some(why) => Err(self.failed(format!(
                "expected it to draw, found: {why}; draw smaller pictures or without it (--renderer cpu), and report this"
            ))),
            None => Ok(()),
        }
    }

    /// Waits until all that was submitted is done.
    pub(super) fn wait(&self) -> Result<()> {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        let waited = self.device.poll(wait);
        self.check()?;
        waited.map(drop).map_err(|found| {
            self.failed(format!(
                "expected a picture within {} s, found: {found}; draw without it (--renderer cpu)",
                PATIENCE.as_secs()
            ))
        })
    }

    /// An error of this device.
    pub(super) fn failed(&self, problem: impl Display) -> Error {
        Error::argument(format!("device {}: {problem}", self.name()))
    }
}

/// The better an adapter, the lower: GPUs before processors, Vulkan before OpenGL.
fn rank(info: &wgpu::AdapterInfo) -> (u32, bool) {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        // OpenGL does not always tell.
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    (kind, info.backend != wgpu::Backend::Vulkan)
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
