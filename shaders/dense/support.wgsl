// Removes speckles without following their outlines: a disparity stays if at least LEAST pixels of its window, the
// pixel itself included, have a disparity that differs by at most TOLERANCE. With MAJORITY, at least half of the window
// within the picture must have a disparity that is at most twice TOLERANCE larger, too: what is beside holes, or just
// behind something nearer, is often wrong, but a thin thing in front of others is not.
//
// Confidence of a disparity with n pixels within TOLERANCE: 1 + 5 (n - 1), plus up to 4 for the confidence so far, minus
// an eighth of the sum of the photometric residuals in the 5x5 window; at least MEASURED.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels
//   SIDE               side of the window: 2 RADIUS + 1, in pixels
//   SPAN               pixels per row of four windows: SIDE + 3
//   KEPT               rows of a window that the window one row below shares: SIDE - 1
//   ROWS               rows of pixels per thread
//   TOLERANCE          largest difference of disparities, in 1/256 px
//   LEAST              supporting pixels, at least
//   MAJORITY           1: half of the window must be at most twice TOLERANCE nearer; 0: it need not
//   MEASURED           least confidence of a disparity
//   NONE               sentinel: the pixel has no disparity
//   FAR                sentinel farther than twice TOLERANCE from any disparity: no disparity

struct Params {
    width: u32,
    height: u32,
    // Index of the first u32 of the confidences in `matches` and `supported`.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point. Then the confidences, four packed per u32.
@group(0) @binding(1) var<storage, read> matches: array<i32>;
// Residuals, four packed per u32, rows of ceil(width / 4) u32; bytes beyond the width are 0.
@group(0) @binding(2) var<storage, read> residuals: array<u32>;
// Disparities and confidences, laid out as `matches`.
@group(0) @binding(3) var<storage, read_write> supported: array<i32>;

struct Row {
    // Disparities of the thread's four pixels and RADIUS columns on either side; FAR for pixels without a disparity.
    disparities: array<i32, SPAN>,
    // Per pixel of the thread: sum of the residuals of the pixel and two columns on either side.
    residuals: vec4<u32>,
}

// Row y of the windows of the four pixels from column x on.
fn row_at(x: i32, y: i32) -> Row {
    let width = i32(params.width);
    let height = i32(params.height);
    let inside_row = clamp(y, 0, height - 1);
    let is_row = y == inside_row;
    var row: Row;
    for (var i = 0; i < SPAN; i++) { // unroll
        let column = x + i - RADIUS;
        let inside = clamp(column, 0, width - 1);
        let disparity = matches[inside_row * width + inside];
        row.disparities[i] = select(FAR, disparity, is_row & (column == inside) & (disparity != NONE));
    }
    let stride = (width + 3) / 4;
    var words: vec3<u32>;
    for (var i = 0; i < 3; i++) { // unroll
        let word = x / 4 + i - 1;
        let inside = clamp(word, 0, stride - 1);
        words[i] = select(0u, residuals[inside_row * stride + inside], is_row & (word == inside));
    }
    let before = (words.xx >> vec2<u32>(16u, 24u)) & vec2<u32>(255u);
    let own = (words.yyyy >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
    let after = (words.zz >> vec2<u32>(0u, 8u)) & vec2<u32>(255u);
    row.residuals = vec4<u32>(own.x + own.y + own.z)
        + vec4<u32>(before.x + before.y, before.y + own.w, own.w + after.x, own.w + after.x + after.y - own.x);
    return row;
}

// Pixels of the windows of the thread's four pixels.
struct Counts {
    // Those whose disparities differ by at most TOLERANCE.
    alike: vec4<u32>,
    // Those whose disparities are at most twice TOLERANCE larger.
    not_nearer: vec4<u32>,
}

fn counts(window: array<Row, SIDE>) -> Counts {
    let own = window[RADIUS].disparities;
    let centre = vec4<i32>(own[RADIUS], own[RADIUS + 1], own[RADIUS + 2], own[RADIUS + 3]);
    var counts: Counts;
    for (var j = 0; j < SIDE; j++) { // unroll
        for (var i = 0; i < SIDE; i++) { // unroll
            let row = window[j].disparities;
            let other = vec4<i32>(row[i], row[i + 1], row[i + 2], row[i + 3]);
            let nearer = other - centre;
            counts.alike += select(vec4<u32>(0u), vec4<u32>(1u), abs(nearer) <= vec4<i32>(TOLERANCE));
            if MAJORITY != 0 {
                counts.not_nearer += select(vec4<u32>(0u), vec4<u32>(1u), nearer <= vec4<i32>(2 * TOLERANCE));
            }
        }
    }
    return counts;
}

// One thread decides 4 x ROWS pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let first = ROWS * i32(id.y);
    let width = i32(params.width);
    let height = i32(params.height);
    if x >= width || first >= height {
        return;
    }
    var window: array<Row, SIDE>;
    var missing = SIDE;
    for (var y = first; y < min(first + ROWS, height); y++) {
        // All rows of the first window, one more row for each later window.
        for (; missing > 0; missing--) {
            for (var j = 0; j < KEPT; j++) { // unroll
                window[j] = window[j + 1];
            }
            window[KEPT] = row_at(x, y + RADIUS + 1 - missing);
        }
        missing = 1;
        let counts = counts(window);
        let count = counts.alike;
        var is_shared = vec4<bool>(true);
        if MAJORITY != 0 {
            let columns = vec4<i32>(x, x + 1, x + 2, x + 3);
            let left = max(columns - RADIUS, vec4<i32>(0));
            let right = min(columns + RADIUS, vec4<i32>(width - 1));
            let rows = min(y + RADIUS, height - 1) - max(y - RADIUS, 0) + 1;
            let pixels = rows * (right - left + 1);
            is_shared = 2u * counts.not_nearer >= vec4<u32>(pixels);
        }
        var residual_sum = vec4<u32>(0u);
        for (var j = 0; j < 5; j++) { // unroll
            residual_sum += window[RADIUS - 2 + j].residuals;
        }
        let word = params.confidence_offset + u32(y) * ((params.width + 3u) / 4u) + id.x;
        let confidences = u32(matches[word]);
        var new_confidences = 0u;
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < width {
                let disparity = window[RADIUS].disparities[RADIUS + t];
                let stays = (disparity != FAR) & (count[t] >= LEAST) & is_shared[t];
                supported[y * width + x + t] = select(NONE, disparity, stays);
                let margin = (5u * ((confidences >> (8u * t)) & 255u)) >> 8u;
                let confidence = 5u * count[t] - 4u + margin;
                let lowered = max(confidence - min(residual_sum[t] >> 3u, confidence), MEASURED);
                new_confidences |= select(0u, lowered, stays) << (8u * t);
            }
        }
        supported[word] = i32(new_confidences);
    }
}
