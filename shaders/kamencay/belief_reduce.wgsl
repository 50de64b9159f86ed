// The data costs of a grid of half the size: those of each block of 2x2 nodes added up, at most FAR.
//
// Felzenszwalb and Huttenlocher: 'Efficient belief propagation for early vision', IJCV 70(1), 2006, section 3.3.

struct Params {
    // Of the finer grid.
    width: u32,
    height: u32,
    // Words a node.
    words: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Two disparities a word, 16 bits each.
@group(0) @binding(1) var<storage, read> fine: array<u32>;
@group(0) @binding(2) var<storage, read_write> coarse: array<u32>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let width = (params.width + 1u) / 2u;
    if id.x >= width || id.y >= (params.height + 1u) / 2u {
        return;
    }
    for (var word = 0u; word < params.words; word++) {
        var low = 0u;
        var high = 0u;
        for (var y = 2u * id.y; y < min(2u * id.y + 2u, params.height); y++) {
            for (var x = 2u * id.x; x < min(2u * id.x + 2u, params.width); x++) {
                let costs = fine[(y * params.width + x) * params.words + word];
                low += costs & FAR;
                high += costs >> 16u;
            }
        }
        coarse[(id.y * width + id.x) * params.words + word] = min(low, u32(FAR)) | (min(high, u32(FAR)) << 16u);
    }
}
