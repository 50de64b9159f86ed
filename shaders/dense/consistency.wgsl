// Left-right consistency where both views are known.

#import consistent

struct Params {
    width: u32,
    rows: u32,
    // From a pixel to its partner: -1 where the reference is the left view, 1 where it is the right.
    direction: i32,
    // In 1/256 px.
    max_difference: u32,
    // Where the confidences begin, four a word.
    confidence_offset: u32,
    // Of index 0, where the others are claims.
    min_disparity: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A fixed-point disparity a pixel of the other view; or, with CLAIMS, the inverted key of a disparity, or 0.
@group(0) @binding(1) var<storage, read> others: array<i32>;
// A fixed-point disparity a pixel of the reference view, then a confidence a pixel, four a word.
@group(0) @binding(2) var<storage, read_write> matches: array<i32>;

// A thread checks four pixels, whose confidences are one word.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    if x >= params.width || id.y >= params.rows {
        return;
    }
    let row = id.y * params.width;
    var kept = 0u;
    for (var t = 0u; t < min(4u, params.width - x); t++) {
        let disparity = matches[row + x + t];
        if holds(row, i32(x + t), disparity) {
            kept |= 255u << (8u * t);
        } else {
            matches[row + x + t] = NONE;
        }
    }
    let word = params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x;
    matches[word] &= i32(kept);
}

fn holds(row: u32, x: i32, disparity: i32) -> bool {
    let partner = partner_of(x, disparity, params.direction);
    let other = disparity_of(others[row + u32(clamp(partner, 0, i32(params.width) - 1))]);
    return is_consistent(disparity, partner, params.width, other, params.max_difference);
}

fn disparity_of(word: i32) -> i32 {
    if CLAIMS == 0 {
        return word;
    }
    let index = ~word & ((1 << INDEX_BITS) - 1);
    return select((params.min_disparity + index) * SCALE, NONE, word == 0);
}
