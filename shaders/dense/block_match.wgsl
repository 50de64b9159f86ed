// Block matching: the sum of absolute differences (SAD) over a square window, winner-take-all, uniqueness check and
// sub-pixel interpolation in one pass that stores no cost volume. FULL = 0 computes only the winners' whole
// disparities, which a consistency check needs of the other view, in half the arithmetic.
//
// One thread owns a tile of 4 QUADS by TILE_HEIGHT pixels and visits the disparities, four per step. The reference rows
// of the tile and its halo stay in registers, and each step loads one u32 per searched row: four disparities on, the
// searched pixels are those of the last step, moved by one u32. The sum of a window is never computed from its SIDE^2
// terms: running sums slide along the row, then down the column.
//
// With CORE > 0 only the rows at both ends are held like that. The CORE rows in the middle, which all windows of the tile
// share, are loaded and summed in a loop that stays a loop: slower, but code that hardly grows with the window.
//
// Loops marked 'unroll' are written out before compilation (src/gpu/unroll.rs), so that their arrays become registers:
// a factor of forty on software drivers.

#import selection
#import block_search
#import words

// Constants:
//   TILES_ACROSS     tiles per workgroup along x
//   TILES_DOWN       tiles per workgroup along y
//   TILE_HEIGHT      rows of pixels per thread
//   QUADS            quads of four neighbouring pixels per row of a tile
//   SIDE             side of the window, in pixels
//   CORE             rows in the middle of a tile and its halo that are loaded again at each step, 0 or SIDE - TILE_HEIGHT
//                    + 1: rows of all windows of the tile
//   HELD             rows of a tile and its halo that are held in registers: TILE_HEIGHT + SIDE - 1 - CORE
//   HELD_SIDE        held rows of each window: SIDE - CORE
//   SPAN             pixels per row of a tile and its halo: 4 QUADS + SIDE - 1
//   WORDS            u32 per row of a tile and its halo, four pixels packed per u32
//   FIRST            pixel of these WORDS at which the first window begins
//   SEARCHED_FIRST   pixel of the WORDS + 1 searched u32 at which the partner of FIRST at a step's first disparity lies
//   DIRECTION        partner column = column + DIRECTION * disparity: -1 if the reference is the left view, 1 if the
//                    right view
//   START            first of the WORDS searched u32 loaded before the first step: 1 if a step shifts rows down, else 0
//   FULL             1: disparities, checked and interpolated, and confidences; 0: the winners' whole disparities alone
//   NONE             sentinel: the pixel has no disparity

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

// One number per disparity of a step and pixel of a tile's row.
alias Costs = array<array<vec4<u32>, QUADS>, 4>;

// The bits that turn a step's costs into keys, for pixels from column x on: the disparity's index, or all ones if the
// partner lies outside the picture or the disparity outside the range.
fn index_bits(x: i32, step: u32, range: vec2<u32>) -> Costs {
    var tags: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        let index = 4u * step + k - params.skipped;
        let end = select(0u, params.width, index - range.x < range.y);
        for (var q = 0; q < QUADS; q++) { // unroll
            let partner = vec4<i32>(x + 4 * q + DIRECTION * (params.min_disparity + i32(index))) + vec4<i32>(0, 1, 2, 3);
            tags[k][q] = select(vec4<u32>(NO_KEY), vec4<u32>(index), vec4<u32>(partner) < vec4<u32>(end));
        }
    }
    return tags;
}

// Window sums one row further down.
fn slide_down(window: Costs, entering: Costs, leaving: Costs) -> Costs {
    var next: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            next[k][q] = window[k][q] + entering[k][q] - leaving[k][q];
        }
    }
    return next;
}

// Visits a step's four disparities for a row of the tile.
fn visit_step(searches: array<Search, QUADS>, window: Costs, tags: Costs) -> array<Search, QUADS> {
    var next = searches;
    for (var q = 0; q < QUADS; q++) { // unroll
        var last_won = next[q].previous < next[q].before;
        for (var k = 0; k < 4; k++) { // unroll
            let key = window[k][q] | tags[k][q];
            let wins = key < best_of(next[q]);
            next[q] = visit(next[q], key, wins, last_won);
            last_won = wins;
        }
    }
    return next;
}

// Sums of absolute differences along one row of the windows, for a step's four disparities and the pixels of a tile's
// row: `reference` holds unpacked pixels, `searched` the packed pixels of the other view.
fn row_sums(reference: array<vec4<i32>, WORDS>, searched: array<u32, WORDS + 1>) -> Costs {
    var partners: array<vec4<i32>, WORDS + 1>;
    partners[0] = unpack(searched[0]);
    for (var j = 0; j < WORDS; j++) { // unroll
        partners[j + 1] = unpack(searched[j + 1]);
    }
    var sums: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        // The last element is padding: only the last `sum`, which is never used, reads it.
        var difference: array<u32, SPAN + 1>;
        for (var i = 0; i < SPAN; i++) { // unroll
            difference[i] = u32(abs(
                reference[(FIRST + i) / 4][(FIRST + i) % 4]
                    - partners[(SEARCHED_FIRST + i + DIRECTION * k) / 4][(SEARCHED_FIRST + i + DIRECTION * k) % 4]
            ));
        }
        var sum = 0u;
        for (var i = 0; i < SIDE; i++) { // unroll
            sum += difference[i];
        }
        for (var q = 0; q < QUADS; q++) { // unroll
            let sum1 = sum + difference[4 * q + SIDE] - difference[4 * q];
            let sum2 = sum1 + difference[4 * q + SIDE + 1] - difference[4 * q + 1];
            let sum3 = sum2 + difference[4 * q + SIDE + 2] - difference[4 * q + 2];
            sums[k][q] = vec4<u32>(sum, sum1, sum2, sum3);
            sum = sum3 + difference[4 * q + SIDE + 3] - difference[4 * q + 3];
        }
    }
    return sums;
}

