// Picture of half the size: each pixel is the mean of 2x2 pixels, of fewer at the right and lower edges. One thread
// makes one u32 of four pixels, from two u32 of either row.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    // Pixels of the picture.
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Picture and halved picture, four pixels packed per u32, each row in u32 of its own; bytes beyond the width are 0.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
@group(0) @binding(2) var<storage, read_write> halved: array<u32>;

// Sum of the first two pixels of a u32, and sum of the last two.
fn pairs(word: u32) -> vec2<u32> {
    let sums = (word & 0x00ff00ffu) + ((word >> 8u) & 0x00ff00ffu);
    return vec2<u32>(sums & 0xffffu, sums >> 16u);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let words = (params.width + 3u) / 4u;
    let new_words = (words + 1u) / 2u;
    if id.x >= new_words || id.y >= (params.height + 1u) / 2u {
        return;
    }
    let below = min(2u * id.y + 1u, params.height - 1u);
    let first = 2u * id.y * words;
    let second = below * words;
    var sums: array<u32, 4>;
    for (var i = 0; i < 2; i++) { // unroll
        let x = min(2u * id.x + i, words - 1u);
        let sum = pairs(luma[first + x]) + pairs(luma[second + x]);
        sums[2 * i] = sum.x;
        sums[2 * i + 1] = sum.y;
    }
    // Pixels beyond the width are 0: of an odd width the last mean is over two pixels.
    let new_width = (params.width + 1u) / 2u;
    var word = 0u;
    for (var i = 0; i < 4; i++) { // unroll
        let x = 4u * id.x + i;
        let alone = 2u * x + 1u >= params.width;
        let mean = select((sums[i] + 2u) >> 2u, (sums[i] + 1u) >> 1u, alone);
        word |= select(mean << (8u * i), 0u, x >= new_width);
    }
    halved[id.y * new_words + id.x] = word;
}
