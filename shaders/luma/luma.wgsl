// Luma of an RGBA8 picture, four pixels packed per u32: (77 R + 150 G + 29 B + 128) >> 8.

#import luma_words

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One u32 per pixel: red in the lowest byte, then green, blue and alpha.
@group(0) @binding(1) var<storage, read> pixels: array<u32>;
// Rows of ceil(width / 4) u32; bytes beyond the width are 0.
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
