// Consistency check without a search of the other view: each pixel of the reference view claims its partner, and of
// several claims to one partner the cheapest stands. A pixel whose claim does not stand is occluded in the other view,
// or wrong.
//
// OpenCV's semi-global matcher (StereoSGBM) checks its map in this way. A full search of the other view is more
// accurate, at twice the work.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   INDEX_BITS         bits of a disparity's index in a key

struct Params {
    width: u32,
    rows: u32,
    min_disparity: i32,
    // Partner column = column + direction * disparity: -1 if the reference is the left view, 1 if the right view.
    direction: i32,
    // Index of the first key in `matches`.
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One key per pixel from key_offset on: the cost above, the disparity's index in the lower INDEX_BITS bits; all ones
// without a disparity.
@group(0) @binding(1) var<storage, read> matches: array<u32>;
// One u32 per pixel of the other view: the inverted key of the claim that stands, or 0.
@group(0) @binding(2) var<storage, read_write> claims: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.rows {
        return;
    }
    let row = id.y * params.width;
    let key = matches[params.key_offset + row + id.x];
    let disparity = params.min_disparity + i32(key & ((1u << INDEX_BITS) - 1u));
    let partner = i32(id.x) + params.direction * disparity;
    if key != 0xffffffffu && partner >= 0 && partner < i32(params.width) {
        atomicMax(&claims[row + u32(partner)], ~key);
    }
}
