// What the other view sees, as far as the reference view's winners tell: each pixel claims its partner, and
// of several claims to one the cheapest holds. Where a pixel's own claim is not the one that holds,
// something nearer hides it from the other view, or it is wrong.
//
// As OpenCV's semi-global matcher checks its map: a whole search of the other view does better, for as
// much work again.

struct Params {
    width: u32,
    rows: u32,
    min_disparity: i32,
    // From a pixel to its partner: -1 where the reference is the left view, 1 where it is the right.
    direction: i32,
    // Where the winners' keys begin.
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// The keys: the cost above, the disparity's index in the lower INDEX_BITS bits, or all ones.
@group(0) @binding(1) var<storage, read> matches: array<u32>;
// The inverted keys of the claims that hold; 0 before the first.
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
