// Luma of a texture, four pixels packed per u32: (77 R + 150 G + 29 B + 128) >> 8 of the channels as bytes.

#import luma_words

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    height: u32,
    // 1: the texture has the red channel only, which is the luma.
    grey: u32,
    // 1: the texture's format decodes sRGB, so that texels are linear and are encoded again.
    linear: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var picture: texture_2d<f32>;
// Rows of ceil(width / 4) u32; bytes beyond the width are 0.
@group(0) @binding(2) var<storage, read_write> luma: array<u32>;

// sRGB encoding, IEC 61966-2-1. Neighbouring bytes differ by more than twice the error of a conforming decoder and of
// `pow`, so that rounding restores the byte.
fn encoded(levels: vec3f) -> vec3f {
    let dark = 12.92 * levels;
    let bright = 1.055 * pow(levels, vec3f(1.0 / 2.4)) - 0.055;
    return select(bright, dark, levels <= vec3f(0.0031308));
}

fn luma_at(x: u32, y: u32) -> u32 {
    var levels = clamp(textureLoad(picture, vec2u(x, y), 0).rgb, vec3f(0.0), vec3f(1.0));
    if params.linear != 0u {
        levels = encoded(levels);
    }
    let bytes = vec3u(255.0 * levels + 0.5);
    if params.grey != 0u {
        return bytes.r;
    }
    return luma_of(bytes);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let words = (params.width + 3u) / 4u;
    if id.x < words && id.y < params.height {
        luma[id.y * words + id.x] = luma_word(4u * id.x, id.y);
    }
}
