//! What an application binds to a matcher: its views, and the destinations of the map.

use super::{Matcher, resampling::Resampling};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    dense::{
        config::View,
        inputs::Inputs,
        kernels::{MapRows, MapTexel, MapTexture},
        outputs::{Destination, Disparities, Outputs},
    },
    error::{Error, Result},
    gpu::{Dispatch, check_buffer, check_texture, guarded, refused, try_recording},
    image::Size,
    luma::{Input, Source, packed_bytes},
};

impl Matcher {
    /// Binds two views as inputs of this matcher. The inputs keep the textures or buffers alive.
    ///
    /// # Errors
    /// [`Error::Resource`] for an invalid size, format, usage or dimension, and for a resource of another device.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn inputs(&self, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        block_on(self.inputs_async(left, right))
    }

    /// The asynchronous [`Matcher::inputs`].
    ///
    /// # Errors
    /// See [`Matcher::inputs`].
    pub async fn inputs_async(&self, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        for (name, source) in [("the left view", &left), ("the right view", &right)] {
            if let Source::Luma(buffer) = source
                && self.pair.luma.contains(*buffer)
            {
                let value = "the matcher's own luma".into();
                return Err(Error::Resource {
                    name,
                    value,
                    expected: "`record_luma` matches that without inputs".into(),
                });
            }
        }
        let resampling = self.resampling.as_ref();
        let sizes = resampling.map_or([self.size; 2], Resampling::sizes);
        let lumas = resampling.map_or(&self.pair.luma, Resampling::luma);
        let input = |name, view: usize, source| Input::named(&self.gpu, name, sizes[view], source, &lumas[view]);
        let views = [input("the left view", 0, left).await?, input("the right view", 1, right).await?];
        let (name, source) =
            if self.reference == View::Left { ("the left view", left) } else { ("the right view", right) };
        let colours = match &self.colours {
            None => None,
            Some(own) => {
                let to = resampling.and_then(Resampling::colours).unwrap_or(&own.colours);
                own.input(name, &source, to).await?
            }
        };
        Ok(Inputs { views, colours, matcher: self.pair.luma[0].clone() })
    }

    /// Binds the destination of the disparities and, optionally, a buffer with `COPY_DST` for the confidences: one byte per
    /// pixel, in rows of `width.div_ceil(4)` `u32`s. The outputs keep both alive.
    ///
    /// # Errors
    /// See [`Self::inputs`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn outputs(&self, disparities: Destination<'_>, confidences: Option<&wgpu::Buffer>) -> Result<Outputs> {
        block_on(self.outputs_async(disparities, confidences))
    }

    /// The asynchronous [`Matcher::outputs`].
    ///
    /// # Errors
    /// See [`Matcher::outputs`].
    pub async fn outputs_async(
        &self,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        let width = self.size.width;
        let row = |word: u64| (word / u64::from(width)) as u32;
        let rows = self.plan.copies_of_disparities().map(|copy| {
            let (rows, first_row) = (row(copy.words), row(copy.to_word));
            (MapRows { width, rows, first_word: copy.from_word as u32, first_row }, &copy.from)
        });
        let disparities = self.destination(self.size, disparities, confidences, rows.collect()).await?;
        let outputs =
            Outputs { disparities, confidences: confidences.cloned(), matcher: self.pair.luma[0].clone(), back: None };
        self.tried(outputs).await
    }

    /// The outputs, if the device accepts their recording.
    pub(super) async fn tried(&self, outputs: Outputs) -> Result<Outputs> {
        try_recording(&self.gpu, "the outputs", |encoder| self.plan.record(encoder, &outputs, None))
            .await
            .map_err(|error| refused("the outputs", error))?;
        Ok(outputs)
    }

    /// The destination of disparities of `size`; for a texture they come from buffers, `rows` by rows. Also checks the destination of
    /// the confidences.
    pub(super) async fn destination(
        &self,
        size: Size,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
        rows: Vec<(MapRows, &wgpu::Buffer)>,
    ) -> Result<Disparities> {
        if let Some(buffer) = confidences {
            check_buffer("the confidence map", buffer, packed_bytes(size), wgpu::BufferUsages::COPY_DST)?;
        }
        let disparities = match disparities {
            Destination::Buffer(buffer) => {
                check_buffer("the disparity map", buffer, 4 * size.pixels(), wgpu::BufferUsages::COPY_DST)?;
                Disparities::Buffer(buffer.clone())
            }
            Destination::Texture(view) => Disparities::Texture(self.to_texture(size, view, rows).await?),
        };
        let mut buffers = self.pair.luma.to_vec();
        buffers.extend(self.resampling.iter().flat_map(Resampling::luma).cloned());
        for (name, buffer) in [("the disparity map", disparities.buffer()), ("the confidence map", confidences)] {
            let Some(buffer) = buffer else { continue };
            if buffers.contains(buffer) {
                let value = "a buffer that the matcher also uses for luma or for the other result".into();
                return Err(Error::Resource { name, value, expected: "it needs a buffer of its own".into() });
            }
            buffers.push(buffer.clone());
        }
        Ok(disparities)
    }

    /// One dispatch per part of a map of `size`, into a texture.
    async fn to_texture(
        &self,
        size: Size,
        view: &wgpu::TextureView,
        rows: Vec<(MapRows, &wgpu::Buffer)>,
    ) -> Result<Vec<Dispatch>> {
        let (name, format) = ("the disparity map", view.texture().format());
        let Some(texel) = MapTexel::new(format) else {
            return Err(Error::Resource {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", MapTexel::ALL.map(MapTexel::format)),
            });
        };
        check_texture(name, view.texture(), size, wgpu::TextureUsages::STORAGE_BINDING)?;
        guarded(&self.gpu, name, || {
            let kernel = MapTexture::new(&self.gpu, texel);
            Ok(rows.into_iter().map(|(rows, from)| kernel.prepare(rows, from, view)).collect())
        })
        .await
        .map_err(|error| refused(name, error))
    }
}
