// Confidences of a map, to a texture.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Rows of ceil(width / 4) u32, one byte per pixel.
@group(0) @binding(1) var<storage, read> confidences: array<u32>;
@group(0) @binding(2) var texels: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.width || id.y >= params.height {
        return;
    }
    let word = confidences[id.y * ((params.width + 3u) / 4u) + id.x / 4u];
    textureStore(texels, id.xy, vec4u(word >> (8u * (id.x % 4u)) & 255u, 0u, 0u, 1u));
}
