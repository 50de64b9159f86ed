// Semi-global matching, selection, for devices with many threads: the sum of the costs of all paths, winner-take-all,
// uniqueness check and sub-pixel interpolation.
//
// Consecutive threads, `lanes` of them, share a pixel and have 16 disparities each; they find the winner, and then the
// rival and the winner's neighbours, through workgroup memory.

#import selection

// Constants:
//   WORKGROUP   threads per workgroup
//   PATHS       volumes of paths
//   FULL        1: confidences are written too
//   KEYS        1: the winners' keys are written too

struct Params {
    width: u32,
    // Index in `paths`, in vectors, where the band begins in the volume of the first path, and vectors from one volume to
    // the next.
    volumes_start: u32,
    volume_quads: u32,
    // Vectors per pixel of a volume, and threads per pixel: the power of two that is not less.
    quads: u32,
    lanes: u32,
    min_disparity: i32,
    disparities: u32,
    // Uniqueness: least excess of the rival's cost over the winner's cost, in per cent.
    uniqueness: u32,
    // Indices in `matches` of the first u32 of the confidences and of the first key.
    confidence_offset: u32,
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Volumes of path costs: `quads` vectors per pixel, four disparities packed per u32, 8 bits each.
@group(0) @binding(1) var<storage, read> paths: array<vec4<u32>>;
// Before: zeros. One u32 per pixel: the bits of the disparity, fixed-point. If FULL, the confidences, 0 to 255, four packed
// per u32. If KEYS, one u32 per pixel: the winner's key.
@group(0) @binding(2) var<storage, read_write> matches: array<atomic<u32>>;

// Keys of 16 disparities.
alias Keys = array<vec4<u32>, 4>;

// The least of a thread's keys; then the keys of the rival and of the winner's lower and upper neighbour among them.
var<workgroup> bests: array<u32, WORKGROUP>;
var<workgroup> compared: array<vec3<u32>, WORKGROUP>;

fn least_of(keys: vec4<u32>) -> u32 {
    return min(min(keys.x, keys.y), min(keys.z, keys.w));
}

// Keys of the disparities of vector `quad` of a pixel whose vectors begin at `place`, from the sums of their costs.
fn keys_of(place: u32, quad: u32) -> Keys {
    // Sums of the even and of the odd disparities, two packed per u32, 16 bits each.
    var even = vec4<u32>(0u);
    var odd = vec4<u32>(0u);
    for (var p = 0u; p < PATHS; p++) {
        let costs = paths[params.volumes_start + p * params.volume_quads + place + quad];
        even += costs & vec4<u32>(0x00ff00ffu);
        odd += (costs >> vec4<u32>(8u)) & vec4<u32>(0x00ff00ffu);
    }
    var keys: Keys;
    for (var t = 0; t < 4; t++) { // unroll
        let index = vec4<u32>(16u * quad + 4u * t) + vec4<u32>(0u, 1u, 2u, 3u);
        let sums = vec4<u32>(even[t] << 16u, odd[t] << 16u, even[t] & 0xffff0000u, odd[t] & 0xffff0000u);
        keys[t] = select(vec4<u32>(NO_KEY), sums | index, index < vec4<u32>(params.disparities));
    }
    return keys;
}

// Keys of the rival, the best disparity two or more away from the winner, and of the winner's two neighbours.
fn rival_and_neighbours(keys: Keys, quad: u32, best: u32) -> vec3<u32> {
    let no_key = vec4<u32>(NO_KEY);
    let winner = vec4<u32>(best & INDEX_MASK);
    var rival = no_key;
    var below = no_key;
    var above = no_key;
    for (var t = 0; t < 4; t++) { // unroll
        let index = vec4<u32>(16u * quad + 4u * t) + vec4<u32>(0u, 1u, 2u, 3u);
        let is_below = index + 1u == winner;
        let is_above = index == winner + 1u;
        below = select(below, keys[t], is_below);
        above = select(above, keys[t], is_above);
        rival = min(rival, select(keys[t], no_key, is_below | is_above | (index == winner)));
    }
    return vec3<u32>(least_of(rival), least_of(below), least_of(above));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let lane = thread % params.lanes;
    let first_thread = thread - lane;
    let x = group.x * (WORKGROUP / params.lanes) + thread / params.lanes;
    let pixel = group.y * params.width + x;
    let is_busy = x < params.width && lane < params.quads;

    var keys: Keys;
    for (var t = 0; t < 4; t++) { // unroll
        keys[t] = vec4<u32>(NO_KEY);
    }
    if is_busy {
        keys = keys_of(pixel * params.quads, lane);
    }
    bests[thread] = least_of(min(min(keys[0], keys[1]), min(keys[2], keys[3])));
    workgroupBarrier();
    var best = NO_KEY;
    for (var k = 0u; k < params.quads; k++) {
        best = min(best, bests[first_thread + k]);
    }
    compared[thread] = rival_and_neighbours(keys, lane, best);
    workgroupBarrier();
    if lane > 0u || x >= params.width {
        return;
    }
    var others = vec3<u32>(NO_KEY);
    for (var k = 0u; k < params.quads; k++) {
        others = min(others, compared[first_thread + k]);
    }
    let result = disparity_and_confidence(best, others.x, others.y, others.z);
    atomicStore(&matches[pixel], result.x);
    if FULL != 0 {
        let word = params.confidence_offset + group.y * ((params.width + 3u) / 4u) + x / 4u;
        atomicOr(&matches[word], result.y << (8u * (x % 4u)));
    }
    if KEYS != 0 {
        atomicStore(&matches[params.key_offset + pixel], best);
    }
}
