//! A view of the pair as an application has it, and how it becomes packed luma.

use std::sync::OnceLock;

use super::{
    kernels::luma_texture::{LumaTexture, TexelFormat},
    packed::{check_packed, packed_bytes},
};
use crate::{
    error::{Error, Result},
    gpu::{Dispatch, Gpu, check_buffer, check_limits, check_texture, guarded, refused_view, try_recording},
    image::Size,
};

/// Where a picture is.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// Packed luma (see [`crate::luma`]) in a buffer with `COPY_SRC`. Like every buffer of a submission, it must be neither
    /// mapped nor destroyed then.
    Luma(&'a wgpu::Buffer),
    /// A view of a texture with `TEXTURE_BINDING`, in the texture's own format: one of [`TexelFormat::ALL`], which says
    /// how they become luma. It shows a mip level that has the pair's size, its first one; wgpu does not tell which that is,
    /// so that only a texture without such a level is refused.
    Texture(&'a wgpu::TextureView),
    /// The same in another of the formats that the texture may be seen in, with or without sRGB, which the view itself does
    /// not tell.
    TextureAs(&'a wgpu::TextureView, wgpu::TextureFormat),
}

/// A picture on its way into packed luma.
#[derive(Debug)]
pub struct Input(Conversion);

#[derive(Debug)]
enum Conversion {
    Copy { from: wgpu::Buffer, to: wgpu::Buffer, bytes: u64 },
    Run(Dispatch),
}

impl Input {
    /// Prepares the conversion of `source`, of `size` pixels, to packed luma in the first bytes of `luma`, which needs
    /// `STORAGE` and `COPY_DST`. The input holds on to both. A [`crate::Matcher`] has inputs of its own; this one is for a
    /// [`crate::features::Detector`] alone.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an invalid size, format or usage; [`Error::Unsupported`] with what else the device has
    /// against it.
    pub async fn new(gpu: &Gpu, size: impl Into<Size>, source: Source<'_>, luma: &wgpu::Buffer) -> Result<Self> {
        let size = size.into();
        check_packed(luma, size)?;
        check_limits(gpu)?;
        Self::with_kernel(gpu, "the picture", size, source, luma, &OnceLock::new()).await
    }

    /// As [`Self::new`] for the picture called `name` in errors, with a kernel that is compiled at most once.
    pub(crate) async fn with_kernel(
        gpu: &Gpu,
        name: &'static str,
        size: Size,
        source: Source<'_>,
        luma: &wgpu::Buffer,
        kernel: &OnceLock<LumaTexture>,
    ) -> Result<Self> {
        let (view, format) = match source {
            Source::Luma(from) => {
                check_buffer(name, from, packed_bytes(size), wgpu::BufferUsages::COPY_SRC)?;
                let (from, to, bytes) = (from.clone(), luma.clone(), packed_bytes(size));
                return Self(Conversion::Copy { from, to, bytes }).tried(gpu, name).await;
            }
            Source::Texture(view) => (view, view.texture().format()),
            Source::TextureAs(view, format) => {
                let own = view.texture().format();
                if format.remove_srgb_suffix() != own.remove_srgb_suffix() {
                    let value = format!("a view in the format {format:?}");
                    let expected = format!("the texture has {own:?}, and its views that with or without sRGB");
                    return Err(Error::Resource { name, value, expected });
                }
                (view, format)
            }
        };
        let Some(texel) = TexelFormat::new(format) else {
            return Err(Error::Resource {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", TexelFormat::ALL),
            });
        };
        check_texture(name, view.texture(), size, wgpu::TextureUsages::TEXTURE_BINDING)?;
        let (compiled, dispatch) = guarded(gpu, name, || {
            let compiled = kernel.get().cloned().unwrap_or_else(|| LumaTexture::new(gpu));
            let dispatch = compiled.prepare(size, texel, view, luma);
            Ok((compiled, dispatch))
        })
        .await
        .map_err(|error| refused_view(name, error))?;
        // Only now that nothing is wrong with it.
        kernel.get_or_init(|| compiled);
        Self(Conversion::Run(dispatch)).tried(gpu, name).await
    }

    /// Itself, if the device has nothing against its being recorded.
    async fn tried(self, gpu: &Gpu, name: &str) -> Result<Self> {
        try_recording(gpu, name, |encoder| self.record(encoder)).await?;
        Ok(self)
    }

    /// Records the conversion.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        match &self.0 {
            Conversion::Copy { from, to, bytes } => encoder.copy_buffer_to_buffer(from, 0, to, 0, Some(*bytes)),
            Conversion::Run(dispatch) => dispatch.record(encoder),
        }
    }
}
