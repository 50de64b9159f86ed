// RGBA8 to luma, packed four pixels a word: (77 R + 150 G + 29 B + 128) >> 8.

#import luma_words

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A pixel a word, red in the lowest byte.
@group(0) @binding(1) var<storage, read> pixels: array<u32>;
// Rows of ceil(width / 4) words; what lies beyond the width is 0.
@group(0) @binding(2) var<storage, read_write> luma: array<u32>;

fn luma_at(x: u32, y: u32) -> u32 {
    let pixel = pixels[y * params.width + x];
    return luma_of((vec3u(pixel) >> vec3u(0u, 8u, 16u)) & vec3u(255u));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let words = (params.width + 3u) / 4u;
    if id.x < words && id.y < params.height {
        luma[id.y * words + id.x] = luma_word(4u * id.x, id.y);
    }
}
