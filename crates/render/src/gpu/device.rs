//! The device: opened once per process; creation and reading of buffers, and error handling.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock, mpsc};

use super::platform;
use crate::error::RenderError;

/// An open device. wgpu's default error handler panics; here scopes catch the errors.
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// The adapter's name.
    pub(crate) name: String,
    /// True if the adapter is known to be a driver that draws on the processor.
    is_emulated: bool,
    faults: Arc<Faults>,
}

/// The faults of a device.
#[derive(Debug, Default)]
struct Faults {
    /// The reason why it is lost, once it is.
    loss: OnceLock<String>,
    /// True if shaders of samples are refused, for tests.
    refuses: AtomicBool,
}

/// The device that a process has opened, or the reason why it has none.
type Opened = OnceLock<Result<Arc<Gpu>, String>>;

/// Returns the process's device.
///
/// # Errors
/// [`RenderError::NoGpu`] if there is no driver or no device; this is not tried again.
pub(crate) fn open() -> Result<&'static Arc<Gpu>, RenderError> {
    static GPU: Opened = OnceLock::new();
    opened(&GPU, Adapters::All)
}

/// Returns the device stored in `place`, opened on the first call.
fn opened(place: &'static Opened, adapters: Adapters) -> Result<&'static Arc<Gpu>, RenderError> {
    place
        .get_or_init(|| Gpu::find(adapters).map(Arc::new))
        .as_ref()
        .map_err(|reason| RenderError::NoGpu {
            reason: reason.clone(),
        })
}

/// The adapters that may be opened.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Adapters {
    /// All adapters, including drivers that draw on the processor.
    All,
    /// Real GPUs.
    Real,
}

