// Removes from a map what does not show the scene: the disparities of hidden pixels, and, if asked for, the confidences or the
// disparities of pixels whose partner in the other view is hidden.

#import consistent

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   NONE               sentinel: the pixel has no disparity

struct Params {
    width: u32,
    rows: u32,
    // Row of the view of the first row of the map.
    first_row: u32,
    // Partner column = column + direction * disparity: -1 if the reference is the left view, 1 if the right view.
    direction: i32,
    // What a pixel with a hidden partner loses: 0 nothing, 1 its confidence, 2 its disparity, too.
    loss: u32,
    // Index of the first u32 of the confidences in `map`.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Masks of the reference view and of the other one, four pixels packed per u32, rows of ceil(width / 4) u32: 0 for a hidden
// pixel.
@group(0) @binding(1) var<storage, read> own: array<u32>;
@group(0) @binding(2) var<storage, read> other: array<u32>;
// One i32 per pixel: the disparity, fixed-point. Then the confidences, four packed per u32.
@group(0) @binding(3) var<storage, read_write> map: array<i32>;

// Whether the partner of the pixel in column x, in a row of masks that begins at `mask_row`, is hidden.
fn has_hidden_partner(mask_row: u32, x: u32, disparity: i32) -> bool {
    let partner = clamp(partner_of(i32(x), disparity, params.direction), 0, i32(params.width) - 1);
    let word = other[mask_row + u32(partner) / 4u];
    return disparity != NONE && ((word >> (8u * (u32(partner) % 4u))) & 255u) == 0u;
}

// One thread decides four pixels, whose confidences are one u32.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    if x >= params.width || id.y >= params.rows {
        return;
    }
    let words = (params.width + 3u) / 4u;
    let mask_row = (params.first_row + id.y) * words;
    let seen = own[mask_row + id.x];
    var confirmed = 0u;
    for (var t = 0u; t < min(4u, params.width - x); t++) {
        let pixel = id.y * params.width + x + t;
        let is_hidden = ((seen >> (8u * t)) & 255u) == 0u;
        let is_alone = params.loss != 0u && has_hidden_partner(mask_row, x + t, map[pixel]);
        if is_hidden || (is_alone && params.loss == 2u) {
            map[pixel] = NONE;
        }
        if !is_hidden && !is_alone {
            confirmed |= 255u << (8u * t);
        }
    }
    map[params.confidence_offset + id.y * words + id.x] &= i32(confirmed);
}
