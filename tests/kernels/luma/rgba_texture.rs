//! Textures to RGBA8.

use hsad::{
    image::{Plane, Size},
    internals::cpu::luma::Texels,
    verify::trials::{LumaTextureTrial, RgbaTextureTrial},
    wgpu::TextureFormat,
};

use crate::common::{SIZES, assert_twin, leaves, picture};

#[test]
fn the_twin_converts_the_same() {
    for Size { width, height } in SIZES {
        let channels = [1, 2, 3, 4].map(|seed| picture((width, height), seed));
        let bytes = |x, y| channels.each_ref().map(|channel| channel.get(x, y));
        for (format, texels) in [
            (TextureFormat::Rgba8Unorm, Texels::Rgba(Plane::from_fn((width, height), bytes))),
            (TextureFormat::Bgra8UnormSrgb, Texels::Rgba(Plane::from_fn((width, height), bytes))),
            (TextureFormat::R8Unorm, Texels::Grey(channels[0].clone())),
        ] {
            let first = [width / 5, height / 3];
            assert_twin(
                &format!("{width}x{height} {format:?}"),
                &RgbaTextureTrial(LumaTextureTrial { format, texels, first }),
            );
        }
    }
}

#[test]
fn by_hand() {
    // Alpha is 255, whatever the picture's. Grey is all three channels.
    let texels = Texels::Rgba(Plane::new((1, 2), vec![[9, 9, 9, 9], [1, 2, 3, 4]]).unwrap());
    let colour = LumaTextureTrial { format: TextureFormat::Bgra8Unorm, texels, first: [0, 1] };
    assert_eq!(leaves(&RgbaTextureTrial(colour)), [vec![0xff03_0201_u32].into()]);
    let texels = Texels::GreyHalf(Plane::new((1, 1), vec![0x3800]).unwrap());
    let grey = LumaTextureTrial { format: TextureFormat::R16Float, texels, first: [0; 2] };
    assert_eq!(leaves(&RgbaTextureTrial(grey)), [vec![0xff80_8080_u32].into()]);
}
