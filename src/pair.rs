//! Two views ready for work: their luma, where the work is done.

#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::wait;
use crate::{
    cpu,
    dense::{self, Dense, DenseConfig},
    error::{Error, Result},
    features::{self, Detector, Feature, FeatureConfig},
    gpu::{DeviceChoice, Gpu, Readback, check_limits, guarded, storage_buffer},
    image::{Luma, reduced},
    io::Picture,
    kamencay::{self, KamencayConfig},
    luma::{MAX_SIDE, Source, kernels::luma::RgbaToLuma, packed_bytes, unpack, upload},
};

/// What computes: a device, or the CPU twins.
#[derive(Debug)]
pub enum Backend {
    /// The kernels on a device.
    Gpu(Box<Gpu>),
    /// The CPU twins, which take longer and need nothing. Dense results are the same bytes.
    Cpu,
}

impl Backend {
    /// Opens what was asked for.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(choice: &DeviceChoice) -> Result<Self> {
        pollster::block_on(Self::open_async(choice))
    }

    /// As [`Backend::open`], without blocking.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub async fn open_async(choice: &DeviceChoice) -> Result<Self> {
        match choice {
            DeviceChoice::Cpu => Ok(Self::Cpu),
            _ => Ok(Self::Gpu(Box::new(Gpu::open_async(choice).await?))),
        }
    }

    /// Runs what may wait for this backend to its end.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn wait<T>(&self, work: impl Future<Output = Result<T>>) -> Result<T> {
        match self {
            Self::Gpu(gpu) => wait(&gpu.device, work),
            // The twins wait for nothing.
            Self::Cpu => pollster::block_on(work),
        }
    }

    /// The device's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Gpu(gpu) => &gpu.info.name,
            Self::Cpu => "CPU twins",
        }
    }

    /// The graphics interface it is reached by.
    pub fn api(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.info.backend.to_string(),
            Self::Cpu => "none".into(),
        }
    }

    /// The driver and its version.
    pub fn driver(&self) -> String {
        match self {
            Self::Gpu(gpu) => format!("{} {}", gpu.info.driver, gpu.info.driver_info).trim().into(),
            Self::Cpu => "none".into(),
        }
    }

    /// The interest points of one picture alone; for those of a pair there is [`Pair::features`].
    ///
    /// # Errors
    /// As [`crate::features::detect`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn features(&self, luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
        self.wait(self.features_async(luma, config))
    }

    /// As [`Backend::features`], without blocking on a device.
    ///
    /// # Errors
    /// As [`Backend::features`].
    pub async fn features_async(&self, luma: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
        match self {
            Self::Gpu(gpu) => features::detect_async(gpu, luma, config).await,
            Self::Cpu => cpu::features::detector::detect(luma, config),
        }
    }

    /// The disparities of a pair by the hybrid method, which sees the colours of the pictures.
    ///
    /// # Errors
    /// As [`kamencay::compute`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn hybrid(&self, left: &Picture, right: &Picture, config: &KamencayConfig) -> Result<Dense> {
        self.wait(self.kamencay_async(left, right, config))
    }

    /// As [`Backend::hybrid`], without blocking on a device.
    ///
    /// # Errors
    /// As [`Backend::hybrid`].
    pub async fn kamencay_async(&self, left: &Picture, right: &Picture, config: &KamencayConfig) -> Result<Dense> {
        match self {
            Self::Gpu(gpu) => kamencay::compute_async(gpu, left, right, config).await,
            Self::Cpu => cpu::kamencay::compute(left, right, config),
        }
    }
}

/// A pair of views of one size on a [`Backend`].
pub struct Pair<'b> {
    backend: &'b Backend,
    left: Luma,
    right: Luma,
    device: Option<OnDevice<'b>>,
}

struct OnDevice<'b> {
    gpu: &'b Gpu,
    left: wgpu::Buffer,
    right: wgpu::Buffer,
}

impl<'b> Pair<'b> {
    /// Brings two pictures to the backend and turns them into luma there.
    ///
    /// # Errors
    /// [`Error::SizesDiffer`]; [`Error::Unsupported`] for a limit that the device lacks; [`Error::TooLarge`],
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new(backend: &'b Backend, left: &Picture, right: &Picture) -> Result<Self> {
        backend.wait(Self::new_async(backend, left, right))
    }

