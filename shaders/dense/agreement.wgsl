// Agreement: drops disparities that too few neighbours share. The neighbours are the pixel itself and the eight pixels
// REACH columns, rows, or both away: near enough to lie on one surface, and so far apart that what misleads one matching
// window hardly misleads all. Pixels outside the picture do not agree.

#import words

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   REACH              distance of the neighbours, in pixels
//   QUADS              quads of four neighbouring pixels per row of a thread
//   SPAN               pixels per row of a thread and its neighbours: 4 QUADS + 2 REACH
//   ROWS               rows of pixels per thread, REACH apart
//   TOLERANCE          largest difference of disparities that agree, in 1/256 px
//   NONE               sentinel: the pixel has no disparity
//   FAR                sentinel farther than TOLERANCE from any disparity: no disparity

struct Params {
    width: u32,
    height: u32,
    // Index of the first u32 of the confidences in `words` and `matches`.
    confidence_offset: u32,
    // Agreeing pixels of the nine, at least.
    least: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// The map as it was: one i32 per pixel, the disparity, fixed-point; then the confidences, four packed per u32, each row in
// u32 of its own.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
// The same map, from which disparities are dropped.
@group(0) @binding(2) var<storage, read_write> matches: array<i32>;

// Disparities of a thread's pixels and of their neighbours in the row; FAR for pixels without a disparity.
alias Row = array<i32, SPAN>;

// Row y of the windows of the pixels from column x on.
fn row_at(x: i32, y: i32) -> Row {
    let width = i32(params.width);
    let inside_row = clamp(y, 0, i32(params.height) - 1);
    let is_row = y == inside_row;
    var row: Row;
    for (var i = 0; i < SPAN; i++) { // unroll
        let column = x + i - REACH;
        let inside = clamp(column, 0, width - 1);
        let disparity = i32(word_at(u32(inside_row * width + inside)));
        row[i] = select(FAR, disparity, is_row & (column == inside) & (disparity != NONE));
    }
    return row;
}

// Per pixel of a thread's row `own`: how many of the three pixels of `row` agree that lie in the pixel's column and REACH
// columns to either side.
fn agreeing(row: Row, own: Row) -> array<vec4<u32>, QUADS> {
    var counts: array<vec4<u32>, QUADS>;
    for (var q = 0; q < QUADS; q++) { // unroll
        let at = 4 * q + REACH;
        let disparities = vec4<i32>(own[at], own[at + 1], own[at + 2], own[at + 3]);
        for (var k = 0; k < 3; k++) { // unroll
            let there = 4 * q + REACH * k;
            let others = vec4<i32>(row[there], row[there + 1], row[there + 2], row[there + 3]);
            let agree = abs(others - disparities) <= vec4<i32>(TOLERANCE);
            counts[q] += select(vec4<u32>(0u), vec4<u32>(1u), agree);
        }
    }
    return counts;
}

// One thread checks 4 QUADS x ROWS pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * QUADS * i32(id.x);
    let width = i32(params.width);
    let height = i32(params.height);
    // REACH threads take turns with the rows, so that each row is loaded once.
    let first = i32(id.y) / REACH * REACH * ROWS + i32(id.y) % REACH;
    if x >= width || first >= height {
        return;
    }
    var above = row_at(x, first - REACH);
    var own = row_at(x, first);
    for (var i = 0; i < ROWS; i++) {
        let y = first + REACH * i;
        if y >= height {
            return;
        }
        let below = row_at(x, y + REACH);
        let of_above = agreeing(above, own);
        let of_own = agreeing(own, own);
        let of_below = agreeing(below, own);
        for (var q = 0; q < QUADS; q++) { // unroll
            let column = x + 4 * q;
            let count = of_above[q] + of_own[q] + of_below[q];
            let word = params.confidence_offset + u32(y) * ((params.width + 3u) / 4u) + u32(column) / 4u;
            var kept = 0u;
            for (var t = 0; t < 4; t++) { // unroll
                let stays = count[t] >= params.least;
                kept |= select(0u, 255u << (8u * t), stays);
                if !stays && column + t < width {
                    matches[y * width + column + t] = NONE;
                }
            }
            if column < width {
                matches[word] = i32(word_at(word) & kept);
            }
        }
        above = own;
        own = below;
    }
}
