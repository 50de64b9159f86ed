//! A pair of views as luma, on the backend that matches them.

use crate::{
    backend::Backend,
    cpu,
    dense::{Dense, DenseConfig, compute_uploaded},
    error::{Error, Result, check},
    features::{Detected, Detector, FeatureConfig},
    gpu::{Gpu, Readback, check_limits, guarded, storage_buffer},
    image::{Luma, Size, reduced},
    io::Picture,
    luma::{check_size, kernels::luma::RgbaToLuma, packed_bytes, unpack, upload},
    rectify::{WarpMap, warp},
};

/// A pair of views of one size on a [`Backend`].
#[derive(Debug)]
pub struct Pair<'b> {
    backend: &'b Backend,
    left: Luma,
    right: Luma,
    device: Option<OnDevice<'b>>,
}

/// Packed luma of both views on a device.
#[derive(Debug)]
struct OnDevice<'b> {
    gpu: &'b Gpu,
    luma: [wgpu::Buffer; 2],
}

impl<'b> Pair<'b> {
    /// Uploads two pictures to the backend and converts them to luma there.
    ///
    /// # Errors
    /// [`Error::SizesDiffer`]; [`Error::Unsupported`] if the device lacks a limit; [`Error::TooLarge`],
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub async fn new(backend: &'b Backend, left: &Picture, right: &Picture) -> Result<Self> {
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
        }
        check_size(left.size())?;
        match backend {
            Backend::Cpu => Ok(Self { backend, left: left.luma(), right: right.luma(), device: None }),
            Backend::Gpu(gpu) => {
                check_limits(gpu)?;
                let (left_buffer, left) = luma_on(gpu, left).await?;
                let (right_buffer, right) = luma_on(gpu, right).await?;
                let device = Some(OnDevice { gpu, luma: [left_buffer, right_buffer] });
                Ok(Self { backend, left, right, device })
            }
        }
    }

    /// What the pair is matched on.
    pub(crate) fn backend(&self) -> &'b Backend {
        self.backend
    }

    /// Left and right luma.
    pub fn views(&self) -> (&Luma, &Luma) {
        (&self.left, &self.right)
    }

    /// Downscales the pair by an integer `factor`: each pixel is the mean of a block.
    ///
    /// # Errors
    /// [`Error::TooLarge`], [`Error::OutOfMemory`].
    pub async fn reduced(&self, factor: u32) -> Result<Self> {
        let (left, right) = (reduced(&self.left, factor), reduced(&self.right, factor));
        let device = match &self.device {
            None => None,
            Some(OnDevice { gpu, .. }) => {
                Some(OnDevice { gpu, luma: [upload(gpu, &left).await?, upload(gpu, &right).await?] })
            }
        };
        Ok(Self { backend: self.backend, left, right, device })
    }

    /// The pair with other views of its size in place of those that are given.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) async fn with_views(mut self, views: [Option<Luma>; 2]) -> Result<Self> {
        for ((view, own), side) in views.into_iter().zip([&mut self.left, &mut self.right]).zip(0..) {
            let Some(view) = view else { continue };
            if let Some(OnDevice { gpu, luma }) = &mut self.device {
                luma[side] = upload(gpu, &view).await?;
            }
            *own = view;
        }
        Ok(self)
    }

    /// The pair with its right view resampled by `map`; the left view stays. The same bytes on every backend.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless both sizes of the map are that of the pair; [`Error::TooLarge`], [`Error::OutOfMemory`],
    /// [`Error::DeviceLost`].
    pub async fn with_right_warped(&self, map: &WarpMap) -> Result<Self> {
        let size = self.size();
        check(
            [map.size(), map.source_size()] == [size; 2],
            "the map",
            format_args!("for {} pixels from a source of {}", map.size(), map.source_size()),
            format!("the views have {size}: both sizes of the map must be {size}"),
        )?;
        let (right, device) = match &self.device {
            None => (cpu::rectify::warp(&self.right, map), None),
            Some(OnDevice { gpu, luma: [left, right] }) => {
                let (right_buffer, right) = warp(gpu, right, map).await?;
                (right, Some(OnDevice { gpu, luma: [left.clone(), right_buffer] }))
            }
        };
        Ok(Self { backend: self.backend, left: self.left.clone(), right, device })
    }

    /// Width and height of both views, in pixels.
    pub fn size(&self) -> Size {
        self.left.size()
    }

    /// The interest points of both views.
    ///
    /// # Errors
    /// See [`crate::features::detect`].
    pub async fn features(&self, config: &FeatureConfig) -> Result<[Detected; 2]> {
        let Some(OnDevice { gpu, luma: [left, right] }) = &self.device else {
            let detect = |view| cpu::features::detector::detect(view, config);
            return Ok([detect(&self.left)?, detect(&self.right)?]);
        };
        let detector = Detector::new(gpu, self.size(), config).await?;
        Ok([detector.detect(left).await?, detector.detect(right).await?])
    }

    /// Dense matching: a disparity and a confidence for each pixel of the reference view.
    ///
    /// # Errors
    /// See [`crate::dense::compute`].
    pub async fn dense(&self, config: &DenseConfig) -> Result<Dense> {
        self.dense_with_progress(config, |_| ()).await
    }

    /// [`Self::dense`] with calls of `progress` with the share of the work that a device has done, 0 to 1.
    pub(crate) async fn dense_with_progress(&self, config: &DenseConfig, progress: impl FnMut(f32)) -> Result<Dense> {
        match &self.device {
            Some(OnDevice { gpu, luma }) => compute_uploaded(gpu, self.size(), config, luma.clone(), progress).await,
            None => cpu::dense::compute(&self.left, &self.right, config),
        }
    }
}

/// Converts a picture to luma, on the device and on the host. Large pictures are uploaded in bands of rows, since
/// colours take four times the memory of luma.
async fn luma_on(gpu: &Gpu, picture: &Picture) -> Result<(wgpu::Buffer, Luma)> {
    let Size { width, height } = picture.size();
    let row_bytes = 4 * u64::from(width);
    let rows = (gpu.device.limits().max_storage_buffer_binding_size / row_bytes).clamp(1, height.into()) as u32;
    let (luma, readback) = guarded(gpu, "the picture", || {
        let kernel = RgbaToLuma::new(gpu);
        let luma = storage_buffer(gpu, "luma", packed_bytes((width, height)))?;
        let bands =
            (0..height).step_by(rows as usize).zip(picture.rgba().chunks((row_bytes * u64::from(rows)) as usize));
        for (first_row, pixels) in bands {
            let rows = rows.min(height - first_row);
            let rgba = storage_buffer(gpu, "rows of the picture", pixels.len() as u64)?;
            gpu.queue.write_buffer(&rgba, 0, pixels);
            let band = storage_buffer(gpu, "luma of a band", packed_bytes((width, rows)))?;
            let mut encoder = gpu.encoder("luma");
            kernel.prepare(Size::new(width, rows), &rgba, &band).record(&mut encoder);
            encoder.copy_buffer_to_buffer(&band, 0, &luma, packed_bytes((width, first_row)), None);
            gpu.queue.submit([encoder.finish()]);
        }
        let readback = Readback::new(gpu, "luma", packed_bytes((width, height)));
        let mut encoder = gpu.encoder("luma");
        readback.record(&mut encoder, &luma);
        gpu.queue.submit([encoder.finish()]);
        Ok((luma, readback))
    })
    .await?;
    let words = readback.read((packed_bytes((width, height)) / 4) as usize).await?;
    Ok((luma, unpack((width, height), &words)))
}
