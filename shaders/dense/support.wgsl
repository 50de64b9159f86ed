// Support (support_rule.wgsl) where a thread walks down rows and keeps its windows in registers: for lavapipe. For GPUs:
// tile_support.wgsl.

#import support_rule

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels
//   SIDE               side of the window: 2 RADIUS + 1, in pixels
//   SPAN               pixels per row of four windows: SIDE + 3
//   KEPT               rows of a window that the window one row below shares: SIDE - 1
//   ROWS               rows of pixels per thread
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
    row.residuals = residual_sums(words);
    return row;
}

fn counts(window: array<Row, SIDE>) -> Counts {
    let own = window[RADIUS].disparities;
    let centre = vec4<i32>(own[RADIUS], own[RADIUS + 1], own[RADIUS + 2], own[RADIUS + 3]);
    var counts: Counts;
    for (var j = 0; j < SIDE; j++) { // unroll
        for (var i = 0; i < SIDE; i++) { // unroll
            let row = window[j].disparities;
            let others = vec4<i32>(row[i], row[i + 1], row[i + 2], row[i + 3]);
            counts = with_others(counts, others, centre);
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
        var residual_sum = vec4<u32>(0u);
        for (var j = 0; j < 5; j++) { // unroll
            residual_sum += window[RADIUS - 2 + j].residuals;
        }
        let own = window[RADIUS].disparities;
        let centre = vec4<i32>(own[RADIUS], own[RADIUS + 1], own[RADIUS + 2], own[RADIUS + 3]);
        store(vec2<i32>(x, y), centre, counts, residual_sum);
    }
}
