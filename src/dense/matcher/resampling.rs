//! The resampling of both views, before they are matched.

use crate::{
    dense::{
        colours::ReferenceColours,
        config::View,
        kernels::Loss,
        seen::Seen,
        uploaded::{Masks, UploadedPair},
    },
    disparity::DisparityRange,
    error::Result,
    gpu::{Dispatch, Gpu, storage_buffer},
    image::{Plane, Size},
    luma::{Colours, packed_bytes},
    rectify::{UploadedMap, WarpMap},
};

/// What resamples the views of a matcher, and its memory.
#[derive(Debug)]
pub(super) struct Resampling {
    /// Width and height of the left and of the right view as they were taken.
    sizes: [Size; 2],
    /// Packed luma of both views as they were taken.
    luma: [wgpu::Buffer; 2],
    of_luma: [Dispatch; 2],
    /// The colours of the reference view as it was taken, if they matter.
    colours: Option<Colours>,
    of_colours: Vec<Dispatch>,
    bytes: u64,
}

/// The views that a matcher gets.
pub(in crate::dense) enum Views<'a> {
    /// Inputs of its size.
    Inputs,
    /// Inputs that are resampled first.
    Resampled([&'a WarpMap; 2]),
    /// A pair on the device, with the colours of the reference view where holes are filled.
    Uploaded(UploadedPair),
}

impl Resampling {
    /// Compiles the kernels and allocates the memory for views that `maps` resample to `luma`, and to the colours of a matcher.
    pub fn new(
        gpu: &Gpu,
        maps: [&WarpMap; 2],
        reference: View,
        luma: &[wgpu::Buffer; 2],
        own: Option<&ReferenceColours>,
    ) -> Result<Self> {
        let sizes = maps.map(WarpMap::source_size);
        let buffer = |label, size: Size| storage_buffer(gpu, label, packed_bytes(size));
        let taken = [buffer("left luma as taken", sizes[0])?, buffer("right luma as taken", sizes[1])?];
        let [left, right] = maps.map(|map| UploadedMap::new(gpu, map));
        let of_luma = [left.luma(&taken[0], &luma[0]), right.luma(&taken[1], &luma[1])];
        let mut bytes = [&taken[0], &taken[1], &left.nodes, &right.nodes].map(wgpu::Buffer::size).iter().sum();
        let (mut colours, mut of_colours) = (None, Vec::new());
        if let Some(own) = own {
            let given = Colours::new(gpu, sizes[index(reference)])?;
            let map = if reference == View::Left { &left } else { &right };
            of_colours = map.colours(&given, &own.colours)?;
            bytes += given.bytes();
            colours = Some(given);
        }
        Ok(Self { sizes, luma: taken, of_luma, colours, of_colours, bytes })
    }

    /// What resamples luma.
    pub fn of_luma(&self) -> &[Dispatch] {
        &self.of_luma
    }

    /// What resamples the colours of the reference view.
    pub fn of_colours(&self) -> &[Dispatch] {
        &self.of_colours
    }

    /// Packed luma of both views as they were taken.
    pub fn luma(&self) -> &[wgpu::Buffer; 2] {
        &self.luma
    }

    /// Width and height of both views as they were taken.
    pub fn sizes(&self) -> [Size; 2] {
        self.sizes
    }

    /// The colours of the reference view as it was taken, if they matter.
    pub fn colours(&self) -> Option<&Colours> {
        self.colours.as_ref()
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Which pixels of the pictures that `maps` make show their views, or lie near pixels with a partner in `range` that does, unless all do.
pub(super) fn masks_of(
    gpu: &Gpu,
    maps: [&WarpMap; 2],
    (reference, range): (View, DisparityRange),
) -> Result<Option<Masks>> {
    let mut visible = maps.map(WarpMap::visible);
    if reference == View::Right {
        visible.reverse();
    }
    let hides = |mask: &Plane<u8>| mask.data().contains(&0);
    if !visible.iter().any(hides) {
        return Ok(None);
    }
    let [own, other] = &visible;
    let seen = Seen { masks: [Some(own), Some(other)], loss: Loss::Nothing };
    let own = seen.near_partners(reference, range);
    Masks::new(gpu, maps[0].size(), Seen { masks: [own.as_ref(), Some(other)], ..seen }).map(Some)
}

fn index(view: View) -> usize {
    usize::from(view == View::Right)
}