impl Gpu {
    fn find(adapters: Adapters) -> Result<Self, String> {
        if adapters == Adapters::Real && !platform::may_have_gpu() {
            return Err("this machine has no GPU".to_owned());
        }
        let mut description = wgpu::InstanceDescriptor::new_without_display_handle();
        description.flags = wgpu::InstanceFlags::empty();
        // OpenGL lacks features that the passes need; if nothing else is available, the software path draws.
        description.backends = wgpu::Backends::PRIMARY;
        let instance = wgpu::Instance::new(description);
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|_| "no GPU driver was found".to_owned())?;
        let info = adapter.get_info();
        let is_emulated = info.device_type == wgpu::DeviceType::Cpu;
        if is_emulated && adapters == Adapters::Real {
            let name = info.name;
            return Err(format!("the only driver, {name}, runs on the processor"));
        }
        let offered = adapter.limits();
        // The default limits, except for buffers and textures, which may be as large as the adapter allows.
        let limits = wgpu::Limits {
            max_buffer_size: offered.max_buffer_size,
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            max_texture_dimension_2d: offered.max_texture_dimension_2d,
            ..wgpu::Limits::default()
        };
        let description = wgpu::DeviceDescriptor {
            label: Some("geotrace"),
            required_limits: limits.or_worse_values_from(&offered),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&description))
            .map_err(|error| format!("the GPU cannot be opened ({error})"))?;
        Ok(Self {
            is_emulated,
            ..Self::adopt(device, queue, info.name, || {})
        })
    }

    /// Opens a device of its own.
    ///
    /// # Errors
    /// [`RenderError::NoGpu`] if there is no driver or no device.
    pub fn open() -> Result<Self, RenderError> {
        Self::find(Adapters::All).map_err(|reason| RenderError::NoGpu { reason })
    }

    /// Destroys the device for all its users, as if it were lost.
    pub fn destroy(&self) {
        // The driver's own report of the loss may come later.
        self.faults.lose("it was destroyed");
        self.device.destroy();
    }

    /// Makes its driver refuse the shaders of samples from now on, for tests.
    pub fn refuse_samples(&self) {
        self.faults.refuses.store(true, Ordering::Relaxed);
    }

    /// Returns true if shaders of samples are to be refused.
    pub(crate) fn refuses_samples(&self) -> bool {
        self.faults.refuses.load(Ordering::Relaxed)
    }

    /// Adopts a device that another user, such as a window, has opened, with its adapter's name. From now on its loss is
    /// detected here, and reported with the next picture; `lost` is called on any thread when it is lost.
    ///
    /// Each use of it here has error scopes of its own. An error outside them belongs to another user and to no picture: for
    /// instance, a window that is resized while a picture is drawn cannot always configure its surface, and does so with its
    /// next frame.
    pub fn adopt(
        device: wgpu::Device,
        queue: wgpu::Queue,
        name: String,
        lost: impl Fn() + Send + 'static,
    ) -> Self {
        let faults = Arc::new(Faults::default());
        // The default handler panics.
        device.on_uncaptured_error(Arc::new(|_| ()));
        let kept = faults.clone();
        device.set_device_lost_callback(move |_, message| {
            kept.lose(&message);
            lost();
        });
        Self {
            device,
            queue,
            name,
            is_emulated: false,
            faults,
        }
    }

    /// Returns the process's own device, opened on the first call.
    ///
    /// # Errors
    /// [`RenderError::NoGpu`] if there is no driver or no device; this is not tried again.
    pub fn shared() -> Result<Arc<Self>, RenderError> {
        open().cloned()
    }

    /// Returns the process's device on a real GPU, opened on the first call: not a driver that draws on the processor, since
    /// the software path is faster.
    ///
    /// # Errors
    /// [`RenderError::NoGpu`] if there is none; this is not tried again.
    pub fn shared_real() -> Result<Arc<Self>, RenderError> {
        static GPU: Opened = OnceLock::new();
        opened(&GPU, Adapters::Real).cloned()
    }

    /// Returns true if it is known to be a driver that draws on the processor.
    pub fn is_emulated(&self) -> bool {
        self.is_emulated
    }

    /// Returns its adapter's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns true if the device is lost for good: it cannot draw any more.
    pub fn is_lost(&self) -> bool {
        self.faults.loss.get().is_some()
    }

    /// Runs `work` and catches all errors of the device. Returns the first of them, unless the work itself has failed.
    ///
    /// # Errors
    /// [`RenderError::Gpu`], and those of the work.
    pub(crate) fn guarded<T>(
        &self,
        work: impl FnOnce() -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        let mut found = None;
        for scope in [validation, memory, internal] {
            found = found.or(pollster::block_on(scope.pop()));
        }
        if let Some(error) = found {
            return Err(RenderError::Gpu(error.to_string()));
        }
        match (result, self.faults.loss.get()) {
            (Ok(_), Some(reason)) => Err(RenderError::Gpu(reason.clone())),
            (result, _) => result,
        }
    }

    /// Sends a small request to the device: a lost device reports the loss only on a request.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if it is lost.
    pub(crate) fn answers(&self) -> Result<(), RenderError> {
        self.guarded(|| {
            self.uniform("question", &[0_u32; 4]);
            Ok(())
        })
    }

    /// Creates a buffer with the given bytes; never empty, since a binding must not be.
    pub(crate) fn buffer(
        &self,
        label: &str,
        usage: wgpu::BufferUsages,
        bytes: &[u8],
    ) -> wgpu::Buffer {
        let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
        let size = contents.len().next_multiple_of(4) as u64;
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: true,
        });
        // A buffer that could not be created (out of memory, device lost) has no range; the error scope reports the reason.
        if let Ok(mut range) = buffer.slice(..).get_mapped_range_mut() {
            range.slice(..contents.len()).copy_from_slice(contents);
        }
        buffer.unmap();
        buffer
    }

    /// Creates a uniform buffer with one value.
    pub(crate) fn uniform<T: bytemuck::NoUninit>(&self, label: &str, value: &T) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        self.buffer(label, usage, bytemuck::bytes_of(value))
    }

    /// Creates a storage buffer with the given bytes.
    pub(crate) fn storage(&self, label: &str, bytes: &[u8]) -> wgpu::Buffer {
        self.buffer(label, wgpu::BufferUsages::STORAGE, bytes)
    }

    /// Creates a buffer that a kernel writes and that can be copied from.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device does not support buffers of this size.
    pub(crate) fn output(&self, label: &str, size: u64) -> Result<wgpu::Buffer, RenderError> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        self.check_size(label, size)?;
        Ok(self.empty(label, usage, size))
    }

    /// Refuses sizes that exceed a storage binding.
    pub(crate) fn check_size(&self, label: &str, size: u64) -> Result<(), RenderError> {
        let most = self.storage_limit();
        if size > most {
            return Err(RenderError::Gpu(format!(
                "{label} need {size} bytes, but the GPU allows {most} in one buffer"
            )));
        }
        Ok(())
    }

    /// Returns the size of the largest storage buffer.
    pub(crate) fn storage_limit(&self) -> u64 {
        let limits = self.device.limits();
        limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size)
    }

    fn empty(&self, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size.max(16).next_multiple_of(4),
            usage,
            mapped_at_creation: false,
        })
    }

    /// Waits until all submitted work is drawn.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device was lost.
    pub fn finish(&self) -> Result<(), RenderError> {
        self.wait()
    }

    /// Waits for all submitted work.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device was lost.
    pub(crate) fn wait(&self) -> Result<(), RenderError> {
        match self.device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(error) => Err(RenderError::Gpu(error.to_string())),
        }
    }

    /// Records commands and submits them.
    pub(crate) fn submit(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let mut encoder = self
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        self.queue.submit([encoder.finish()]);
    }

    /// Copies a buffer's first bytes back and passes them to `read`.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device was lost or the buffer cannot be mapped.
    pub(crate) fn read<T>(
        &self,
        buffer: &wgpu::Buffer,
        size: u64,
        read: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, RenderError> {
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let staging = self.empty("read back", usage, size);
        self.submit(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size));
        self.read_staging(&staging, read)
    }

    /// Copies a texture's rows back, and passes each to `read`, with its number, as tightly packed pixels.
    ///
    /// # Errors
    /// As [`Gpu::read`].
    pub(crate) fn read_rows(
        &self,
        texture: &wgpu::Texture,
        size: [u32; 2],
        mut read: impl FnMut(usize, &[u8]),
    ) -> Result<(), RenderError> {
        let row = 4 * size[0];
        let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let staging = self.empty("read back", usage, u64::from(stride) * u64::from(size[1]));
        let extent = wgpu::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(stride),
            rows_per_image: Some(size[1]),
        };
        self.submit(|encoder| {
            let to = wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout,
            };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), to, extent);
        });
        self.read_staging(&staging, |bytes| {
            for (y, padded) in bytes.chunks_exact(stride as usize).enumerate() {
                read(y, &padded[..row as usize]);
            }
        })
    }

    fn read_staging<T>(
        &self,
        staging: &wgpu::Buffer,
        read: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, RenderError> {
        let lost =
            |message: String| RenderError::Gpu(format!("its results cannot be read: {message}"));
        let slice = staging.slice(..);
        let (send, receive) = mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            // The receiver waits below; if it is dropped, the answer is not needed.
            let _ = send.send(result);
        });
        self.wait()?;
        // Another thread may have noticed the end of this work while waiting, and may be about to send the answer.
        match receive.recv_timeout(std::time::Duration::from_secs(60)) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(lost(error.to_string())),
            Err(_) => return Err(lost("no answer".to_owned())),
        }
        let view = slice
            .get_mapped_range()
            .map_err(|error| lost(error.to_string()))?;
        let result = read(&view);
        drop(view);
        staging.unmap();
        Ok(result)
    }
}

impl Faults {
    /// Records that the device is lost, unless this is already known.
    fn lose(&self, reason: &str) {
        let _ = self.loss.set(format!("the device was lost: {reason}"));
    }
}

impl fmt::Debug for Gpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Gpu")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}
