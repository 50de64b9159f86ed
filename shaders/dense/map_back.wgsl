// A map of a warped picture as one of another picture: each pixel has a position in the warped picture. Disparities are
// interpolated bilinearly between the four pixels around the position where all have one and none differs by more than
// SURFACE, and are else those of the nearest pixel; confidences are those of the nearest pixel.

#import warp_map

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   SUBPIXEL_BITS      bits after the point of positions
//   NONE_NODE          coordinates of a node without a position
//   NONE               sentinel: the pixel has no disparity
//   SURFACE            largest difference of neighbouring disparities of one surface, in 1/256 px

struct Params {
    // Pixels of the map that is made, and of the map of the warped picture.
    width: u32,
    height: u32,
    source_width: i32,
    source_height: i32,
    // Nodes per row.
    columns: u32,
    // log2 of the distance of nodes, in pixels.
    spacing_bits: u32,
    // Index of the first u32 of the confidences in `map`.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel of the warped picture: the disparity, fixed-point.
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
// Confidences, four packed per u32, rows of ceil(source_width / 4) u32.
@group(0) @binding(2) var<storage, read> confidences: array<u32>;
// Positions in the warped picture at every 2^spacing_bits-th pixel along x and y.
@group(0) @binding(3) var<storage, read> nodes: array<vec2<i32>>;
// One i32 per pixel: the disparity, fixed-point. Then the confidences, four packed per u32.
@group(0) @binding(4) var<storage, read_write> map: array<i32>;

fn disparity_at(pixel: vec2<i32>) -> i32 {
    let inside = clamp(pixel, vec2<i32>(0), vec2<i32>(params.source_width - 1, params.source_height - 1));
    return disparities[inside.y * params.source_width + inside.x];
}

// Disparity at a position whose nearest pixel is `nearest`.
fn interpolated(position: vec2<i32>, nearest: vec2<i32>) -> i32 {
    let first = position >> vec2<u32>(SUBPIXEL_BITS);
    let part = position & vec2<i32>(ONE - 1);
    let a = disparity_at(first);
    let b = disparity_at(first + vec2<i32>(1, 0));
    let c = disparity_at(first + vec2<i32>(0, 1));
    let d = disparity_at(first + vec2<i32>(1, 1));
    let least = min(min(a, b), min(c, d));
    if least == NONE || max(max(a, b), max(c, d)) - least > SURFACE {
        return disparity_at(nearest);
    }
    // The sum fits in 32 bits, as the interpolated difference from `a` is at most SURFACE; its terms wrap.
    let sum = ((b - a) * part.x + (c - a) * part.y) * ONE + (a - b - c + d) * part.x * part.y;
    return a + ((sum + ONE * ONE / 2) >> u32(2 * SUBPIXEL_BITS));
}

// One thread makes four pixels, whose confidences are one u32.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    if x >= params.width || id.y >= params.height {
        return;
    }
    let stride = (params.source_width + 3) / 4;
    var word = 0u;
    for (var t = 0u; t < min(4u, params.width - x); t++) {
        let position = position_at(x + t, id.y);
        let nearest = (position + vec2<i32>(ONE / 2)) >> vec2<u32>(SUBPIXEL_BITS);
        let size = vec2<i32>(params.source_width, params.source_height);
        var disparity = NONE;
        if position.x != NONE_NODE && all(nearest >= vec2<i32>(0)) && all(nearest < size) {
            disparity = interpolated(position, nearest);
            let confidence = confidences[nearest.y * stride + nearest.x / 4] >> (8u * u32(nearest.x & 3));
            word |= (confidence & 255u) << (8u * t);
        }
        map[id.y * params.width + x + t] = disparity;
    }
    map[params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x] = i32(word);
}
