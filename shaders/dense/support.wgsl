// Takes away the disparities that hardly any of their neighbours share: speckles, without having to
// follow their outlines. A disparity stays if at least LEAST pixels of the window around it, itself
// included, have one that differs by at most TOLERANCE. Their number becomes the better part of its
// confidence: 1 + 5 (number - 1), up to 4 more for what its confidence was, and less by an eighth of the
// photometric residuals of the 5x5 around it; at least 1.

struct Params {
    width: u32,
    height: u32,
    // Where the confidences begin, four a word.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A fixed-point disparity a pixel, then a confidence a pixel, four a word.
@group(0) @binding(1) var<storage, read> matches: array<i32>;
// Four a word, rows of (width + 3) / 4 words; 0 beyond the width.
@group(0) @binding(2) var<storage, read> residuals: array<u32>;
@group(0) @binding(3) var<storage, read_write> supported: array<i32>;

struct Row {
    // From RADIUS columns left of a thread's four pixels to RADIUS right of them; FAR where there is none.
    disparities: array<i32, SPAN>,
    // The sums of the residuals from two columns left of each of the pixels to two right of it.
    residuals: vec4<u32>,
}

fn row_at(x: i32, y: i32) -> Row {
    let width = i32(params.width);
    let height = i32(params.height);
    let nearest_row = clamp(y, 0, height - 1);
    let is_row = y == nearest_row;
    var row: Row;
    for (var i = 0; i < SPAN; i++) { // unroll
        let column = x + i - RADIUS;
        let nearest = clamp(column, 0, width - 1);
        let disparity = matches[nearest_row * width + nearest];
        row.disparities[i] = select(FAR, disparity, is_row & (column == nearest) & (disparity != NONE));
    }
    let stride = (width + 3) / 4;
    var words: vec3<u32>;
    for (var i = 0; i < 3; i++) { // unroll
        let word = x / 4 + i - 1;
        let nearest = clamp(word, 0, stride - 1);
        words[i] = select(0u, residuals[nearest_row * stride + nearest], is_row & (word == nearest));
    }
    let before = (words.xx >> vec2<u32>(16u, 24u)) & vec2<u32>(255u);
    let own = (words.yyyy >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
    let after = (words.zz >> vec2<u32>(0u, 8u)) & vec2<u32>(255u);
    row.residuals = vec4<u32>(own.x + own.y + own.z)
        + vec4<u32>(before.x + before.y, before.y + own.w, own.w + after.x, own.w + after.x + after.y - own.x);
    return row;
}

// How many pixels of their windows share the disparities of the thread's pixels.
fn sharing(window: array<Row, SIDE>) -> vec4<u32> {
    let own = window[RADIUS].disparities;
    let centre = vec4<i32>(own[RADIUS], own[RADIUS + 1], own[RADIUS + 2], own[RADIUS + 3]);
    var count = vec4<u32>(0u);
    for (var j = 0; j < SIDE; j++) { // unroll
        for (var i = 0; i < SIDE; i++) { // unroll
            let row = window[j].disparities;
            let other = vec4<i32>(row[i], row[i + 1], row[i + 2], row[i + 3]);
            count += select(vec4<u32>(0u), vec4<u32>(1u), abs(other - centre) <= vec4<i32>(TOLERANCE));
        }
    }
    return count;
}

// A thread decides four pixels of a row, and those below them in ROWS rows.
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
    for (var j = 0; j < KEPT; j++) { // unroll
        window[j + 1] = row_at(x, first + j - RADIUS);
    }
    for (var y = first; y < min(first + ROWS, height); y++) {
        for (var j = 0; j < KEPT; j++) { // unroll
            window[j] = window[j + 1];
        }
        window[KEPT] = row_at(x, y + RADIUS);
        let count = sharing(window);
        var unlike = vec4<u32>(0u);
        for (var j = 0; j < 5; j++) { // unroll
            unlike += window[RADIUS - 2 + j].residuals;
        }
        let word = params.confidence_offset + u32(y) * ((params.width + 3u) / 4u) + id.x;
        let confidences = u32(matches[word]);
        var confident = 0u;
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < width {
                let disparity = window[RADIUS].disparities[RADIUS + t];
                let stays = (disparity != FAR) & (count[t] >= LEAST);
                supported[y * width + x + t] = select(NONE, disparity, stays);
                let margin = (5u * ((confidences >> (8u * t)) & 255u)) >> 8u;
                let confidence = 5u * count[t] - 4u + margin;
                let lowered = confidence - min(unlike[t] >> 3u, confidence - 1u);
                confident |= select(0u, lowered, stays) << (8u * t);
            }
        }
        supported[word] = i32(confident);
    }
}
