// Rows of disparities from a buffer to a texture, as its format wants them: see shared/map_*.wgsl.

struct Params {
    width: u32,
    rows: u32,
    // The word of the first disparity, and the row of the texture that it goes to.
    first_word: u32,
    first_row: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
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
