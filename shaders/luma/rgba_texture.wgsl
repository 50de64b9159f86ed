// RGBA8 of a texture, one u32 per pixel.

#import texel_bytes

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    rows: u32,
    // Column and row of the texture of the first pixel of `pixels`.
    first_column: u32,
    first_row: u32,
    // 1: the texture has the red channel only, which stands for all three.
    grey: u32,
    // 1: the texture's format decodes sRGB, so that texels are linear and are encoded again.
    linear: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var picture: texture_2d<f32>;
// One u32 per pixel: red in the lowest byte, then green and blue; the highest byte is 255.
@group(0) @binding(2) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < params.width && id.y < params.rows {
        let texel = textureLoad(picture, vec2u(params.first_column + id.x, params.first_row + id.y), 0);
        let bytes = texel_bytes(texel, params.grey != 0u, params.linear != 0u);
        pixels[id.y * params.width + id.x] = bytes.r | (bytes.g << 8u) | (bytes.b << 16u) | 0xff000000u;
    }
}
