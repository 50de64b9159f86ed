// Left-right consistency check of the reference view's disparities, given the disparities of the other view, or the
// claims of the reference view.

#import consistent

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   SCALE              disparity units per pixel
//   NONE               sentinel: the pixel has no disparity
//   CLAIMS             1: `others` holds claims (claim.wgsl); 0: disparities of the other view
//   INDEX_BITS         bits of a disparity's index in a claim

struct Params {
    width: u32,
    rows: u32,
    // Partner column = column + direction * disparity: -1 if the reference is the left view, 1 if the right view.
    direction: i32,
    // Largest difference of the disparities of both views, in 1/256 px.
    max_difference: u32,
    // Index of the first u32 of the confidences in `matches`.
    confidence_offset: u32,
    // Disparity of index 0 in a claim, in pixels.
    min_disparity: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel of the other view: the disparity, fixed-point; with CLAIMS the inverted key of the claim, or 0.
@group(0) @binding(1) var<storage, read> others: array<i32>;
// One i32 per pixel of the reference view: the disparity, fixed-point. Then the confidences, four packed per u32.
@group(0) @binding(2) var<storage, read_write> matches: array<i32>;

// One thread checks four pixels, whose confidences are one u32.
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
        if is_confirmed(row, i32(x + t), disparity) {
            kept |= 255u << (8u * t);
        } else {
            matches[row + x + t] = NONE;
        }
    }
    let word = params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x;
    matches[word] &= i32(kept);
}

// Whether the disparity of the pixel in column x is consistent. `row` is the index of the first pixel of its row.
fn is_confirmed(row: u32, x: i32, disparity: i32) -> bool {
    let partner = partner_of(x, disparity, params.direction);
    let other = disparity_of(others[row + u32(clamp(partner, 0, i32(params.width) - 1))]);
    return is_consistent(disparity, partner, params.width, other, params.max_difference);
}

// Disparity of an element of `others`.
fn disparity_of(word: i32) -> i32 {
    if CLAIMS == 0 {
        return word;
    }
    let index = ~word & ((1 << INDEX_BITS) - 1);
    return select((params.min_disparity + index) * SCALE, NONE, word == 0);
}
