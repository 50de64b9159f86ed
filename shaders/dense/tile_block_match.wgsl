// Block matching, for devices with many threads: the sum of absolute differences (SAD) over a square window,
// winner-take-all, uniqueness check and sub-pixel interpolation in one pass that stores no cost volume. The result is that
// of block_match.wgsl.
//
// One thread owns a column of four pixels, a workgroup 64 columns side by side, and visits the disparities, four per step. The
// sums of differences along the columns of the windows, which slide down the rows, go through workgroup memory, where each
// thread adds those of its windows. No loop over the window is unrolled: code does not grow with the window.

#import selection
#import block_search
#import words

// Constants:
//   COLUMNS     columns of pixels per workgroup: threads per workgroup
//   ROWS        pixels per thread, one below the other: 4
//   SIDE        side of the window, in pixels
//   FIRST       pixel of a padded row, after the first u32 of the tile's row, at which the window of the first column begins
//   DIRECTION   partner column = column + DIRECTION * disparity: -1 if the reference is the left view, 1 if the right view
//   SHIFT       bits of a disparity's index in a key
//   FULL        1: disparities, checked and interpolated, and confidences; 0: the winners' whole disparities alone
//   NONE        sentinel: the pixel has no disparity

struct Params {
    width: u32,
    rows: u32,
    // u32 per row of the padded planes.
    stride: u32,
    // Indices of the first u32 of the first window in the reference plane, and of its partner at the first disparity
    // visited in the searched plane. Steps begin at whole u32, so that up to three disparities precede the range.
    reference_start: u32,
    searched_start: u32,
    min_disparity: i32,
    // Disparities visited before the range begins, 0 to 3.
    skipped: u32,
    // log2 of the side of a cell of `ranges`, in pixels.
    cell_shift: u32,
    cell_columns: u32,
    // Uniqueness: least excess of the rival's cost over the winner's cost, in per cent.
    uniqueness: u32,
    // Index of the first u32 of the confidences in `matches`.
    confidence_offset: u32,
    // Largest difference of the disparities of both views, in 1/256 px; all ones: no consistency check.
    max_difference: u32,
    // Row of the other view's map that the band's first row meets, and width of the map.
    others_first_row: i32,
    others_width: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Padded planes of both views, four pixels packed per u32.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
// Range searched in each cell of the picture: index of the first disparity, number of disparities.
@group(0) @binding(2) var<storage, read> ranges: array<vec2<u32>>;
// One u32 per pixel: the other view's disparity, fixed-point. Not read without consistency check.
@group(0) @binding(3) var others: texture_storage_2d<r32uint, read>;
// One i32 per pixel: the disparity, fixed-point. Then, if FULL, the confidences, 0 to 255, four packed per u32, each
// row in u32 of its own.
@group(0) @binding(4) var<storage, read_write> matches: array<i32>;

// Columns of the windows of a workgroup.
const ALL_COLUMNS = COLUMNS + SIDE - 1;

// Sums of the absolute differences along a column of the windows of each row, for a step's four disparities.
var<workgroup> columns: array<array<vec4<u32>, ALL_COLUMNS>, ROWS>;

// Absolute differences, SHIFT bits up, of a pixel of the padded reference plane, which stands in u32 number `place / 4`, and
// its partners at four disparities, the first of which is pixel number `partner` of the padded searched plane.
fn differences(place: u32, partner: u32) -> vec4<u32> {
    let reference = ((word_at(place / 4u) >> (8u * (place % 4u))) & 255u) << SHIFT;
    // The four partners in the order of their columns.
    let first = select(partner, partner - 3u, DIRECTION < 0);
    let shift = 8u * (first % 4u);
    // A shift by 32 bits in two.
    let later = (word_at(first / 4u + 1u) << (31u - shift)) << 1u;
    let partners = unpack((word_at(first / 4u) >> shift) | later);
    let distances = vec4<u32>(abs(vec4<i32>(i32(reference)) - partners));
    return select(distances, distances.wzyx, DIRECTION < 0);
}

// Writes the column sums of one column of the windows, of all rows, for a step.
fn sum_column(column: u32, reference_place: u32, partner_place: u32) {
    let row = 4u * params.stride;
    var sum = vec4<u32>(0u);
    for (var j = 0u; j < SIDE; j++) {
        sum += differences(reference_place + j * row, partner_place + j * row);
    }
    columns[0][column] = sum;
    for (var y = 1u; y < ROWS; y++) {
        let leaving = (y - 1u) * row;
        let entering = leaving + SIDE * row;
        sum += differences(reference_place + entering, partner_place + entering)
            - differences(reference_place + leaving, partner_place + leaving);
        columns[y][column] = sum;
    }
}

// Step with which the search of a workgroup begins, and the step behind the last: those of all cells that it meets.
fn steps_of(x: u32, y: u32) -> vec2<u32> {
    let cells = (y >> params.cell_shift) * params.cell_columns;
    var steps = vec2<u32>(0xffffffffu, 0u);
    for (var cell = x >> params.cell_shift; cell <= (min(x + COLUMNS, params.width) - 1u) >> params.cell_shift; cell++) {
        let range = ranges[cells + cell];
        let first = params.skipped + range.x;
        steps = vec2<u32>(min(steps.x, first / 4u), max(steps.y, (first + range.y + 3u) / 4u));
    }
    return steps;
}

@compute @workgroup_size(COLUMNS)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let first_x = COLUMNS * group.x;
    let first_y = ROWS * group.y;
    let x = first_x + thread;
    let own = min(x, params.width - 1u);
    let range = ranges[(first_y >> params.cell_shift) * params.cell_columns + (own >> params.cell_shift)];
    let steps = steps_of(first_x, first_y);
    let reference_place = 4u * (params.reference_start + first_y * params.stride) + FIRST + x;
    let searched_place = 4u * (params.searched_start + first_y * params.stride) + FIRST + x;

