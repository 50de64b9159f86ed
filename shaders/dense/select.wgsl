// The last path of semi-global matching, and from the costs of all paths to a disparity: their sum,
// winner-take-all, uniqueness, sub-pixel. What the last path costs is needed by nobody else, and not
// stored.

#import selection
#import line

struct Params {
    width: u32,
    // Of the band, and the row of the picture where it begins.
    rows: u32,
    first_row: u32,
    // Where the band begins in the volume of this path.
    path_start: u32,
    // Whether the row before the band's first one holds where the lines come from.
    goes_on: u32,
    // To the next pixel of a line, each -1, 0 or 1.
    dx: i32,
    dy: i32,
    // What follows is for the selection. Where the first path's volume begins, and how far it is to the next.
    volumes_start: u32,
    volume_words: u32,
    min_disparity: i32,
    disparities: u32,
    uniqueness: u32,
    // Where the confidences begin, four a word, and the winners' keys, a word a pixel.
    confidence_offset: u32,
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A word a pixel: the luma in the lowest byte.
@group(0) @binding(1) var<storage, read> reference: array<u32>;
// Four disparities a word, WORDS words a pixel, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<u32>;
@group(0) @binding(3) var<storage, read_write> paths: array<u32>;
// A fixed-point disparity a pixel; if FULL, a confidence a pixel, 0 to 255, four a word; if KEYS, the
// winner's key a pixel.
@group(0) @binding(4) var<storage, read_write> matches: array<atomic<u32>>;

// The keys of a pixel's disparities.
alias Keys = array<vec4<u32>, WORDS>;

// The sums of the stored paths and of this one, `words`.
fn keys_of(pixel: u32, words: array<u32, WORDS>) -> Keys {
    var keys: Keys;
    for (var k = 0; k < WORDS; k++) { // unroll
        // The even and the odd disparities, two sums of 16 bits a word.
        var even = words[k] & 0x00ff00ffu;
        var odd = (words[k] >> 8u) & 0x00ff00ffu;
        for (var p = 0; p < STORED; p++) { // unroll
            let word = paths[params.volumes_start + p * params.volume_words + pixel * WORDS + k];
            even += word & 0x00ff00ffu;
            odd += (word >> 8u) & 0x00ff00ffu;
        }
        let index = vec4<u32>(4u * k) + vec4<u32>(0u, 1u, 2u, 3u);
        let sums = vec4<u32>(even << 16u, odd << 16u, even & 0xffff0000u, odd & 0xffff0000u);
        keys[k] = select(vec4<u32>(NOTHING), sums | index, index < vec4<u32>(params.disparities));
    }
    return keys;
}

fn best_key(keys: Keys) -> u32 {
    var best = vec4<u32>(NOTHING);
    for (var k = 0; k < WORDS; k++) { // unroll
        best = min(best, keys[k]);
    }
    return min(min(best.x, best.y), min(best.z, best.w));
}

// The keys that the winner is compared with: its best rival, two or more disparities away, and its
// two neighbours.
fn others_of(keys: Keys, best: u32) -> vec3<u32> {
    let nothing = vec4<u32>(NOTHING);
    let winner = vec4<u32>(best & INDEX_MASK);
    var rival = nothing;
    var below = nothing;
    var above = nothing;
    for (var k = 0; k < WORDS; k++) { // unroll
        let index = vec4<u32>(4u * k) + vec4<u32>(0u, 1u, 2u, 3u);
        let is_below = index + 1u == winner;
        let is_above = index == winner + 1u;
        below = select(below, keys[k], is_below);
        above = select(above, keys[k], is_above);
        rival = min(rival, select(keys[k], nothing, is_below | is_above | (index == winner)));
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
    var line = begin(id.x);
    for (var i = 0u; i < line_length(); i++) {
        let here = luma_at(line);
        let words = follow(line, here);
        let pixel = u32(line.y) * params.width + u32(line.x);
        let keys = keys_of(pixel, words);
        let best = best_key(keys);
        let others = others_of(keys, best);
        let found = answer(best, others.x, others.y, others.z);
        atomicStore(&matches[pixel], found.x);
        if FULL != 0 {
            let x = u32(line.x);
            let word = params.confidence_offset + u32(line.y) * ((params.width + 3u) / 4u) + x / 4u;
            atomicOr(&matches[word], found.y << (8u * (x % 4u)));
        }
        if KEYS != 0 {
            atomicStore(&matches[params.key_offset + pixel], best);
        }
        line = next_of(line, words, here);
    }
}
