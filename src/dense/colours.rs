//! The colours of the reference view in a matcher, by which holes are filled.

use super::config::{DenseConfig, View};
use crate::{
    error::Result,
    gpu::{Dispatch, Gpu, guarded, refused, try_recording},
    image::Size,
    luma::{
        Colours, Source, TexelFormat,
        kernels::{rgba::LumaToRgba, rgba_texture::RgbaTexture},
    },
};

/// The colours of the reference view, and what writes them.
#[derive(Debug)]
pub(super) struct ReferenceColours {
    gpu: Gpu,
    pub(super) colours: Colours,
    /// The conversion of packed luma, for inputs without colours.
    grey: Vec<Dispatch>,
}

impl ReferenceColours {
    /// Memory for the colours of a view of `size` with this packed `luma`, if `config` needs them.
    pub(super) fn new(
        gpu: &Gpu,
        size: Size,
        config: &DenseConfig,
        [left, right]: [&wgpu::Buffer; 2],
    ) -> Result<Option<Self>> {
        if !config.parameters.fills() {
            return Ok(None);
        }
        let colours = Colours::new(gpu, size)?;
        let luma = if config.reference == View::Left { left } else { right };
        let kernel = LumaToRgba::new(gpu);
        let grey =
            colours.bands().map(|(first_row, size, pixels)| kernel.prepare(size, first_row, luma, pixels)).collect();
        Ok(Some(Self { gpu: gpu.clone(), colours, grey }))
    }

    /// The grey levels of the reference view of packed `luma`, written on the device, if `config` needs colours.
    pub(super) async fn without_colours(
        gpu: &Gpu,
        size: Size,
        config: &DenseConfig,
        luma: [&wgpu::Buffer; 2],
    ) -> Result<Option<Colours>> {
        gpu.with_room("the grey levels", || {
            let Some(own) = Self::new(gpu, size, config, luma)? else { return Ok(None) };
            let mut encoder = gpu.encoder("grey levels");
            own.grey().iter().for_each(|one| one.record(&mut encoder));
            gpu.queue.submit([encoder.finish()]);
            Ok(Some(own.colours))
        })
        .await
    }

    /// The conversion of a view called `name` in errors to `colours`; `None` for packed luma, which has no colours.
    pub(super) async fn input(
        &self,
        name: &'static str,
        source: &Source<'_>,
        colours: &Colours,
    ) -> Result<Option<Vec<Dispatch>>> {
        let texture =
            source.texture().ok().and_then(|(view, format, origin)| Some((view, TexelFormat::new(format)?, origin)));
        let Some((view, texel, [column, row])) = texture else { return Ok(None) };
        let dispatches = guarded(&self.gpu, name, || {
            let kernel = RgbaTexture::new(&self.gpu);
            let band =
                |(first_row, size, pixels)| kernel.prepare(size, texel, (view, [column, row + first_row]), pixels);
            Ok(colours.bands().map(band).collect::<Vec<_>>())
        })
        .await
        .map_err(|error| refused(name, error))?;
        let record = |encoder: &mut wgpu::CommandEncoder| dispatches.iter().for_each(|one| one.record(encoder));
        try_recording(&self.gpu, name, record).await.map_err(|error| refused(name, error))?;
        Ok(Some(dispatches))
    }

    /// The conversion of packed luma, for a view without colours.
    pub(super) fn grey(&self) -> &[Dispatch] {
        &self.grey
    }
}
