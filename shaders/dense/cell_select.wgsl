// Semi-global matching, selection within cells with ranges of their own: the sum of the costs of all paths,
// winner-take-all, uniqueness check and sub-pixel interpolation. A winner at an end of its cell's range that is no end of
// the whole range is none: a smaller cost may lie beyond. One thread per four pixels of a row.

#import selection
#import cell_layout

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   GRAIN              u32 of a step of a pixel's number of words
//   PATHS              volumes of paths
//   SHIFT              bits of a disparity's index in a key
//   FULL               1: confidences are written too
//   KEYS               1: the winners' keys are written too

struct Params {
    width: u32,
    // Rows of the band, and the row of the picture where the band begins.
    rows: u32,
    top: u32,
    // Index in `paths` where the band begins in the first path's volume, and vectors from one volume to the next.
    volumes_start: u32,
    volume_grains: u32,
    // The whole range.
    min_disparity: i32,
    disparities: u32,
    // Uniqueness: least excess of the rival's cost over the winner's cost, in per cent.
    uniqueness: u32,
    // Indices in `matches` of the first u32 of the confidences and of the first key.
    confidence_offset: u32,
    key_offset: u32,
    // See shared/cell_layout.wgsl.
    columns: u32,
    cells: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Volumes of path costs, four disparities packed per u32, 8 bits each, GRAIN u32 per vector.
@group(0) @binding(1) var<storage, read> paths: array<vec4<u32>>;
// One u32 per pixel: the bits of the disparity, fixed-point. If FULL, the confidences, 0 to 255, four packed per u32.
// If KEYS, one u32 per pixel: the winner's key.
@group(0) @binding(2) var<storage, read_write> matches: array<u32>;
@group(0) @binding(3) var words: texture_storage_2d<r32uint, read>;

// Sums of the costs of all paths, of GRAIN words: of the even and of the odd disparities, two packed per u32, 16 bits each.
struct Sums {
    even: vec4<u32>,
    odd: vec4<u32>,
}

// The sums of the words from `place` in the volumes on, a multiple of GRAIN.
fn sums_at(place: u32) -> Sums {
    var sums = Sums(vec4<u32>(0u), vec4<u32>(0u));
    for (var p = 0; p < PATHS; p++) { // unroll
        let costs = paths[params.volumes_start + p * params.volume_grains + place / GRAIN];
        sums.even += costs & vec4<u32>(0x00ff00ffu);
        sums.odd += (costs >> vec4<u32>(8u)) & vec4<u32>(0x00ff00ffu);
    }
    return sums;
}

// Keys of the four disparities of word number `word` of the whole range, from the sums of its even and odd disparities.
fn keys_of(even: u32, odd: u32, word: u32) -> vec4<u32> {
    let index = vec4<u32>(4u * word) + vec4<u32>(0u, 1u, 2u, 3u);
    let sums = vec4<u32>(even & 0xffffu, odd & 0xffffu, even >> 16u, odd >> 16u);
    return select((sums << vec4<u32>(SHIFT)) | index, vec4<u32>(NO_KEY), index >= vec4<u32>(params.disparities));
}

// Key of disparity number `index` of a pixel.
fn key_of(span: Span, index: u32) -> u32 {
    let word = index / 4u - span.first;
    if word >= span.count {
        return NO_KEY;
    }
    let sums = sums_at(span.start + word);
    return keys_of(sums.even[word % GRAIN], sums.odd[word % GRAIN], index / 4u)[index % 4u];
}

// Whether disparity number `index` is at an end of the range of its cell that is no end of the whole range.
fn is_cut_off(span: Span, index: u32) -> bool {
    let end = 4u * (span.first + span.count);
    return (index == 4u * span.first && index > 0u) || (index + 1u == end && end < params.disparities);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let first_x = 4u * id.x;
    if first_x >= params.width || id.y >= params.rows {
        return;
    }
    var confidences = 0u;
    for (var t = 0u; t < min(4u, params.width - first_x); t++) {
        let x = first_x + t;
        let span = span_at(x, params.top + id.y);
        // The two smallest keys among every fourth disparity. The rival is one of them: two disparities of one column
        // are at least four apart, so that at most one of a column is the winner or beside it.
        var smallest = vec4<u32>(NO_KEY);
        var second = vec4<u32>(NO_KEY);
        for (var k = 0u; k < span.count; k += GRAIN) {
            let sums = sums_at(span.start + k);
            for (var j = 0; j < GRAIN; j++) { // unroll
                let keys = keys_of(sums.even[j], sums.odd[j], span.first + k + j);
                second = min(second, max(smallest, keys));
                smallest = min(smallest, keys);
            }
        }
        let best = min(min(smallest.x, smallest.y), min(smallest.z, smallest.w));
        let winner = best & INDEX_MASK;
        let is_near = (smallest & vec4<u32>(INDEX_MASK)) - vec4<u32>(winner) + vec4<u32>(1u) <= vec4<u32>(2u);
        let rivals = select(smallest, second, is_near);
        let rival = min(min(rivals.x, rivals.y), min(rivals.z, rivals.w));
        let kept = select(best, NO_KEY, is_cut_off(span, winner));
        let result = disparity_and_confidence(kept, rival, key_of(span, winner - 1u), key_of(span, winner + 1u));
        let pixel = id.y * params.width + x;
        matches[pixel] = result.x;
        confidences |= result.y << (8u * t);
        if KEYS != 0 {
            matches[params.key_offset + pixel] = kept;
        }
    }
    if FULL != 0 {
        matches[params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x] = confidences;
    }
}
