use hsad::{
    image::{Plane, Size},
    internals::cpu::luma::Texels,
    luma::{TexelFormat, pack},
    verify::{Dice, trials::LumaTextureTrial},
    wgpu::TextureFormat,
};

use crate::common::{SIZES, assert_twin, leaves, picture};

const BYTES: [TextureFormat; 4] = [
    TextureFormat::Rgba8Unorm,
    TextureFormat::Rgba8UnormSrgb,
    TextureFormat::Bgra8Unorm,
    TextureFormat::Bgra8UnormSrgb,
];

#[test]
fn primaries_weigh_77_150_29_in_every_order() {
    let pixels = [[255, 0, 0, 9], [0, 255, 0, 9], [0, 0, 255, 9], [255, 255, 255, 9], [100, 100, 100, 0]];
    for format in BYTES {
        let texels = Texels::Rgba(Plane::new((5, 1), pixels.to_vec()).unwrap());
        let expected = vec![0xFF_1D_95_4D_u32, 100].into();
        assert_eq!(leaves(&LumaTextureTrial { format, texels, first: [0; 2] }), [expected], "{format:?}");
    }
}

/// Every byte keeps its value, whether the format is sRGB or not; also in each channel alone, and in grey.
#[test]
fn every_byte_is_itself() {
    let all: Vec<u8> = (0..=255).collect();
    let expected = pack(&Plane::new((256, 1), all.clone()).unwrap());
    for format in BYTES {
        let texels = Texels::Rgba(Plane::from_fn((256, 1), |x, _| [x as u8; 4]));
        assert_eq!(
            leaves(&LumaTextureTrial { format, texels, first: [0; 2] }),
            [expected.clone().into()],
            "{format:?}"
        );
        let texels = Texels::Rgba(Plane::from_fn((256, 3), |x, y| {
            let mut pixel = [0; 4];
            pixel[y as usize] = x as u8;
            pixel
        }));
        assert_twin(&format!("{format:?}"), &LumaTextureTrial { format, texels, first: [0; 2] });
    }
    let texels = Texels::Grey(Plane::new((256, 1), all).unwrap());
    assert_eq!(leaves(&LumaTextureTrial { format: TextureFormat::R8Unorm, texels, first: [0; 2] }), [expected.into()]);
}

/// All binary16 from 0 to 1, and some beyond either end.
#[test]
fn every_half_is_the_nearest_byte() {
    let halves: Vec<u16> = (0..=0x3c00).chain([0x8000, 0xbc00, 0xfbff, 0x3c01, 0x4000, 0x7bff]).collect();
    let texels = Texels::GreyHalf(Plane::from_fn((1024, 16), |x, y| halves[(y * 1024 + x) as usize % halves.len()]));
    assert_twin("halves", &LumaTextureTrial { format: TextureFormat::R16Float, texels, first: [0; 2] });
    // 0.5 is 127.5, rounded up.
    let grey = |half| {
        let texels = Texels::RgbaHalf(Plane::filled((1, 1), [half, half, half, 0]));
        leaves(&LumaTextureTrial { format: TextureFormat::Rgba16Float, texels, first: [0; 2] })
    };
    assert_eq!([0x3800, 0x3c00, 0xbc00].map(grey), [128, 255, 0].map(|grey| [vec![grey as u32].into()]));
}

#[test]
fn equals_the_twin_at_every_size() {
    for Size { width, height } in SIZES {
        let channels = [1, 2, 3, 4].map(|seed| picture((width, height), seed));
        let mut dice = Dice::new("halves", width);
        // The others are read in `tests/embedding/sources.rs`.
        for format in &TexelFormat::ALL[..7] {
            let bytes = |x, y| channels.each_ref().map(|channel| channel.get(x, y));
            let mut half = || dice.below(0x3e00) as u16;
            let format = *format;
            let texels = match format {
                TextureFormat::R8Unorm => Texels::Grey(channels[0].clone()),
                TextureFormat::R16Float => Texels::GreyHalf(Plane::from_fn((width, height), |_, _| half())),
                TextureFormat::Rgba16Float => {
                    Texels::RgbaHalf(Plane::from_fn((width, height), |_, _| [0; 4].map(|_| half())))
                }
                _ => Texels::Rgba(Plane::from_fn((width, height), bytes)),
            };
            assert_twin(&format!("{width}x{height} {format:?}"), &LumaTextureTrial { format, texels, first: [0; 2] });
        }
    }
}
