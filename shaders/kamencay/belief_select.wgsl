// Winner-take-all over the beliefs: the belief of a pixel and disparity is the data cost plus the messages of all
// neighbours; the least belief wins.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   INDEX_BITS         bits of a disparity's index in a key

struct Params {
    width: u32,
    height: u32,
    disparities: u32,
    // Vectors of four disparities per pixel.
    fours: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Data costs: two disparities packed per u32, 16 bits each.
@group(0) @binding(1) var<storage, read> costs: array<u32>;
// Messages of each pixel up, down, left and right: four disparities packed per u32.
@group(0) @binding(2) var<storage, read> messages: array<u32>;
// Two u32 per pixel: the winner's key, which is its belief shifted left by INDEX_BITS with its disparity's index in the
// lower bits; then the least belief of disparities two or more away from the winner, all ones without any.
@group(0) @binding(3) var<storage, read_write> winners: array<u32>;

// Four disparities of the message that a node sends in direction 0 to 3: up, down, left, right.
fn sent(node: u32, direction: u32, four: u32) -> vec4<u32> {
    let word = messages[(4u * node + direction) * params.fours + four];
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

// Beliefs of four disparities of the pixel `id`.
fn beliefs(id: vec3<u32>, four: u32) -> vec4<u32> {
    let node = id.y * params.width + id.x;
    let low = costs[2u * (node * params.fours + four)];
    let high = costs[2u * (node * params.fours + four) + 1u];
    var sum = vec4<u32>(low & 0xffffu, low >> 16u, high & 0xffffu, high >> 16u);
    if id.y > 0u {
        sum += sent(node - params.width, 1u, four);
    }
    if id.y + 1u < params.height {
        sum += sent(node + params.width, 0u, four);
    }
    if id.x > 0u {
        sum += sent(node - 1u, 3u, four);
    }
    if id.x + 1u < params.width {
        sum += sent(node + 1u, 2u, four);
    }
    return sum;
}

fn least(values: vec4<u32>) -> u32 {
    return min(min(values.x, values.y), min(values.z, values.w));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.height {
        return;
    }
    let offsets = vec4<u32>(0u, 1u, 2u, 3u);
    var key = 0xffffffffu;
    for (var four = 0u; four < params.fours; four++) {
        let index = 4u * four + offsets;
        let keys = (beliefs(id, four) << vec4<u32>(INDEX_BITS)) | index;
        key = min(key, least(select(vec4<u32>(0xffffffffu), keys, index < vec4<u32>(params.disparities))));
    }
    let best = i32(key & ((1u << INDEX_BITS) - 1u));
    var rival = 0xffffffffu;
    for (var four = 0u; four < params.fours; four++) {
        let index = 4u * four + offsets;
        let is_distant = abs(vec4<i32>(index) - best) >= vec4<i32>(2);
        let is_rival = is_distant & (index < vec4<u32>(params.disparities));
        rival = min(rival, least(select(vec4<u32>(0xffffffffu), beliefs(id, four), is_rival)));
    }
    let node = id.y * params.width + id.x;
    winners[2u * node] = key;
    winners[2u * node + 1u] = rival;
}