    // The four pixels of the column.
    let no_key = vec4<u32>(NO_KEY);
    var search = Search(no_key, no_key, no_key, no_key, no_key);
    for (var step = steps.x; step < steps.y; step++) {
        let partner = searched_place + u32(4 * DIRECTION * i32(step));
        sum_column(thread, reference_place, partner);
        for (var column = thread + COLUMNS; column < ALL_COLUMNS; column += COLUMNS) {
            sum_column(column, reference_place + (column - thread), partner + (column - thread));
        }
        workgroupBarrier();
        var windows: array<vec4<u32>, ROWS>;
        for (var n = 0; n < ROWS; n++) { // unroll
            var sum = vec4<u32>(0u);
            for (var i = 0u; i < SIDE; i++) {
                sum += columns[n][thread + i];
            }
            windows[n] = sum;
        }
        workgroupBarrier();
        var last_won = search.previous < search.before;
        for (var k = 0; k < 4; k++) { // unroll
            // The disparity's index, or all ones if the partner lies outside the picture or the disparity outside the range.
            let index = 4u * step + k - params.skipped;
            let column = u32(i32(x) + DIRECTION * (params.min_disparity + i32(index)));
            let exists = index - range.x < range.y && column < params.width;
            let tag = select(NO_KEY, index, exists);
            let key = vec4<u32>(windows[0][k], windows[1][k], windows[2][k], windows[3][k]) | vec4<u32>(tag);
            let wins = key < best_of(search);
            search = visit(search, key, wins, last_won);
            last_won = wins;
        }
    }

    // The confidences of four neighbouring columns are packed by the first one's thread.
    var confidences = vec4<u32>(0u);
    let best = best_of(search);
    for (var n = 0; n < ROWS; n++) { // unroll
        let result = disparity_and_confidence(best[n], search.rival[n], search.below[n], search.above[n]);
        let row = first_y + n;
        if x < params.width && row < params.rows {
            let disparity = i32(result.x);
            let holds = FULL == 0 || is_confirmed(x, row, disparity);
            matches[row * params.width + x] = select(NONE, disparity, holds);
            confidences[n] = select(0u, result.y, holds);
        }
    }
    if FULL != 0 {
        columns[0][thread] = confidences;
        workgroupBarrier();
        if thread % 4u == 0u && x < params.width {
            let packed = columns[0][thread] | (columns[0][thread + 1u] << vec4<u32>(8u))
                | (columns[0][thread + 2u] << vec4<u32>(16u)) | (columns[0][thread + 3u] << vec4<u32>(24u));
            for (var n = 0; n < ROWS; n++) { // unroll
                let row = first_y + n;
                if row < params.rows {
                    matches[params.confidence_offset + row * ((params.width + 3u) / 4u) + x / 4u] = i32(packed[n]);
                }
            }
        }
    }
}
