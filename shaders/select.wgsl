// From the costs of all paths to a disparity: their sum, winner-take-all, uniqueness, sub-pixel.
//
// A thread decides four pixels of a row; the volume holds four disparities a word.

struct Params {
    width: u32,
    rows: u32,
    // Words a pixel of each volume.
    words: u32,
    // Where the band begins in the first volume, and how far it is from one volume to the next.
    start: u32,
    volume_words: u32,
    min_disparity: i32,
    disparities: u32,
    uniqueness: u32,
    // Where the confidences begin, four a word.
    confidence_offset: u32,
    // Where the winners' keys begin, a word a pixel.
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> volumes: array<u32>;
// A fixed-point disparity a pixel; if FULL, a confidence a pixel, 0 to 255, four a word; if KEYS, the
// winner's key a pixel.
@group(0) @binding(2) var<storage, read_write> matches: array<i32>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    if x >= params.width || id.y >= params.rows {
        return;
    }
    let row = id.y * params.width;
    let pixels = vec4<u32>(row) + min(vec4<u32>(x) + vec4<u32>(0u, 1u, 2u, 3u), vec4<u32>(params.width - 1u));
    let first = vec4<u32>(params.start) + params.words * pixels;
    let nothing = vec4<u32>(NOTHING);
    var search = Search(nothing, nothing, nothing, nothing, nothing);
    var last_won = vec4<bool>(false);
    for (var step = 0u; step < params.words; step++) {
        // The even and the odd disparities, two sums of 16 bits a word.
        var even = vec4<u32>(0u);
        var odd = vec4<u32>(0u);
        for (var p = 0; p < PATHS; p++) { // unroll
            let at = first + vec4<u32>(step + p * params.volume_words);
            let word = vec4<u32>(volumes[at.x], volumes[at.y], volumes[at.z], volumes[at.w]);
            even += word & vec4<u32>(0x00ff00ffu);
            odd += (word >> vec4<u32>(8u)) & vec4<u32>(0x00ff00ffu);
        }
        let sums = array<vec4<u32>, 4>(
            even << vec4<u32>(16u), odd << vec4<u32>(16u),
            even & vec4<u32>(0xffff0000u), odd & vec4<u32>(0xffff0000u),
        );
        for (var k = 0; k < 4; k++) { // unroll
            let index = 4u * step + k;
            let key = select(nothing, sums[k] | vec4<u32>(index), index < params.disparities);
            let wins = key < best_of(search);
            search = consider(search, key, wins, last_won);
            last_won = wins;
        }
    }
    let best = best_of(search);
    let answers = array<vec2<u32>, 4>(
        answer(best.x, search.rival.x, search.below.x, search.above.x),
        answer(best.y, search.rival.y, search.below.y, search.above.y),
        answer(best.z, search.rival.z, search.below.z, search.above.z),
        answer(best.w, search.rival.w, search.below.w, search.above.w),
    );
    var word = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < params.width {
            matches[row + x + t] = i32(answers[t].x);
            word |= answers[t].y << (8u * t);
            if KEYS != 0 {
                matches[params.key_offset + row + x + t] = i32(best[t]);
            }
        }
    }
    if FULL != 0 {
        matches[params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x] = i32(word);
    }
}
