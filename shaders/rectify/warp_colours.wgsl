// Resampling of a picture in colour, as `warp` resamples luma: each pixel shows a position of the source, interpolated by
// Catmull-Rom splines (Keys 1981, a = -1/2) along x and y. Pixels beyond the source's edge and those without a position are 0, alpha
// included.

#import catmull_rom

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   SUBPIXEL_BITS      bits after the point of positions and weights
//   NONE_NODE          coordinates of a node without a position

struct Params {
    // Pixels per row of the warped picture, its rows in `warped`, and the first of them.
    width: u32,
    rows: u32,
    first_row: u32,
    source_width: i32,
    source_height: i32,
    // Nodes per row.
    columns: u32,
    // log2 of the distance of nodes, in pixels.
    spacing_bits: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One u32 per pixel: red in the lowest byte, then green and blue.
@group(0) @binding(1) var<storage, read> source: array<u32>;
// Positions in the source at every 2^spacing_bits-th pixel along x and y.
@group(0) @binding(2) var<storage, read> nodes: array<vec2<i32>>;
// As `source`; the highest byte is 255, or 0 for a pixel that shows nothing.
@group(0) @binding(3) var<storage, read_write> warped: array<u32>;

// Weighted sums of red, green and blue of four pixels of row y of the source.
fn row_sums(columns: vec4<i32>, column_weights: vec4<i32>, y: i32) -> vec3<i32> {
    let places = columns + vec4<i32>(clamp(y, 0, params.source_height - 1) * params.source_width);
    let pixels = vec4<u32>(source[places.x], source[places.y], source[places.z], source[places.w]);
    return vec3<i32>(
        dot(vec4<i32>(pixels & vec4<u32>(255u)), column_weights),
        dot(vec4<i32>((pixels >> vec4<u32>(8u)) & vec4<u32>(255u)), column_weights),
        dot(vec4<i32>((pixels >> vec4<u32>(16u)) & vec4<u32>(255u)), column_weights),
    );
}

fn interpolated(position: vec2<i32>) -> u32 {
    let pixel = position >> vec2<u32>(SUBPIXEL_BITS);
    let fraction = position & vec2<i32>(ONE - 1);
    let columns = clamp(pixel.x + vec4<i32>(-1, 0, 1, 2), vec4<i32>(0), vec4<i32>(params.source_width - 1));
    let across = weights(fraction.x);
    let down = weights(fraction.y);
    let sums = row_sums(columns, across, pixel.y - 1) * down.x
        + row_sums(columns, across, pixel.y) * down.y
        + row_sums(columns, across, pixel.y + 1) * down.z
        + row_sums(columns, across, pixel.y + 2) * down.w;
    let rounded = (sums + vec3<i32>(ONE * ONE / 2)) >> vec3<u32>(2 * SUBPIXEL_BITS);
    let bytes = vec3<u32>(clamp(rounded, vec3<i32>(0), vec3<i32>(255)));
    return bytes.r | (bytes.g << 8u) | (bytes.b << 16u) | 0xff000000u;
}

fn is_inside(position: vec2<i32>) -> bool {
    let end = vec2<i32>(params.source_width, params.source_height) * ONE - ONE / 2;
    return all(position >= vec2<i32>(-ONE / 2)) && all(position < end);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.rows {
        return;
    }
    let position = position_at(id.x, params.first_row + id.y);
    var colour = 0u;
    if position.x != NONE_NODE && is_inside(position) {
        colour = interpolated(position);
    }
    warped[id.y * params.width + id.x] = colour;
}
