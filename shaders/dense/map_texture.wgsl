// Copies rows of disparities from a buffer to a texture of either format of disparity maps.
//
// Imports: Rust puts `#import map_fixed_point` (r32sint) or `#import map_pixels` (r32float) in front of this file.
// Either part declares the texture's type `Map` and the conversion `texel`.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    rows: u32,
    // Index of the first disparity in `disparities`, and row of the texture where the first disparity goes.
    first_word: u32,
    first_row: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point.
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
@group(0) @binding(2) var map: Map;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.width || id.y >= params.rows {
        return;
    }
    let disparity = disparities[params.first_word + id.y * params.width + id.x];
    textureStore(map, vec2u(id.x, params.first_row + id.y), texel(disparity));
}
