// Removes speckles without following their outlines: a disparity stays if at least LEAST pixels of its window, the
// pixel itself included, have a disparity that differs by at most TOLERANCE. With MAJORITY, at least half of the window
// within the picture must have a disparity that is at most twice TOLERANCE larger, too: what is beside holes, or just
// behind something nearer, is often wrong, but a thin thing in front of others is not.
//
// Confidence of a disparity with n pixels within TOLERANCE: 1 + 5 (n - 1), plus up to 4 for the confidence so far, minus
// an eighth of the sum of the photometric residuals in the 5x5 window; at least MEASURED.

// The module has `params` with `width`, `height` and `confidence_offset`, the index of the first u32 of the confidences;
// `matches`, the map, disparities and then confidences; and `supported`, the map that is written.

// Constants:
//   RADIUS             radius of the window, in pixels
//   TOLERANCE          largest difference of disparities, in 1/256 px
//   LEAST              supporting pixels, at least
//   MAJORITY           1: half of the window must be at most twice TOLERANCE nearer; 0: it need not
//   MEASURED           least confidence of a disparity
//   NONE               sentinel: the pixel has no disparity
//   FAR                sentinel farther than twice TOLERANCE from any disparity: no disparity

// Pixels of the windows of four pixels.
struct Counts {
    // Those whose disparities differ by at most TOLERANCE.
    alike: vec4<u32>,
    // Those whose disparities are at most twice TOLERANCE larger.
    not_nearer: vec4<u32>,
}

// Counts one pixel more of each window: with disparities `others`, where the pixels in the centre have `centre`.
fn with_others(counts: Counts, others: vec4<i32>, centre: vec4<i32>) -> Counts {
    var more = counts;
    let nearer = others - centre;
    more.alike += select(vec4<u32>(0u), vec4<u32>(1u), abs(nearer) <= vec4<i32>(TOLERANCE));
    if MAJORITY != 0 {
        more.not_nearer += select(vec4<u32>(0u), vec4<u32>(1u), nearer <= vec4<i32>(2 * TOLERANCE));
    }
    return more;
}

// Per pixel of the second of three packed words of a row: sum of the residuals of the pixel and two columns on either side.
fn residual_sums(words: vec3<u32>) -> vec4<u32> {
    let before = (words.xx >> vec2<u32>(16u, 24u)) & vec2<u32>(255u);
    let own = (words.yyyy >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
    let after = (words.zz >> vec2<u32>(0u, 8u)) & vec2<u32>(255u);
    return vec4<u32>(own.x + own.y + own.z)
        + vec4<u32>(before.x + before.y, before.y + own.w, own.w + after.x, own.w + after.x + after.y - own.x);
}

// Decides about the four pixels from `at` on, with disparities `centre`, and writes what they keep.
fn store(at: vec2<i32>, centre: vec4<i32>, counts: Counts, residual_sum: vec4<u32>) {
    let width = i32(params.width);
    let height = i32(params.height);
    let count = counts.alike;
    var is_shared = vec4<bool>(true);
    if MAJORITY != 0 {
        let columns = vec4<i32>(at.x, at.x + 1, at.x + 2, at.x + 3);
        let left = max(columns - RADIUS, vec4<i32>(0));
        let right = min(columns + RADIUS, vec4<i32>(width - 1));
        let rows = min(at.y + RADIUS, height - 1) - max(at.y - RADIUS, 0) + 1;
        let pixels = rows * (right - left + 1);
        is_shared = 2u * counts.not_nearer >= vec4<u32>(pixels);
    }
    let word = params.confidence_offset + u32(at.y) * ((params.width + 3u) / 4u) + u32(at.x) / 4u;
    let confidences = u32(matches[word]);
    var new_confidences = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        if at.x + t < width {
            let disparity = centre[t];
            let stays = (disparity != FAR) & (count[t] >= LEAST) & is_shared[t];
            supported[at.y * width + at.x + t] = select(NONE, disparity, stays);
            let margin = (5u * ((confidences >> (8u * t)) & 255u)) >> 8u;
            let confidence = 5u * count[t] - 4u + margin;
            let lowered = max(confidence - min(residual_sum[t] >> 3u, confidence), MEASURED);
            new_confidences |= select(0u, lowered, stays) << (8u * t);
        }
    }
    supported[word] = i32(new_confidences);
}
