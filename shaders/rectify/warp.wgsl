// Resampling: each pixel shows a position of the source, interpolated by Catmull-Rom splines (Keys 1981, a = -1/2) along
// x and y. Pixels beyond the source's edge have the luma of the edge.

#import luma_words
#import catmull_rom

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   SUBPIXEL_BITS      bits after the point of positions and weights
//   NONE_NODE          coordinates of a node without a position

struct Params {
    // Pixels of the warped picture.
    width: u32,
    height: u32,
    source_width: i32,
    source_height: i32,
    // Nodes per row.
    columns: u32,
    // log2 of the distance of nodes, in pixels.
    spacing_bits: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Source and warped picture, four pixels packed per u32, rows of ceil(width / 4) u32; bytes beyond the width are 0.
@group(0) @binding(1) var<storage, read> source: array<u32>;
// Positions in the source at every 2^spacing_bits-th pixel along x and y.
@group(0) @binding(2) var<storage, read> nodes: array<vec2<i32>>;
@group(0) @binding(3) var<storage, read_write> warped: array<u32>;

// Weighted sum of four pixels of row y of the source.
fn row_sum(columns: vec4<i32>, column_weights: vec4<i32>, y: i32) -> i32 {
    let first = clamp(y, 0, params.source_height - 1) * ((params.source_width + 3) / 4);
    let words = first + (columns >> vec4<u32>(2u));
    let four = vec4<u32>(source[words.x], source[words.y], source[words.z], source[words.w]);
    let pixels = (four >> vec4<u32>(8 * (columns & vec4<i32>(3)))) & vec4<u32>(255u);
    return dot(vec4<i32>(pixels), column_weights);
}

fn interpolated(position: vec2<i32>) -> u32 {
    let pixel = position >> vec2<u32>(SUBPIXEL_BITS);
    let fraction = position & vec2<i32>(ONE - 1);
    let columns = clamp(pixel.x + vec4<i32>(-1, 0, 1, 2), vec4<i32>(0), vec4<i32>(params.source_width - 1));
    let across = weights(fraction.x);
    let sums = vec4<i32>(
        row_sum(columns, across, pixel.y - 1),
        row_sum(columns, across, pixel.y),
        row_sum(columns, across, pixel.y + 1),
        row_sum(columns, across, pixel.y + 2),
    );
    let sum = dot(sums, weights(fraction.y));
    return u32(clamp((sum + ONE * ONE / 2) >> u32(2 * SUBPIXEL_BITS), 0, 255));
}

fn luma_at(x: u32, y: u32) -> u32 {
    let position = position_at(x, y);
    if position.x == NONE_NODE {
        return 0u;
    }
    return interpolated(position);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let words = (params.width + 3u) / 4u;
    if id.x < words && id.y < params.height {
        warped[id.y * words + id.x] = luma_word(4u * id.x, id.y);
    }
}
