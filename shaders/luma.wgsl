// RGBA8 to luma, packed four pixels a word: (77 R + 150 G + 29 B + 128) >> 8.
//
// One thread makes one word, so that no two threads write the same one.

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
    if x >= params.width {
        return 0u;
    }
    let pixel = pixels[y * params.width + x];
    let red = pixel & 255u;
    let green = (pixel >> 8u) & 255u;
    let blue = (pixel >> 16u) & 255u;
    return (77u * red + 150u * green + 29u * blue + 128u) >> 8u;
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let words = (params.width + 3u) / 4u;
    if id.x >= words || id.y >= params.height {
        return;
    }
    let x = 4u * id.x;
    luma[id.y * words + id.x] = luma_at(x, id.y)
        | (luma_at(x + 1u, id.y) << 8u)
        | (luma_at(x + 2u, id.y) << 16u)
        | (luma_at(x + 3u, id.y) << 24u);
}
