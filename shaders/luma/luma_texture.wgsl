// A texture's colours to luma, packed four pixels a word: (77 R + 150 G + 29 B + 128) >> 8 of bytes 0 to 255.

#import luma_words

struct Params {
    width: u32,
    height: u32,
    // Whether red is all there is.
    grey: u32,
    // Whether the texture's format decodes sRGB: the levels are linear then, and are encoded again.
    linear: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var picture: texture_2d<f32>;
// Rows of ceil(width / 4) words; what lies beyond the width is 0.
@group(0) @binding(2) var<storage, read_write> luma: array<u32>;

// IEC 61966-2-1. Neighbouring bytes are so far apart that neither the error of a decoder that passes for one nor that of
// pow here reaches half the way to the next.
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
