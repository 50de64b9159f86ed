//! Colour to luma, and pictures to RGBA8.

use crate::{
    cpu::luma::{Texels, luma, luma_texture, rgba, rgba_texture},
    error::{Error, Result},
    gpu::storage_buffer,
    image::{Luma, Plane, Size},
    luma::{
        TexelFormat,
        kernels::{luma::RgbaToLuma, luma_texture::LumaTexture, rgba::LumaToRgba, rgba_texture::RgbaTexture},
        pack, packed_bytes,
    },
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("luma", |size, dice| Box::new(LumaTrial::draw(size, dice))),
    Subject::kernel("luma_texture", |size, dice| Box::new(LumaTextureTrial::draw(size, dice))),
    Subject::kernel("rgba", |size, dice| Box::new(RgbaTrial::draw(size, dice))),
    Subject::kernel("rgba_texture", |size, dice| Box::new(RgbaTextureTrial::draw(size, dice))),
];

/// An RGBA picture to be converted to luma.
#[derive(Clone, Debug)]
pub struct LumaTrial(pub Plane<[u8; 4]>);

impl LumaTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let channels = [0; 4].map(|_| dice.picture(size));
        Self(Plane::from_fn(size, |x, y| channels.each_ref().map(|channel| channel.get(x, y))))
    }
}

impl Trial for LumaTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("rgba", self.0.data().as_flattened().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.0.size();
        let luma = bench.output((packed_bytes((width, height)) / 4) as u32)?;
        let dispatch =
            RgbaToLuma::new(bench.gpu).prepare(Size::new(width, height), &bench.upload(self.0.data())?, &luma);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("luma", bench.download::<u32>(&luma)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let Size { width, height } = self.0.size();
        let luma = luma(width, height, self.0.data().as_flattened())?;
        Ok(vec![Array::exact("luma", pack(&luma))])
    }
}

/// A picture in a texture, to be converted to luma.
#[derive(Clone, Debug)]
pub struct LumaTextureTrial {
    /// The format of the texture.
    pub format: wgpu::TextureFormat,
    /// Texels of the picture.
    pub texels: Texels,
}

impl LumaTextureTrial {
    fn draw(Size { width, height }: Size, dice: &mut Dice) -> Self {
        // Larger textures are not required of a device.
        let size = (width.min(2048), height.min(2048));
        let format = dice.pick(&TexelFormat::USUAL);
        let channels = [0; 4].map(|_| dice.picture(size));
        let bytes = Plane::from_fn(size, |x, y| channels.each_ref().map(|channel| channel.get(x, y)));
        // Finite binary16 below 2, of either sign: most of them small, or 1/8 to 1.
        let mut half = |byte: u8| match dice.below(4) {
            0 => dice.word() as u16 & 0xbfff,
            _ => 0x3000 + u16::from(byte) * 12 + dice.below(13) as u16,
        };
        let texels = match format {
            wgpu::TextureFormat::R8Unorm => Texels::Grey(channels[0].clone()),
            wgpu::TextureFormat::R16Float => Texels::GreyHalf(channels[0].map(|&grey| half(grey))),
            wgpu::TextureFormat::Rgba16Float => Texels::RgbaHalf(bytes.map(|bytes| bytes.map(&mut half))),
            _ => Texels::Rgba(bytes),
        };
        Self { format, texels }
    }

    /// The bytes of the texels, in the memory layout of the format.
    fn bytes(&self) -> Vec<u8> {
        use wgpu::TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb};
        match &self.texels {
            Texels::Rgba(picture) if matches!(self.format, Bgra8Unorm | Bgra8UnormSrgb) => {
                picture.data().iter().flat_map(|&[r, g, b, a]| [b, g, r, a]).collect()
            }
            Texels::Rgba(picture) => picture.data().as_flattened().to_vec(),
            Texels::Grey(picture) => picture.data().to_vec(),
            Texels::RgbaHalf(picture) => bytemuck::cast_slice(picture.data()).to_vec(),
            Texels::GreyHalf(picture) => bytemuck::cast_slice(picture.data()).to_vec(),
        }
    }

    fn size(&self) -> Size {
        match &self.texels {
            Texels::Rgba(picture) => picture.size(),
            Texels::Grey(picture) => picture.size(),
            Texels::RgbaHalf(picture) => picture.size(),
            Texels::GreyHalf(picture) => picture.size(),
        }
    }
}

impl Trial for LumaTextureTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.format)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("texels", self.bytes())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.size());
        let texel = TexelFormat::new(self.format)
            .ok_or_else(|| Error::Unsupported(format!("no luma of textures of format {:?}", self.format)))?;
        let picture = bench.texture(self.format, size, &self.bytes());
        let luma = storage_buffer(gpu, "luma", packed_bytes(size))?;
        bench.poison(&luma);
        let dispatch = LumaTexture::new(gpu).prepare(size, texel, (&picture, [0; 2]), &luma);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("luma", bench.download::<u32>(&luma)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("luma", pack(&luma_texture(&self.texels)))])
    }
}

/// A grey picture to be converted to RGBA8.
#[derive(Clone, Debug)]
pub struct RgbaTrial {
    /// The picture.
    pub luma: Luma,
    /// First row that is converted.
    pub first_row: u32,
}

impl RgbaTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { luma: dice.picture(size), first_row: dice.below(size.height) }
    }
}

impl Trial for RgbaTrial {
    fn parameters(&self) -> String {
        format!("from row {} on", self.first_row)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("luma", self.luma.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.luma.size();
        let size = Size::new(width, height - self.first_row);
        let (luma, pixels) = (bench.upload_luma(&self.luma)?, bench.output(size.pixels() as u32)?);
        let dispatch = LumaToRgba::new(bench.gpu).prepare(size, self.first_row, &luma, &pixels);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("pixels", bench.download::<u32>(&pixels)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![rows_from(&rgba(&self.luma), self.first_row)])
    }
}

/// A picture in a texture, to be converted to RGBA8.
#[derive(Clone, Debug)]
pub struct RgbaTextureTrial {
    /// The picture.
    pub texture: LumaTextureTrial,
    /// First row that is converted.
    pub first_row: u32,
}

impl RgbaTextureTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let texture = LumaTextureTrial::draw(size, dice);
        Self { first_row: dice.below(texture.size().height), texture }
    }
}

impl Trial for RgbaTextureTrial {
    fn parameters(&self) -> String {
        format!("{} from row {} on", self.texture.parameters(), self.first_row)
    }

    fn input(&self) -> Vec<Array> {
        self.texture.input()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let LumaTextureTrial { format, .. } = self.texture;
        let Size { width, height } = self.texture.size();
        let size = Size::new(width, height - self.first_row);
        let texel = TexelFormat::new(format)
            .ok_or_else(|| Error::Unsupported(format!("no colours of textures of format {format:?}")))?;
        let picture = bench.texture(format, (width, height), &self.texture.bytes());
        let pixels = bench.output(size.pixels() as u32)?;
        let dispatch = RgbaTexture::new(bench.gpu).prepare(size, texel, (&picture, [0, self.first_row]), &pixels);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("pixels", bench.download::<u32>(&pixels)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![rows_from(&rgba_texture(&self.texture.texels), self.first_row)])
    }
}

/// The words of a picture from a row on.
fn rows_from(picture: &Plane<[u8; 4]>, first_row: u32) -> Array {
    let first = picture.width() as usize * first_row as usize;
    Array::exact("pixels", picture.data()[first..].iter().map(|&pixel| u32::from_le_bytes(pixel)).collect::<Vec<_>>())
}
