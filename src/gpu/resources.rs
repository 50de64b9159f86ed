//! Checks of an application's buffers and textures.

use crate::{
    error::{Error, Result},
    image::Size,
};

/// Refuses a buffer that is too small or lacks a usage.
pub(crate) fn check_buffer(
    name: &'static str,
    buffer: &wgpu::Buffer,
    bytes: u64,
    usage: wgpu::BufferUsages,
) -> Result<()> {
    if buffer.size() < bytes {
        let value = format!("a buffer of {} bytes", buffer.size());
        return Err(Error::Resource { name, value, expected: format!("{bytes} bytes are needed") });
    }
    if !buffer.usage().contains(usage) {
        let value = format!("a buffer with the usages {:?}", buffer.usage());
        return Err(Error::Resource { name, value, expected: format!("it needs {usage:?}") });
    }
    Ok(())
}

/// Refuses a texture without a mip level of `size` pixels, or without a usage.
///
/// wgpu does not tell which mip level a view shows.
pub(crate) fn check_texture(
    name: &'static str,
    texture: &wgpu::Texture,
    Size { width, height }: Size,
    usage: wgpu::TextureUsages,
) -> Result<()> {
    let refuse = |value, expected| Err(Error::Resource { name, value, expected });
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != 1 {
        let value = format!("a texture of {:?} with {} samples", texture.dimension(), texture.sample_count());
        return refuse(value, "it must have two dimensions and one sample".into());
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

/// The error of a resource that the device refuses: it names the properties that wgpu does not tell beforehand.
pub(crate) fn refused(name: &'static str, error: Error) -> Error {
    let Error::Unsupported(reason) = error else { return error };
    let reason = reason.strip_prefix(name).and_then(|reason| reason.strip_prefix(": ")).unwrap_or(&reason);
    Error::Resource {
        name,
        value: format!("refused by the device ({reason})"),
        expected: "it must belong to this device and not be destroyed, and a view must have two dimensions".into(),
    }
}
