//! Where the computation runs: on a GPU, or on the CPU twins.

#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    cpu,
    dense::Dense,
    error::Result,
    features::{self, Detected, FeatureConfig},
    gpu::{DeviceChoice, Gpu},
    image::Luma,
    io::Picture,
    kamencay::{self, KamencayConfig},
};

/// Where the computation runs: on a GPU, or on the CPU twins.
#[derive(Clone, Debug)]
pub enum Backend {
    /// The kernels, on a device.
    Gpu(Gpu),
    /// The CPU twins: slower, but without any device. Dense results are bit for bit those of the kernels.
    Cpu,
}

impl Backend {
    /// Opens the backend of `choice`.
    ///
    /// # Errors
    /// See [`Gpu::open`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(choice: &DeviceChoice) -> Result<Self> {
        block_on(Self::open_async(choice))
    }

    /// The asynchronous [`Backend::open`].
    ///
    /// # Errors
    /// See [`Gpu::open`].
    pub async fn open_async(choice: &DeviceChoice) -> Result<Self> {
        match choice {
            DeviceChoice::Cpu => Ok(Self::Cpu),
            _ => Ok(Self::Gpu(Gpu::open_async(choice).await?)),
        }
    }

    /// The device's name.
    pub fn name(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.info().name,
            Self::Cpu => "CPU twins".into(),
        }
    }

    /// The graphics API of the device, or "none".
    pub fn api(&self) -> String {
        match self {
            Self::Gpu(gpu) => gpu.info().backend.to_string(),
            Self::Cpu => "none".into(),
        }
    }

    /// The driver and its version, or "none".
    pub fn driver(&self) -> String {
        match self {
            Self::Gpu(gpu) => {
                let info = gpu.info();
                format!("{} {}", info.driver, info.driver_info).trim().into()
            }
            Self::Cpu => "none".into(),
        }
    }

    /// The interest points of a single picture; see [`crate::pair::Pair::features`] for both views of a pair.
    ///
    /// # Errors
    /// See [`crate::features::detect`].
    pub async fn features(&self, luma: &Luma, config: &FeatureConfig) -> Result<Detected> {
        match self {
            Self::Gpu(gpu) => features::detect(gpu, luma, config).await,
            Self::Cpu => cpu::features::detector::detect(luma, config),
        }
    }

    /// The disparity map of a pair by Kamencay's method, which uses the colours of the pictures.
    ///
    /// # Errors
    /// See [`kamencay::compute`].
    pub async fn kamencay(&self, left: &Picture, right: &Picture, config: &KamencayConfig) -> Result<Dense> {
        match self {
            Self::Gpu(gpu) => kamencay::compute(gpu, left, right, config).await,
            Self::Cpu => cpu::kamencay::compute(left, right, config),
        }
    }
}
