// Takes away the disparities that hardly any of their neighbours share: speckles, without having to
// follow their outlines. A disparity stays if at least LEAST pixels of the window around it, itself
// included, have one that differs by at most TOLERANCE. Their number becomes the better part of its
// confidence: 1 + 5 (number - 1), and up to 4 more for what its confidence was.

struct Params {
    width: u32,
    height: u32,
    // Where the confidences begin, four a word.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A fixed-point disparity a pixel, then a confidence a pixel, four a word.
@group(0) @binding(1) var<storage, read> matches: array<i32>;
@group(0) @binding(2) var<storage, read_write> supported: array<i32>;

// The disparities of a row, from RADIUS columns left of a thread's four pixels to RADIUS right of them; FAR where
// there is none.
alias Row = array<i32, SPAN>;

fn row_at(x: i32, y: i32) -> Row {
    let width = i32(params.width);
    let height = i32(params.height);
    let start = clamp(y, 0, height - 1) * width;
    let is_row = (y >= 0) & (y < height);
    var row: Row;
    for (var i = 0; i < SPAN; i++) { // unroll
        let column = x + i - RADIUS;
        let nearest = clamp(column, 0, width - 1);
        let disparity = matches[start + nearest];
        row[i] = select(FAR, disparity, is_row & (column == nearest) & (disparity != NONE));
    }
    return row;
}

// How many pixels of their windows share the disparities of the thread's pixels.
fn sharing(window: array<Row, SIDE>) -> vec4<u32> {
    let own = window[RADIUS];
    let centre = vec4<i32>(own[RADIUS], own[RADIUS + 1], own[RADIUS + 2], own[RADIUS + 3]);
    var count = vec4<u32>(0u);
    for (var j = 0; j < SIDE; j++) { // unroll
        for (var i = 0; i < SIDE; i++) { // unroll
            let other = vec4<i32>(window[j][i], window[j][i + 1], window[j][i + 2], window[j][i + 3]);
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
        let word = params.confidence_offset + u32(y) * ((params.width + 3u) / 4u) + id.x;
        let confidences = u32(matches[word]);
        var confident = 0u;
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < width {
                let disparity = window[RADIUS][RADIUS + t];
                let stays = (disparity != FAR) & (count[t] >= LEAST);
                supported[y * width + x + t] = select(NONE, disparity, stays);
                let margin = (5u * ((confidences >> (8u * t)) & 255u)) >> 8u;
                confident |= select(0u, 5u * count[t] - 4u + margin, stays) << (8u * t);
            }
        }
        supported[word] = i32(confident);
    }
}
