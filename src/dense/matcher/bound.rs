//! What an application binds to a matcher: its views, and the destinations of the map.

use super::Matcher;
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    dense::{
        config::View,
        inputs::Inputs,
        kernels::{MapRows, MapTexel, MapTexture},
        outputs::{Destination, Disparities, Outputs},
        word_copy::WordCopy,
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
        let input = |name, source, luma| Input::named(&self.gpu, name, self.size, source, luma);
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
        let [left_luma, right_luma] = self.luma();
        let views = [input("the left view", left, left_luma).await?, input("the right view", right, right_luma).await?];
        let colours = match (&self.colours, self.reference) {
            (None, _) => None,
            (Some(own), View::Left) => own.input("the left view", &left).await?,
            (Some(own), View::Right) => own.input("the right view", &right).await?,
        };
        Ok(Inputs { views, colours, matcher: left_luma.clone() })
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
        let Size { width, height } = self.size;
        if let Some(buffer) = confidences {
            check_buffer("the confidence map", buffer, packed_bytes((width, height)), wgpu::BufferUsages::COPY_DST)?;
        }
        let disparities = match disparities {
            Destination::Buffer(buffer) => {
                let bytes = 4 * u64::from(width) * u64::from(height);
                check_buffer("the disparity map", buffer, bytes, wgpu::BufferUsages::COPY_DST)?;
                Disparities::Buffer(buffer.clone())
            }
            Destination::Texture(view) => Disparities::Texture(self.to_texture(view).await?),
        };
        let mut buffers = self.pair.luma.to_vec();
        for (name, buffer) in [("the disparity map", disparities.buffer()), ("the confidence map", confidences)] {
            let Some(buffer) = buffer else { continue };
            if buffers.contains(buffer) {
                let value = "a buffer that the matcher also uses for luma or for the other result".into();
                return Err(Error::Resource { name, value, expected: "it needs a buffer of its own".into() });
            }
            buffers.push(buffer.clone());
        }
        let outputs = Outputs { disparities, confidences: confidences.cloned(), matcher: self.pair.luma[0].clone() };
        try_recording(&self.gpu, "the outputs", |encoder| self.plan.record(encoder, &outputs, None))
            .await
            .map_err(|error| refused("the outputs", error))?;
        Ok(outputs)
    }

    /// One dispatch per copy of disparities in the plan, into a texture.
    async fn to_texture(&self, view: &wgpu::TextureView) -> Result<Vec<Dispatch>> {
        let (name, format) = ("the disparity map", view.texture().format());
        let Some(texel) = MapTexel::new(format) else {
            return Err(Error::Resource {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", MapTexel::ALL.map(MapTexel::format)),
            });
        };
        check_texture(name, view.texture(), self.size, wgpu::TextureUsages::STORAGE_BINDING)?;
        guarded(&self.gpu, name, || {
            let kernel = MapTexture::new(&self.gpu, texel);
            let width = self.size.width;
            let dispatch = |copy: &WordCopy| {
                let row = |word: u64| (word / u64::from(width)) as u32;
                let (rows, first_row) = (row(copy.words), row(copy.to_word));
                let rows = MapRows { width, rows, first_word: copy.from_word as u32, first_row };
                kernel.prepare(rows, &copy.from, view)
            };
            Ok(self.plan.copies_of_disparities().map(dispatch).collect())
        })
        .await
        .map_err(|error| refused(name, error))
    }
}
