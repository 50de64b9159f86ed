// Data costs of the grid of half the size: the sum over each block of 2x2 nodes, at most FAR.
//
// Felzenszwalb and Huttenlocher: 'Efficient belief propagation for early vision', IJCV 70(1), 2006, section 3.3.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   FAR                largest data cost, 2^16 - 1: the mask of one cost as well

struct Params {
    // Nodes of the finer grid.
    width: u32,
    height: u32,
    // u32 per node.
    words: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Data costs of the finer grid, then of the coarser one: two disparities packed per u32, 16 bits each.
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
