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
    Subject::kernel("rgba_texture", |size, dice| Box::new(RgbaTextureTrial(LumaTextureTrial::draw(size, dice)))),
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

/// A part of a texture, to be converted to luma.
#[derive(Clone, Debug)]
pub struct LumaTextureTrial {
    /// The format of the texture.
    pub format: wgpu::TextureFormat,
    /// Texels of the texture.
    pub texels: Texels,
    /// First column and row of the part, which ends where the texture does.
    pub first: [u32; 2],
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
        // Half of the parts are whole pictures.
        let first = if dice.below(2) == 0 { [0; 2] } else { [dice.below(size.0), dice.below(size.1)] };
        Self { format, texels, first }
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

    /// The size of the texture.
    fn size(&self) -> Size {
        match &self.texels {
            Texels::Rgba(picture) => picture.size(),
            Texels::Grey(picture) => picture.size(),
            Texels::RgbaHalf(picture) => picture.size(),
            Texels::GreyHalf(picture) => picture.size(),
        }
    }

    /// The size of the part.
    fn part_size(&self) -> Size {
        let (Size { width, height }, [column, row]) = (self.size(), self.first);
        Size::new(width - column, height - row)
    }

    /// The part of a picture of the texture's size.
    fn part<T: Copy>(&self, picture: &Plane<T>) -> Plane<T> {
        let [column, row] = self.first;
        Plane::from_fn(self.part_size(), |x, y| picture.get(column + x, row + y))
    }
}

impl Trial for LumaTextureTrial {
    fn parameters(&self) -> String {
        let [column, row] = self.first;
        format!("{:?} from column {column} and row {row} on", self.format)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("texels", self.bytes())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.part_size());
        let texel = TexelFormat::new(self.format)
            .ok_or_else(|| Error::Unsupported(format!("no luma of textures of format {:?}", self.format)))?;
        let picture = bench.texture(self.format, self.size(), &self.bytes());
        let luma = storage_buffer(gpu, "luma", packed_bytes(size))?;
        bench.poison(&luma);
        let dispatch = LumaTexture::new(gpu).prepare(size, texel, (&picture, self.first), &luma);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("luma", bench.download::<u32>(&luma)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("luma", pack(&self.part(&luma_texture(&self.texels))))])
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

/// A part of a texture, to be converted to RGBA8.
#[derive(Clone, Debug)]
pub struct RgbaTextureTrial(pub LumaTextureTrial);

impl Trial for RgbaTextureTrial {
    fn parameters(&self) -> String {
        self.0.parameters()
    }

    fn input(&self) -> Vec<Array> {
        self.0.input()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (format, size) = (self.0.format, self.0.part_size());
        let texel = TexelFormat::new(format)
            .ok_or_else(|| Error::Unsupported(format!("no colours of textures of format {format:?}")))?;
        let picture = bench.texture(format, self.0.size(), &self.0.bytes());
        let pixels = bench.output(size.pixels() as u32)?;
        let dispatch = RgbaTexture::new(bench.gpu).prepare(size, texel, (&picture, self.0.first), &pixels);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("pixels", bench.download::<u32>(&pixels)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![rows_from(&self.0.part(&rgba_texture(&self.0.texels)), 0)])
    }
}

/// The words of a picture from a row on.
fn rows_from(picture: &Plane<[u8; 4]>, first_row: u32) -> Array {
    let first = picture.width() as usize * first_row as usize;
    Array::exact("pixels", picture.data()[first..].iter().map(|&pixel| u32::from_le_bytes(pixel)).collect::<Vec<_>>())
}