// Sums of the CORE rows, as those of one row. `row` is the index of a tile's first u32 relative to the planes' starts.
fn core_sums(row: u32, step: u32) -> Costs {
    let reference_row = params.reference_start + row;
    let searched_row = params.searched_start + row + u32(DIRECTION * i32(step) + START - 1);
    var core = Costs();
    for (var y = u32(HELD_SIDE); y < HELD_SIDE + CORE; y++) {
        var reference: array<vec4<i32>, WORDS>;
        var searched: array<u32, WORDS + 1>;
        for (var j = 0; j < WORDS; j++) { // unroll
            reference[j] = unpack(word_at(reference_row + y * params.stride + j));
            searched[j] = word_at(searched_row + y * params.stride + j);
        }
        searched[WORDS] = word_at(searched_row + y * params.stride + WORDS);
        core = slide_down(core, row_sums(reference, searched), Costs());
    }
    return core;
}

@compute @workgroup_size(TILES_ACROSS * TILES_DOWN)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let column = QUADS * (TILES_ACROSS * group.x + thread % TILES_ACROSS);
    let x = 4u * column;
    let y0 = TILE_HEIGHT * (TILES_DOWN * group.y + thread / TILES_ACROSS);
    if x >= params.width || y0 >= params.rows {
        return;
    }

    let range = ranges[(y0 >> params.cell_shift) * params.cell_columns + (x >> params.cell_shift)];
    let first_step = (params.skipped + range.x) / 4u;
    let end = (params.skipped + range.x + range.y + 3u) / 4u;
    let searched_start = params.searched_start + u32(DIRECTION * i32(first_step));

    // The held rows: those of the first windows, then those behind the core.
    var reference: array<array<vec4<i32>, WORDS>, HELD>;
    // One u32 more than the reference: each step shifts the row by one u32 and loads one.
    var searched: array<array<u32, WORDS + 1>, HELD>;
    for (var y = 0; y < HELD; y++) { // unroll
        let row = (y0 + y + y / HELD_SIDE * CORE) * params.stride + column;
        for (var j = 0; j < WORDS; j++) { // unroll
            reference[y][j] = unpack(word_at(params.reference_start + row + j));
            searched[y][j + START] = word_at(searched_start + row + j);
        }
    }

    let no_key = vec4<u32>(NO_KEY);
    // The last element is padding, which moves up behind the last row.
    var searches: array<array<Search, QUADS>, HELD + 1>;
    for (var y = 0; y < HELD; y++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            searches[y][q] = Search(no_key, no_key, no_key, no_key, no_key);
        }
    }

    for (var step = first_step; step < end; step++) {
        let tags = index_bits(i32(x), step, range);
        // Sums of each held row, behind HELD_SIDE rows of zeros, which leave the first windows.
        var sums: array<Costs, HELD + HELD_SIDE>;
        // Zeros written out: without an initial value Chromium's compiler keeps the last step's window.
        var window = Costs();
        if CORE > 0 {
            window = core_sums(y0 * params.stride + column, step);
        }
        for (var y = 0; y < HELD; y++) { // unroll
            let row = params.searched_start + (y0 + y + y / HELD_SIDE * CORE) * params.stride + column;
            if DIRECTION < 0 {
                for (var j = 0; j < WORDS; j++) { // unroll
                    searched[y][WORDS - j] = searched[y][WORDS - j - 1];
                }
                searched[y][0] = word_at(row - 1u - step);
            } else {
                for (var j = 0; j < WORDS; j++) { // unroll
                    searched[y][j] = searched[y][j + 1];
                }
                searched[y][WORDS] = word_at(row + WORDS + step);
            }
            sums[y + HELD_SIDE] = row_sums(reference[y], searched[y]);
            window = slide_down(window, sums[y + HELD_SIDE], sums[y]);
            if y >= HELD_SIDE - 1 {
                searches[y] = visit_step(searches[y], window, tags);
            }
        }
    }

    // A loop that stays a loop, in which the rows move up: unrolled, it would be most of the code.
    for (var y = y0; y < y0 + TILE_HEIGHT; y++) {
        for (var q = 0; q < QUADS; q++) { // unroll
            write_quad(4u * (column + q), y, searches[HELD_SIDE - 1][q]);
        }
        for (var n = 0; n < TILE_HEIGHT; n++) { // unroll
            searches[n + HELD_SIDE - 1] = searches[n + HELD_SIDE];
        }
    }
}

// Writes disparities and confidences of four pixels, some of which may lie right of the picture.
fn write_quad(x: u32, y: u32, s: Search) {
    if x >= params.width || y >= params.rows {
        return;
    }
    let best = best_of(s);
    let results = array<vec2<u32>, 4>(
        disparity_and_confidence(best.x, s.rival.x, s.below.x, s.above.x),
        disparity_and_confidence(best.y, s.rival.y, s.below.y, s.above.y),
        disparity_and_confidence(best.z, s.rival.z, s.below.z, s.above.z),
        disparity_and_confidence(best.w, s.rival.w, s.below.w, s.above.w),
    );
    var confidences = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < params.width {
            let disparity = i32(results[t].x);
            let holds = FULL == 0 || is_confirmed(x + t, y, disparity);
            matches[y * params.width + x + t] = select(NONE, disparity, holds);
            confidences |= select(0u, results[t].y << (8u * t), holds);
        }
    }
    if FULL != 0 {
        matches[params.confidence_offset + y * ((params.width + 3u) / 4u) + x / 4u] = i32(confidences);
    }
}
