// Semi-global matching, last path and selection: the sum of the costs of all paths, winner-take-all, uniqueness check
// and sub-pixel interpolation. Only the selection needs the last path's costs, which are not stored. One thread per
// line (shared/line.wgsl).

#import selection
#import line

// Constants:
//   WORKGROUP   threads per workgroup
//   WORDS       u32 per pixel of a volume, four disparities packed per u32
//   QUADS       vectors per pixel of a volume: WORDS / 4
//   STORED      volumes of stored paths, without the last path
//   FULL        1: confidences are written too
//   KEYS        1: the winners' keys are written too

struct Params {
    width: u32,
    // Rows of the band, and the row of the census transforms where the band begins.
    rows: u32,
    first_row: u32,
    // Index in `paths`, in vectors, where the band begins in the volume of this path.
    path_start: u32,
    // 1: lines continue from the row before the band, whose path costs are in `paths`.
    goes_on: u32,
    // Step to the next pixel of a line, -1, 0 or 1 each.
    dx: i32,
    dy: i32,
    // Index in `paths` of the first path's volume, and the distance from one volume to the next, in vectors.
    volumes_start: u32,
    volume_quads: u32,
    min_disparity: i32,
    disparities: u32,
    // Uniqueness: least excess of the rival's cost over the winner's cost, in per cent.
    uniqueness: u32,
    // Indices in `matches` of the first u32 of the confidences and of the first key.
    confidence_offset: u32,
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// From census.wgsl: the luma of a pixel is the lowest byte of its first u32.
@group(0) @binding(1) var<storage, read> reference: array<vec2<u32>>;
// Matching costs: QUADS vectors per pixel, four disparities packed per u32, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<vec4<u32>>;
// Volumes of path costs, packed as the matching costs.
@group(0) @binding(3) var<storage, read_write> paths: array<vec4<u32>>;
// One u32 per pixel: the bits of the disparity, fixed-point. If FULL, the confidences, 0 to 255, four packed per u32.
// If KEYS, one u32 per pixel: the winner's key.
@group(0) @binding(4) var<storage, read_write> matches: array<atomic<u32>>;

// Keys of a pixel's disparities, four per vector.
alias Keys = array<vec4<u32>, WORDS>;

// Keys from the sum of the stored paths' costs and the last path's costs `packed`.
fn keys_of(pixel: u32, packed: PackedCosts) -> Keys {
    var keys: Keys;
    for (var q = 0; q < QUADS; q++) { // unroll
        // Sums of the even and of the odd disparities, two packed per u32, 16 bits each.
        var even = packed[q] & vec4<u32>(0x00ff00ffu);
        var odd = (packed[q] >> vec4<u32>(8u)) & vec4<u32>(0x00ff00ffu);
        for (var p = 0; p < STORED; p++) { // unroll
            let stored = paths[params.volumes_start + p * params.volume_quads + pixel * QUADS + q];
            even += stored & vec4<u32>(0x00ff00ffu);
            odd += (stored >> vec4<u32>(8u)) & vec4<u32>(0x00ff00ffu);
        }
        for (var t = 0; t < 4; t++) { // unroll
            let index = vec4<u32>(16u * q + 4u * t) + vec4<u32>(0u, 1u, 2u, 3u);
            let sums = vec4<u32>(even[t] << 16u, odd[t] << 16u, even[t] & 0xffff0000u, odd[t] & 0xffff0000u);
            keys[4 * q + t] = select(vec4<u32>(NO_KEY), sums | index, index < vec4<u32>(params.disparities));
        }
    }
    return keys;
}

// Key of the winner.
fn best_key(keys: Keys) -> u32 {
    var best = vec4<u32>(NO_KEY);
    for (var k = 0; k < WORDS; k++) { // unroll
        best = min(best, keys[k]);
    }
    return min(min(best.x, best.y), min(best.z, best.w));
}

// Keys of the rival, the best disparity two or more away from the winner, and of the winner's two neighbours.
fn rival_and_neighbours(keys: Keys, best: u32) -> vec3<u32> {
    let no_key = vec4<u32>(NO_KEY);
    let winner = vec4<u32>(best & INDEX_MASK);
    var rival = no_key;
    var below = no_key;
    var above = no_key;
    for (var k = 0; k < WORDS; k++) { // unroll
        let index = vec4<u32>(4u * k) + vec4<u32>(0u, 1u, 2u, 3u);
        let is_below = index + 1u == winner;
        let is_above = index == winner + 1u;
        below = select(below, keys[k], is_below);
        above = select(above, keys[k], is_above);
        rival = min(rival, select(keys[k], no_key, is_below | is_above | (index == winner)));
    }
    return vec3<u32>(
        min(min(rival.x, rival.y), min(rival.z, rival.w)),
        min(min(below.x, below.y), min(below.z, below.w)),
        min(min(above.x, above.y), min(above.z, above.w)),
    );
}

@compute @workgroup_size(WORKGROUP, 1)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= line_count() {
        return;
    }
    var line = first_pixel(id.x);
    for (var i = 0u; i < line_length(); i++) {
        let luma = luma_at(line);
        let packed = path_costs(line, luma);
        let pixel = u32(line.y) * params.width + u32(line.x);
        let keys = keys_of(pixel, packed);
        let best = best_key(keys);
        let compared = rival_and_neighbours(keys, best);
        let result = disparity_and_confidence(best, compared.x, compared.y, compared.z);
        atomicStore(&matches[pixel], result.x);
        if FULL != 0 {
            let x = u32(line.x);
            let word = params.confidence_offset + u32(line.y) * ((params.width + 3u) / 4u) + x / 4u;
            atomicOr(&matches[word], result.y << (8u * (x % 4u)));
        }
        if KEYS != 0 {
            atomicStore(&matches[params.key_offset + pixel], best);
        }
        line = next_pixel(line, packed, luma);
    }
}
