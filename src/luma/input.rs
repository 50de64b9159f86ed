//! A view of the pair as an application has it, and how it becomes packed luma.

use std::sync::OnceLock;

use super::{
    kernels::luma_texture::{LumaTexture, TexelFormat},
    packed::{check_packed, packed_bytes},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::wait;
use crate::{
    error::{Error, Result},
    gpu::{Context, Dispatch, check_limits, guarded},
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
pub struct Input(Way);

enum Way {
    Copy { from: wgpu::Buffer, to: wgpu::Buffer, bytes: u64 },
    Run(Dispatch),
}

impl Input {
    /// Prepares what turns `source`, of `size` pixels, into packed luma in the first bytes of `luma`, which needs `STORAGE`
    /// and `COPY_DST`. It holds on to both.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size, a format or a usage that cannot be; [`Error::Unsupported`] with what else the
    /// device has against it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new<'c>(
        device: impl Into<Context<'c>>,
        size: (u32, u32),
        source: Source<'_>,
        luma: &wgpu::Buffer,
    ) -> Result<Self> {
        let device = device.into();
        wait(&device, Self::new_async(device, size, source, luma))
    }

    /// As [`Input::new`], without blocking.
    ///
    /// # Errors
    /// As [`Input::new`].
    pub async fn new_async<'c>(
        device: impl Into<Context<'c>>,
        size: (u32, u32),
        source: Source<'_>,
        luma: &wgpu::Buffer,
    ) -> Result<Self> {
        let device = &device.into();
        check_packed(luma, size.0, size.1)?;
        check_limits(device)?;
        Self::with_kernel(device, "the picture", size, source, luma, &OnceLock::new()).await
    }

    /// The same of the picture of this `name`, with a kernel that is compiled at most once.
    pub(crate) async fn with_kernel(
        device: &Context<'_>,
        name: &'static str,
        size: (u32, u32),
        source: Source<'_>,
        luma: &wgpu::Buffer,
        kernel: &OnceLock<LumaTexture>,
    ) -> Result<Self> {
        let (view, format) = match source {
            Source::Luma(from) => {
                check_buffer(name, from, packed_bytes(size.0, size.1), wgpu::BufferUsages::COPY_SRC)?;
                let (from, to, bytes) = (from.clone(), luma.clone(), packed_bytes(size.0, size.1));
                return Self(Way::Copy { from, to, bytes }).tried(device, name).await;
            }
            Source::Texture(view) => (view, view.texture().format()),
            Source::TextureAs(view, format) => {
                let own = view.texture().format();
                if format.remove_srgb_suffix() != own.remove_srgb_suffix() {
                    let value = format!("a view in the format {format:?}");
                    let expected = format!("the texture has {own:?}, and its views that with or without sRGB");
                    return Err(Error::Parameter { name, value, expected });
                }
                (view, format)
            }
        };
        let Some(texel) = TexelFormat::new(format) else {
            return Err(Error::Parameter {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", TexelFormat::ALL),
            });
        };
        check_texture(name, view.texture(), size, wgpu::TextureUsages::TEXTURE_BINDING)?;
        let (compiled, dispatch) = guarded(device, name, || {
            let compiled = kernel.get().cloned().unwrap_or_else(|| LumaTexture::new(device));
            let dispatch = compiled.prepare(device, size, texel, view, luma);
            Ok((compiled, dispatch))
        })
        .await?;
        // Only now that nothing is wrong with it.
        kernel.get_or_init(|| compiled);
        Self(Way::Run(dispatch)).tried(device, name).await
    }

    /// Itself, if the device has nothing against its being recorded.
    async fn tried(self, device: &wgpu::Device, name: &str) -> Result<Self> {
        try_recording(device, name, |encoder| self.record(encoder)).await?;
        Ok(self)
    }

    /// Records the conversion.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        match &self.0 {
            Way::Copy { from, to, bytes } => encoder.copy_buffer_to_buffer(from, 0, to, 0, Some(*bytes)),
            Way::Run(dispatch) => dispatch.record(encoder),
        }
    }
}

/// Records what is never submitted: what the device would have to say when a caller records it, it says here. A buffer of
/// another device, for one, cannot be told otherwise.
pub(crate) async fn try_recording(
    device: &wgpu::Device,
    what: &str,
    record: impl FnOnce(&mut wgpu::CommandEncoder),
) -> Result<()> {
    guarded(device, what, || {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("trial") });
        record(&mut encoder);
        drop(encoder.finish());
        Ok(())
    })
    .await
}

/// Refuses a buffer that is too small or may not be used so.
pub(crate) fn check_buffer(
    name: &'static str,
    buffer: &wgpu::Buffer,
    bytes: u64,
    usage: wgpu::BufferUsages,
) -> Result<()> {
    if buffer.size() < bytes {
        let value = format!("a buffer of {} bytes", buffer.size());
        return Err(Error::Parameter { name, value, expected: format!("{bytes} bytes are needed") });
    }
    if !buffer.usage().contains(usage) {
        let value = format!("a buffer with the usages {:?}", buffer.usage());
        return Err(Error::Parameter { name, value, expected: format!("it needs {usage:?}") });
    }
    Ok(())
}

/// Refuses a texture of which no view has `size` pixels, or that may not be used so.
///
/// Which of its mip levels a view shows cannot be told: any that has the size will do.
pub(crate) fn check_texture(
    name: &'static str,
    texture: &wgpu::Texture,
    (width, height): (u32, u32),
    usage: wgpu::TextureUsages,
) -> Result<()> {
    let refuse = |value, expected| Err(Error::Parameter { name, value, expected });
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != 1 {
        let value = format!("a texture of {:?} with {} samples", texture.dimension(), texture.sample_count());
        return refuse(value, "it must be a plain one of two dimensions".into());
    }
    let level = |level: u32| ((texture.width() >> level).max(1), (texture.height() >> level).max(1));
    if !(0..texture.mip_level_count()).any(|mip| level(mip) == (width, height)) {
        let value = format!("a texture of {}x{} pixels", texture.width(), texture.height());
        return refuse(value, format!("the pair has {width}x{height}"));
    }
    if !texture.usage().contains(usage) {
        return refuse(format!("a texture with the usages {:?}", texture.usage()), format!("it needs {usage:?}"));
    }
    Ok(())
}
