//! The conversion of an application's texture or buffer to packed luma.

use super::{
    kernels::luma_texture::{LumaTexture, TexelFormat},
    packed::{check_packed, packed_bytes},
};
use crate::{
    error::{Error, Result},
    gpu::{Dispatch, Gpu, check_buffer, check_limits, check_texture, guarded, refused, try_recording},
    image::Size,
};

/// A picture on a device.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// Packed luma (see [`crate::luma`]) in a buffer with `COPY_SRC`. The buffer must be neither mapped nor destroyed at
    /// submission.
    Luma(&'a wgpu::Buffer),
    /// A view of a texture with `TEXTURE_BINDING`, in the texture's format, one of [`TexelFormat::ALL`]. The first mip level
    /// of the view must have the size of the pair; wgpu does not tell which level a view shows, so that only a texture
    /// without any such level is refused.
    Texture(&'a wgpu::TextureView),
    /// A view in another of the texture's view formats, which differs in sRGB alone. wgpu does not tell a view's format.
    TextureAs(&'a wgpu::TextureView, wgpu::TextureFormat),
    /// A rectangle of the view's first mip level, of the size of the pair, from this column and row on: both views of a pair in one
    /// texture, or a part of a frame. The view is one as in [`Self::Texture`], of mip level 0.
    Part(&'a wgpu::TextureView, [u32; 2]),
}

impl<'a> Source<'a> {
    /// The view, its format, and column and row where the picture begins; the buffer of packed luma where it is none.
    pub(crate) fn texture(
        &self,
    ) -> std::result::Result<(&'a wgpu::TextureView, wgpu::TextureFormat, [u32; 2]), &'a wgpu::Buffer> {
        match *self {
            Source::Luma(buffer) => Err(buffer),
            Source::Texture(view) => Ok((view, view.texture().format(), [0; 2])),
            Source::TextureAs(view, format) => Ok((view, format, [0; 2])),
            Source::Part(view, first) => Ok((view, view.texture().format(), first)),
        }
    }
}

/// A prepared conversion to packed luma.
#[derive(Debug)]
pub struct Input(Conversion);

#[derive(Debug)]
enum Conversion {
    Copy { from: wgpu::Buffer, to: wgpu::Buffer, bytes: u64 },
    Run(Dispatch),
}

impl Input {
    /// Prepares the conversion of `source`, of `size` pixels, to packed luma at the beginning of `luma`, a buffer with
    /// `STORAGE` and `COPY_DST`. The input keeps both alive and serves a [`crate::Detector`] without a [`crate::Matcher`],
    /// whose own inputs do the same.
    ///
    /// # Errors
    /// [`Error::Resource`] for an invalid size, format, usage or dimension, and for a resource of another device.
    pub async fn new(gpu: &Gpu, size: impl Into<Size>, source: Source<'_>, luma: &wgpu::Buffer) -> Result<Self> {
        let size = size.into();
        check_packed(luma, size)?;
        check_limits(gpu)?;
        Self::named(gpu, "the picture", size, source, luma).await
    }

    /// [`Self::new`] for a picture called `name` in errors.
    pub(crate) async fn named(
        gpu: &Gpu,
        name: &'static str,
        size: Size,
        source: Source<'_>,
        luma: &wgpu::Buffer,
    ) -> Result<Self> {
        let (view, format, first) = match source.texture() {
            Ok(texture) => texture,
            Err(from) => {
                check_buffer(name, from, packed_bytes(size), wgpu::BufferUsages::COPY_SRC)?;
                let (from, to, bytes) = (from.clone(), luma.clone(), packed_bytes(size));
                return Self(Conversion::Copy { from, to, bytes }).tried(gpu, name).await;
            }
        };
        let own = view.texture().format();
        if format.remove_srgb_suffix() != own.remove_srgb_suffix() {
            let value = format!("a view in the format {format:?}");
            let expected = format!("the texture has {own:?}: a view's format is that, with or without the suffix Srgb");
            return Err(Error::Resource { name, value, expected });
        }
        let Some(texel) = TexelFormat::new(format) else {
            return Err(Error::Resource {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", TexelFormat::ALL),
            });
        };
        match source {
            Source::Part(..) => check_part(name, view.texture(), first, size)?,
            _ => check_texture(name, view.texture(), size, wgpu::TextureUsages::TEXTURE_BINDING)?,
        }
        let dispatch = guarded(gpu, name, || Ok(LumaTexture::new(gpu).prepare(size, texel, (view, first), luma)))
            .await
            .map_err(|error| refused(name, error))?;
        Self(Conversion::Run(dispatch)).tried(gpu, name).await
    }

    /// The input, if the device accepts its recording.
    async fn tried(self, gpu: &Gpu, name: &'static str) -> Result<Self> {
        try_recording(gpu, name, |encoder| self.record(encoder)).await.map_err(|error| refused(name, error))?;
        Ok(self)
    }

    /// The dispatch, unless the conversion is a copy.
    pub(crate) fn dispatch(&self) -> Option<&Dispatch> {
        match &self.0 {
            Conversion::Copy { .. } => None,
            Conversion::Run(dispatch) => Some(dispatch),
        }
    }

    /// Records the conversion.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        match &self.0 {
            Conversion::Copy { from, to, bytes } => encoder.copy_buffer_to_buffer(from, 0, to, 0, Some(*bytes)),
            Conversion::Run(dispatch) => dispatch.record(encoder),
        }
    }
}

/// Refuses a rectangle that lies outside a texture, and what [`check_texture`] refuses of the whole texture.
fn check_part(name: &'static str, texture: &wgpu::Texture, first: [u32; 2], size: Size) -> Result<()> {
    let whole = Size::new(texture.width(), texture.height());
    check_texture(name, texture, whole, wgpu::TextureUsages::TEXTURE_BINDING)?;
    let ends = [first[0].checked_add(size.width), first[1].checked_add(size.height)];
    if ends[0].is_some_and(|end| end <= whole.width) && ends[1].is_some_and(|end| end <= whole.height) {
        return Ok(());
    }
    let value = format!("{size} pixels from column {} and row {} on", first[0], first[1]);
    Err(Error::Resource { name, value, expected: format!("the texture has {whole} pixels") })
}
