// Padding: a plane of the picture with a halo, in which each pixel outside the picture has the luma of the nearest
// pixel inside, so that block matching needs no bounds checks. Brightness is corrected on the way.

#import brightness
#import edges

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    height: u32,
    // First column in u32 and first row of the padded plane, from the picture's corner; negative: left of or above the
    // picture.
    first_word: i32,
    first_row: i32,
    rows: u32,
    // u32 per row of the padded plane, and index in `padded` where the plane begins.
    stride: u32,
    offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<uniform> brightness: Brightness;
// Four pixels packed per u32, rows of ceil(width / 4) u32.
@group(0) @binding(2) var<storage, read> luma: array<u32>;
@group(0) @binding(3) var<storage, read_write> padded: array<u32>;

// Four packed pixels with corrected brightness.
fn brightened_word(word: u32) -> u32 {
    let pixels = vec4<i32>((vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u));
    let bytes = vec4<u32>(brightened(pixels, brightness));
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.stride || id.y >= params.rows {
        return;
    }
    let width = i32(params.width);
    let y = u32(clamp(params.first_row + i32(id.y), 0, i32(params.height) - 1));
    let word = params.first_word + i32(id.x);
    let nearest = luma[y * ((params.width + 3u) / 4u) + u32(clamp(word, 0, (width - 1) / 4))];
    let pixels = with_edges(word, nearest, width);
    padded[params.offset + id.y * params.stride + id.x] = brightened_word(pixels);
}
