// RGBA8 of packed luma, one u32 per pixel: a grey picture for kernels that read colours.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    rows: u32,
    // Row of the picture of the first row of `pixels`.
    first_row: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Rows of ceil(width / 4) u32, four pixels each.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
// One u32 per pixel: red in the lowest byte, then green and blue; the highest byte is 255.
@group(0) @binding(2) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < params.width && id.y < params.rows {
        let word = luma[(params.first_row + id.y) * ((params.width + 3u) / 4u) + id.x / 4u];
        let grey = (word >> (8u * (id.x % 4u))) & 255u;
        pixels[id.y * params.width + id.x] = 0x10101u * grey | 0xff000000u;
    }
}
