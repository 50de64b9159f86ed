// Projection of a map to the other view: of the disparities whose partner a pixel of the other view is, the largest,
// which belongs to the nearest surface and hides the others.

#import consistent

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   NONE               sentinel: the pixel has no disparity

struct Params {
    width: u32,
    rows: u32,
    // Partner column = column + direction * disparity: -1 if the reference is the left view, 1 if the right view.
    direction: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel of the reference view: the disparity, fixed-point.
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
// One u32 per pixel of the other view, cleared to 0 before: the disparity with its sign bit inverted, so that larger
// disparities are larger numbers; 0 for none.
@group(0) @binding(2) var<storage, read_write> projected: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.rows {
        return;
    }
    let row = id.y * params.width;
    let disparity = disparities[row + id.x];
    let partner = partner_of(i32(id.x), disparity, params.direction);
    if disparity != NONE && partner >= 0 && partner < i32(params.width) {
        atomicMax(&projected[row + u32(partner)], u32(disparity) ^ 0x80000000u);
    }
}
