//! Outputs of a map that is taken back to the reference view as it was taken.

use super::Matcher;
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    dense::{
        kernels::{MapBack, MapBuffer, MapLayout, MapRows},
        outputs::{Back, Destination, Disparities, Outputs},
        word_copy::{CopyTarget, WordCopy},
    },
    error::{Result, check},
    gpu::{guarded, storage_buffer},
    image::Size,
    luma::packed_bytes,
    rectify::{UploadedMap, WarpMap},
};

impl Matcher {
    /// [`Self::outputs`] of a map that is taken back to the reference view as it was taken: `back` has for each pixel of the view
    /// its position in the resampled picture, [`crate::rectify::StereoRectification::map_back`]. Both destinations have the size of
    /// the view.
    ///
    /// Disparities remain those of the resampled pair. They are interpolated bilinearly between pixels within 1 px of each other,
    /// and are else those of the nearest pixel, as confidences are. Pixels that the resampled picture does not show have none.
    ///
    /// # Errors
    /// As [`Self::outputs`]; [`crate::Error::Parameter`] for a map that does not lead to the size of the matcher;
    /// [`crate::Error::TooLarge`] if the device cannot bind a map whole, [`crate::Error::OutOfMemory`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn outputs_back(
        &self,
        back: &WarpMap,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        block_on(self.outputs_back_async(back, disparities, confidences))
    }

    /// The asynchronous [`Matcher::outputs_back`].
    ///
    /// # Errors
    /// See [`Matcher::outputs_back`].
    pub async fn outputs_back_async(
        &self,
        back: &WarpMap,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        let (own, size) = (self.size, back.size());
        check(
            back.source_size() == own,
            "the map back",
            format_args!("into a picture of {} pixels", back.source_size()),
            format!("the matcher has {own}"),
        )?;
        let layout = MapLayout { width: size.width, rows: size.height };
        let (whole, map, dispatch) = guarded(&self.gpu, "the map back", || {
            let whole = [
                storage_buffer(&self.gpu, "disparities of the resampled view", 4 * own.pixels())?,
                storage_buffer(&self.gpu, "confidences of the resampled view", packed_bytes(own))?,
            ];
            let map = storage_buffer(&self.gpu, "map of the view", 4 * layout.words())?;
            let nodes = UploadedMap::new(&self.gpu, back).nodes;
            let to = MapBuffer { buffer: &map, layout };
            let dispatch = MapBack::new(&self.gpu).prepare(back, &nodes, whole.each_ref(), to);
            Ok((whole, map, dispatch))
        })
        .await?;
        let Size { width, height: rows } = size;
        let all = vec![(MapRows { width, rows, first_word: 0, first_row: 0 }, &map)];
        let disparities = self.destination(size, disparities, confidences, all).await?;
        let copies = [
            (CopyTarget::Disparities, 0, size.pixels()),
            (CopyTarget::Confidences, layout.confidence_offset().into(), packed_bytes(size) / 4),
        ]
        .map(|(to, from_word, words)| WordCopy { from: map.clone(), from_word, to, to_word: 0, words });
        let matcher = self.pair.luma[0].clone();
        let to = Outputs { disparities, confidences: confidences.cloned(), matcher: matcher.clone(), back: None };
        let [own_disparities, own_confidences] = whole;
        let outputs = Outputs {
            disparities: Disparities::Buffer(own_disparities),
            confidences: Some(own_confidences),
            matcher,
            back: Some(Box::new(Back { dispatch, copies, to })),
        };
        self.tried(outputs).await
    }
}
