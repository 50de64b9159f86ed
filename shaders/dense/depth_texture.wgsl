// Depths of a map's disparities, to a texture.
//
// Depth is focal length times baseline over disparity and doffs. Division differs from device to device, and so the host divides:
// `words` has the depth of each disparity.

#import words

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   NONE               sentinel: the pixel has no disparity

struct Params {
    width: u32,
    height: u32,
    // Disparities of the first and of the last entry of the table, fixed-point.
    first: i32,
    last: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point.
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
// Two f32 per disparity: the depth, and the depth divided by the focal length; 0 where the disparity has none.
@group(0) @binding(2) var words: texture_storage_2d<r32uint, read>;
@group(0) @binding(3) var depths: texture_storage_2d<r32float, write>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.width || id.y >= params.height {
        return;
    }
    let disparity = disparities[id.y * params.width + id.x];
    let entry = u32(clamp(disparity, params.first, params.last) - params.first);
    let depth = bitcast<f32>(word_at(2u * entry));
    textureStore(depths, id.xy, vec4f(select(0.0, depth, disparity != NONE), 0.0, 0.0, 1.0));
}
