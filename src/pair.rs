//! A pair of views as luma, on the backend that matches them.

use crate::{
    backend::Backend,
    cpu,
    dense::{Dense, DenseConfig, Masks, Seen, UploadedPair, View, compute_uploaded},
    error::{Error, Result, check},
    features::{Detected, FeatureConfig, detect_both},
    gpu::{Gpu, Readback, check_limits, storage_buffer},
    image::{Luma, Size, reduced},
    io::Picture,
    luma::{Colours, check_size, kernels::luma::RgbaToLuma, packed_bytes, unpack, upload},
    rectify::{WarpMap, warp},
};

/// A pair of views of one size on a [`Backend`].
#[derive(Debug)]
pub struct Pair<'b> {
    backend: &'b Backend,
    left: Luma,
    right: Luma,
    /// The pictures of either view on the host, without a device and unless other views took their place.
    pictures: [Option<&'b Picture>; 2],
    device: Option<OnDevice<'b>>,
}

/// Packed luma of both views on a device.
#[derive(Debug)]
struct OnDevice<'b> {
    gpu: &'b Gpu,
    luma: [wgpu::Buffer; 2],
    /// The colours of either view, unless other views took their place.
    colours: [Option<Colours>; 2],
}

impl<'b> Pair<'b> {
    /// Uploads two pictures to the backend and converts them to luma there.
    ///
    /// # Errors
    /// [`Error::SizesDiffer`]; [`Error::Unsupported`] if the device lacks a limit; [`Error::TooLarge`],
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub async fn new(backend: &'b Backend, left: &'b Picture, right: &'b Picture) -> Result<Self> {
        Self::with_colours(backend, [left, right], [true; 2]).await
    }

    /// [`Self::new`], with the colours of the views that are `coloured` only: colours take four times the memory of luma.
    pub(crate) async fn with_colours(
        backend: &'b Backend,
        [left, right]: [&'b Picture; 2],
        coloured: [bool; 2],
    ) -> Result<Self> {
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
        }
        check_size(left.size())?;
        match backend {
            Backend::Cpu => {
                let pictures = [(left, coloured[0]), (right, coloured[1])].map(|(view, kept)| kept.then_some(view));
                Ok(Self { backend, left: left.luma(), right: right.luma(), pictures, device: None })
            }
            Backend::Gpu(gpu) => {
                check_limits(gpu)?;
                let (left_buffer, left_colours, left) = luma_on(gpu, left).await?;
                let (right_buffer, right_colours, right) = luma_on(gpu, right).await?;
                let colours = [(left_colours, coloured[0]), (right_colours, coloured[1])];
                let colours = colours.map(|(colours, kept)| kept.then_some(colours));
                let device = Some(OnDevice { gpu, luma: [left_buffer, right_buffer], colours });
                Ok(Self { backend, left, right, pictures: [None, None], device })
            }
        }
    }

