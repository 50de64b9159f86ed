// Luma of a texture, four pixels packed per u32: (77 R + 150 G + 29 B + 128) >> 8 of the channels as bytes.

#import luma_words
#import texel_bytes

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
    // Column and row of the texture where the picture begins.
    first_column: u32,
    first_row: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var picture: texture_2d<f32>;
// Rows of ceil(width / 4) u32; bytes beyond the width are 0.
@group(0) @binding(2) var<storage, read_write> luma: array<u32>;

fn luma_at(x: u32, y: u32) -> u32 {
    return luma_of(texel_bytes(textureLoad(picture, vec2u(params.first_column + x, params.first_row + y), 0), params.grey != 0u, params.linear != 0u));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let words = (params.width + 3u) / 4u;
    if id.x < words && id.y < params.height {
        luma[id.y * words + id.x] = luma_word(4u * id.x, id.y);
    }
}