    /// As [`Pair::new`], without blocking on a device.
    ///
    /// # Errors
    /// As [`Pair::new`].
    pub async fn new_async(backend: &'b Backend, left: &Picture, right: &Picture) -> Result<Self> {
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
        }
        let (width, height) = left.size();
        if width.max(height) > MAX_SIDE {
            return Err(Error::Parameter {
                name: "the picture",
                value: format!("{width}x{height} pixels"),
                expected: format!("no side may be longer than {MAX_SIDE}"),
            });
        }
        match backend {
            Backend::Cpu => Ok(Self { backend, left: left.luma(), right: right.luma(), device: None }),
            Backend::Gpu(gpu) => {
                check_limits(&gpu.device)?;
                let (left_buffer, left) = luma_on(gpu, left).await?;
                let (right_buffer, right) = luma_on(gpu, right).await?;
                let device = Some(OnDevice { gpu, left: left_buffer, right: right_buffer });
                Ok(Self { backend, left, right, device })
            }
        }
    }

    /// Left and right luma.
    pub fn views(&self) -> (&Luma, &Luma) {
        (&self.left, &self.right)
    }

    /// The pair smaller by a whole `factor`, each pixel the mean of a block.
    ///
    /// # Errors
    /// [`Error::TooLarge`], [`Error::OutOfMemory`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn reduced(&self, factor: u32) -> Result<Self> {
        self.backend.wait(self.reduced_async(factor))
    }

    /// As [`Pair::reduced`], without blocking on a device.
    ///
    /// # Errors
    /// As [`Pair::reduced`].
    pub async fn reduced_async(&self, factor: u32) -> Result<Self> {
        let (left, right) = (reduced(&self.left, factor), reduced(&self.right, factor));
        let device = match &self.device {
            None => None,
            Some(OnDevice { gpu, .. }) => {
                Some(OnDevice { gpu, left: upload(gpu, &left).await?, right: upload(gpu, &right).await? })
            }
        };
        Ok(Self { backend: self.backend, left, right, device })
    }

    /// Width and height of both views.
    pub fn size(&self) -> (u32, u32) {
        self.left.size()
    }

    /// The interest points of both views.
    ///
    /// # Errors
    /// As [`crate::features::detect`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn features(&self, config: &FeatureConfig) -> Result<[Vec<Feature>; 2]> {
        self.backend.wait(self.features_async(config))
    }

    /// As [`Pair::features`], without blocking on a device.
    ///
    /// # Errors
    /// As [`Pair::features`].
    pub async fn features_async(&self, config: &FeatureConfig) -> Result<[Vec<Feature>; 2]> {
        let Some(OnDevice { gpu, left, right }) = &self.device else {
            return Ok([
                cpu::features::detector::detect(&self.left, config)?,
                cpu::features::detector::detect(&self.right, config)?,
            ]);
        };
        let device = &gpu.device;
        let (width, height) = self.size();
        // One detector sees the views one after the other, in a buffer of its own.
        let view = guarded(device, "the picture", || storage_buffer(device, "luma", left.size())).await?;
        let detector = Detector::new_async(device, &view, width, height, config).await?;
        let detect = async |luma: &wgpu::Buffer| {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("features") });
            encoder.copy_buffer_to_buffer(luma, 0, &view, 0, None);
            detector.record(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
            detector.read_async(device, &gpu.queue).await
        };
        Ok([detect(left).await?, detect(right).await?])
    }

    /// A disparity for each pixel of the reference view.
    ///
    /// # Errors
    /// As [`dense::compute`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn dense(&self, config: &DenseConfig) -> Result<Dense> {
        self.backend.wait(self.dense_async(config))
    }

    /// As [`Pair::dense`], without blocking on a device.
    ///
    /// # Errors
    /// As [`Pair::dense`].
    pub async fn dense_async(&self, config: &DenseConfig) -> Result<Dense> {
        match &self.device {
            Some(OnDevice { gpu, left, right }) => {
                let device = &gpu.device;
                let matcher = dense::Matcher::new_async(device, self.size(), config).await?;
                let inputs = matcher.inputs_async(device, Source::Luma(left), Source::Luma(right)).await?;
                let mut encoder =
                    device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("luma") });
                inputs.record(&mut encoder);
                gpu.queue.submit([encoder.finish()]);
                matcher.run_async(gpu).await
            }
            None => cpu::dense::compute(&self.left, &self.right, config),
        }
    }
}

/// The luma of a picture, on the device and here. The colours of a large one get there in bands of rows:
/// they take four times the memory of its luma.
async fn luma_on(gpu: &Gpu, picture: &Picture) -> Result<(wgpu::Buffer, Luma)> {
    let (device, (width, height)) = (&gpu.device, picture.size());
    let row_bytes = 4 * u64::from(width);
    let rows = (device.limits().max_storage_buffer_binding_size / row_bytes).clamp(1, height.into()) as u32;
    let (luma, readback) = guarded(device, "the picture", || {
        let luma = storage_buffer(device, "luma", packed_bytes(width, height))?;
        let bands =
            (0..height).step_by(rows as usize).zip(picture.rgba().chunks((row_bytes * u64::from(rows)) as usize));
        for (first_row, pixels) in bands {
            let rgba = storage_buffer(device, "rows of the picture", pixels.len() as u64)?;
            gpu.queue.write_buffer(&rgba, 0, pixels);
            let band = RgbaToLuma::new(&device.into(), &rgba, width, rows.min(height - first_row))?;
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("luma") });
            band.record(&mut encoder);
            encoder.copy_buffer_to_buffer(band.luma(), 0, &luma, packed_bytes(width, first_row), None);
            gpu.queue.submit([encoder.finish()]);
        }
        let readback = Readback::new(device, "luma", packed_bytes(width, height));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("luma") });
        readback.record(&mut encoder, &luma);
        gpu.queue.submit([encoder.finish()]);
        Ok((luma, readback))
    })
    .await?;
    let words = readback.read((packed_bytes(width, height) / 4) as usize).await?;
    Ok((luma, unpack(width, height, &words)))
}