    /// Views of one size of which luma is known, and the pictures of those that have colours.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) async fn with_known_luma(
        backend: &'b Backend,
        [left, right]: [Luma; 2],
        pictures: [Option<&'b Picture>; 2],
    ) -> Result<Self> {
        let Backend::Gpu(gpu) = backend else {
            return Ok(Self { backend, left, right, pictures, device: None });
        };
        check_limits(gpu)?;
        let luma = [upload(gpu, &left).await?, upload(gpu, &right).await?];
        let uploaded = |picture: &Picture| -> Result<Colours> {
            let colours = Colours::new(gpu, picture.size())?;
            colours.write(gpu, picture);
            Ok(colours)
        };
        let [left_colours, right_colours] = pictures;
        let colours = gpu.with_room("the picture", || {
            Ok([left_colours.map(uploaded).transpose()?, right_colours.map(uploaded).transpose()?])
        });
        let device = Some(OnDevice { gpu, luma, colours: colours.await? });
        Ok(Self { backend, left, right, pictures: [None, None], device })
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
                let luma = [upload(gpu, &left).await?, upload(gpu, &right).await?];
                Some(OnDevice { gpu, luma, colours: [None, None] })
            }
        };
        Ok(Self { backend: self.backend, left, right, pictures: [None, None], device })
    }

    /// The pair with other views of its size in place of those that are given; other views have no colours.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) async fn with_views(mut self, views: [Option<Luma>; 2]) -> Result<Self> {
        for (side, _) in (0..).zip(&views).filter(|(_, view)| view.is_some()) {
            self.pictures[side] = None;
            if let Some(OnDevice { colours, .. }) = &mut self.device {
                colours[side] = None;
            }
        }
        self.with_luma(views).await
    }

    /// The pair with other luma in place of that of the views that are given; their colours stay.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) async fn with_luma(mut self, views: [Option<Luma>; 2]) -> Result<Self> {
        for ((view, own), side) in views.into_iter().zip([&mut self.left, &mut self.right]).zip(0..) {
            let Some(view) = view else { continue };
            if let Some(OnDevice { gpu, luma, .. }) = &mut self.device {
                luma[side] = upload(gpu, &view).await?;
            }
            *own = view;
        }
        Ok(self)
    }

    /// The pair with its right view resampled by `map`, without colours; the left view stays. The same bytes on every
    /// backend.
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
            Some(OnDevice { gpu, luma: [left, right], colours }) => {
                let (right_buffer, right) = warp(gpu, right, map).await?;
                let colours = [colours[0].clone(), None];
                (right, Some(OnDevice { gpu, luma: [left.clone(), right_buffer], colours }))
            }
        };
        let pictures = [self.pictures[0], None];
        Ok(Self { backend: self.backend, left: self.left.clone(), right, pictures, device })
    }

    /// The pair with `source` resampled by `map`, without colours, in place of its right view; the left view stays. The same bytes on
    /// every backend.
    ///
    /// # Errors
    /// [`Error::TooLarge`], [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub(crate) async fn with_right_from(mut self, source: &Luma, map: &WarpMap) -> Result<Self> {
        debug_assert_eq!((map.size(), map.source_size()), (self.size(), source.size()));
        match &mut self.device {
            None => self.right = cpu::rectify::warp(source, map),
            Some(OnDevice { gpu, luma: [_, right], colours: [_, colours] }) => {
                (*right, self.right) = warp(gpu, &upload(gpu, source).await?, map).await?;
                *colours = None;
            }
        }
        self.pictures[1] = None;
        Ok(self)
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
        let Some(OnDevice { gpu, luma: [left, right], .. }) = &self.device else {
            let detect = |view| cpu::features::detector::detect(view, config);
            return Ok([detect(&self.left)?, detect(&self.right)?]);
        };
        detect_both(gpu, self.size(), config, [left, right]).await
    }

    /// Dense matching: a disparity and a confidence for each pixel of the reference view. Holes are filled by the colours of
    /// its picture.
    ///
    /// # Errors
    /// See [`crate::dense::compute`].
    pub async fn dense(&self, config: &DenseConfig) -> Result<Dense> {
        self.dense_seen(config, None, |_| ()).await
    }

    /// [`Self::dense`], where only pixels that show the scene, near those whose partner may, take part in the refinement. Calls `progress` with the share of the
    /// work that a device has done, 0 to 1.
    pub(crate) async fn dense_seen(
        &self,
        config: &DenseConfig,
        seen: Option<Seen<'_>>,
        progress: impl FnMut(f32),
    ) -> Result<Dense> {
        let reference = usize::from(config.reference == View::Right);
        let views = [&self.left, &self.right];
        let own = seen.and_then(|seen| seen.near_partners(config.reference, config.range));
        let seen = seen.map(|seen| Seen { masks: [own.as_ref().or(seen.masks[0]), seen.masks[1]], ..seen });
        if let Some(OnDevice { gpu, luma, colours }) = &self.device {
            let masks = match seen {
                Some(seen) => Some(gpu.with_room("the masks", || Masks::new(gpu, self.size(), seen)).await?),
                None => None,
            };
            let pair = UploadedPair { luma: luma.clone(), colours: colours[reference].clone(), masks };
            return compute_uploaded(gpu, self.size(), config, pair, progress).await;
        }
        cpu::dense::compute_seen(views, self.pictures[reference], seen, config)
    }
}

/// Uploads a picture, and converts it to luma, on the device and on the host.
async fn luma_on(gpu: &Gpu, picture: &Picture) -> Result<(wgpu::Buffer, Colours, Luma)> {
    let Size { width, height } = picture.size();
    let (luma, colours, readback) = gpu
        .with_room("the picture", || {
            let kernel = RgbaToLuma::new(gpu);
            let luma = storage_buffer(gpu, "luma", packed_bytes((width, height)))?;
            let colours = Colours::new(gpu, picture.size())?;
            colours.write(gpu, picture);
            for (first_row, size, rgba) in colours.bands() {
                let band = storage_buffer(gpu, "luma of a band", packed_bytes(size))?;
                let mut encoder = gpu.encoder("luma");
                kernel.prepare(size, rgba, &band).record(&mut encoder);
                encoder.copy_buffer_to_buffer(&band, 0, &luma, packed_bytes((width, first_row)), None);
                gpu.queue.submit([encoder.finish()]);
            }
            let readback = Readback::new(gpu, "luma", packed_bytes((width, height)));
            let mut encoder = gpu.encoder("luma");
            readback.record(&mut encoder, &luma);
            gpu.queue.submit([encoder.finish()]);
            Ok((luma, colours, readback))
        })
        .await?;
    let words = readback.read((packed_bytes((width, height)) / 4) as usize).await?;
    Ok((luma, colours, unpack((width, height), &words)))
}
