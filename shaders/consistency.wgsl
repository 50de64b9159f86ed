// Left-right consistency: a disparity stays if its partner in the other view points back at it.
//
// Fua: 'A parallel stereo algorithm that produces dense depth maps and preserves image features',
// Machine Vision and Applications 6, 1993.

struct Params {
    width: u32,
    rows: u32,
    // From a pixel to its partner: -1 where the reference is the left view, 1 where it is the right.
    direction: i32,
    // In 1/256 px.
    max_difference: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> others: array<i32>;
@group(0) @binding(2) var<storage, read_write> disparities: array<i32>;
@group(0) @binding(3) var<storage, read_write> confidences: array<u32>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.rows {
        return;
    }
    let row = id.y * params.width;
    let disparity = disparities[row + id.x];
    if disparity == NONE {
        return;
    }
    let whole = (disparity + SCALE / 2) >> SCALE_BITS;
    let partner = u32(i32(id.x) + params.direction * whole);
    if partner < params.width {
        let other = others[row + partner];
        if other != NONE && u32(abs(disparity - other)) <= params.max_difference {
            return;
        }
    }
    disparities[row + id.x] = NONE;
    confidences[row + id.x] = 0u;
}
