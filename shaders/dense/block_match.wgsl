// Block matching: the sum of absolute differences (SAD) over a square window, winner-take-all,
// uniqueness and sub-pixel interpolation in one pass that stores no cost volume.
//
// A thread owns a tile of QUADS x 4 by TILE_HEIGHT pixels and walks through the disparities, four a step. It keeps the
// reference rows in registers, and of the rows that it searches it loads one word a row and step:
// four disparities on, the same words serve again, one place further. A window's sum is never
// added up from its (2 RADIUS + 1)^2 terms: running sums along the row, then down the column.
//
// A cost is carried shifted left by SHIFT, with the disparity's index in the free bits: that number
// is the comparison key and the answer at once, and of equal costs the smaller disparity wins.
//
// With FULL = 0 only the winners are found, as whole disparities: what a consistency check asks of the
// other view, for half the arithmetic.
//
// The loops marked 'unroll' are written out before compilation (src/gpu/unroll.rs): only then do
// their arrays become registers, which is worth a factor of forty on software drivers.

#import selection
#import consistent
#import words

struct Params {
    width: u32,
    rows: u32,
    // Words a row of the padded planes.
    stride: u32,
    // The words where the first window of the reference begins, and where in the other view it meets
    // the first disparity that is looked at: whole words, so that a few come before the range.
    reference_start: u32,
    searched_start: u32,
    min_disparity: i32,
    // Disparities that a step may look at before the range begins, 0 to 3.
    skipped: u32,
    // The side of a cell of `ranges` is 2^cell_shift pixels.
    cell_shift: u32,
    cell_columns: u32,
    // Per cent by which the rival's cost must exceed the winner's.
    uniqueness: u32,
    // Where the confidences begin, four a word.
    confidence_offset: u32,
    // How far apart, in 1/256 px, the disparities of both views may be; all ones where the other is not asked.
    max_difference: u32,
    // Where the other view's map begins and how wide it is.
    others_first_row: i32,
    others_width: u32,
}

@group(0) @binding(0) var<uniform> uniforms: Params;
// Loaded once before any branch: software drivers load for each lane what stands behind one.
var<private> params: Params;
// Both padded planes, four pixels a word.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
// What is searched in each cell of the picture: the index of the first disparity, and how many.
@group(0) @binding(2) var<storage, read> ranges: array<vec2<u32>>;
// The other view's winners, where it is asked: a fixed-point disparity a pixel, of a picture of half the size if HALVED.
@group(0) @binding(3) var others: texture_storage_2d<r32uint, read>;
// A fixed-point disparity a pixel; then, if FULL, a confidence a pixel, 0 to 255, four a word.
@group(0) @binding(4) var<storage, read_write> matches: array<i32>;

// A number for each of a step's four disparities and each pixel of a row of the tile.
alias Costs = array<array<vec4<u32>, QUADS>, 4>;

// What four neighbouring pixels know of the disparities seen so far. All are keys, or NOTHING. With
// FULL = 0 only `before` is used, for the best of all.
struct Search {
    // The last key seen, and the best of those before it.
    previous: vec4<u32>,
    before: vec4<u32>,
    // The best that is not a direct neighbour of the winner.
    rival: vec4<u32>,
    // The winner's two neighbours.
    below: vec4<u32>,
    above: vec4<u32>,
}

fn best_of(s: Search) -> vec4<u32> {
    return select(min(s.previous, s.before), s.before, FULL == 0);
}

// `wins`: this key is the best so far; `last_won`: the previous one was, up to then.
fn consider(s: Search, key: vec4<u32>, wins: vec4<bool>, last_won: vec4<bool>) -> Search {
    let nothing = vec4<u32>(NOTHING);
    var next = s;
    if FULL == 0 {
        next.before = min(s.before, key);
        return next;
    }
    next.previous = key;
    next.before = best_of(s);
    // Next to the winner so far a key is its neighbour, further on its rival; a new winner's rival is
    // the best of what came before its neighbour.
    next.rival = min(s.rival, select(select(key, nothing, last_won), s.before, wins));
    next.below = select(s.below, s.previous, wins);
    next.above = select(select(s.above, key, last_won), nothing, wins);
    return next;
}

// What is ored to the costs of a step for pixels from column x on: the disparity's index; or, where
// it leads out of the picture or the range, all ones.
fn tags_of(x: i32, step: u32, range: vec2<u32>) -> Costs {
    var tags: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        let index = 4u * step + k - params.skipped;
        let end = select(0u, params.width, index - range.x < range.y);
        for (var q = 0; q < QUADS; q++) { // unroll
            let partner = vec4<i32>(x + 4 * q + DIRECTION * (params.min_disparity + i32(index))) + vec4<i32>(0, 1, 2, 3);
            tags[k][q] = select(vec4<u32>(NOTHING), vec4<u32>(index), vec4<u32>(partner) < vec4<u32>(end));
        }
    }
    return tags;
}

// The window sums one row further down.
fn slide(window: Costs, entering: Costs, leaving: Costs) -> Costs {
    var next: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            next[k][q] = window[k][q] + entering[k][q] - leaving[k][q];
        }
    }
    return next;
}

// A step's four disparities for a row of the tile.
fn consider_all(searches: array<Search, QUADS>, window: Costs, tags: Costs) -> array<Search, QUADS> {
    var next = searches;
    for (var q = 0; q < QUADS; q++) { // unroll
        var last_won = next[q].previous < next[q].before;
        for (var k = 0; k < 4; k++) { // unroll
            let key = window[k][q] | tags[k][q];
            let wins = key < best_of(next[q]);
            next[q] = consider(next[q], key, wins, last_won);
            last_won = wins;
        }
    }
    return next;
}

// The four bytes of a word, as costs: each is shifted once, by as much as its place is off, and masked.
const PLACES = vec4<i32>(SHIFT, SHIFT - 8, SHIFT - 16, SHIFT - 24);
const UP = vec4<u32>(max(PLACES, vec4<i32>(0)));
const DOWN = vec4<u32>(max(-PLACES, vec4<i32>(0)));

fn unpack(word: u32) -> vec4<i32> {
    return vec4<i32>(((vec4<u32>(word) << UP) >> DOWN) & vec4<u32>(255u << SHIFT));
}

// For four disparities, the sums of absolute differences of a tile's pixels along one row of their
// windows. Four disparities on, the searched words are the same, one place further.
fn row_sums(a: array<vec4<i32>, WORDS>, searched: array<u32, WORDS + 1>) -> Costs {
    var b: array<vec4<i32>, WORDS + 1>;
    b[0] = unpack(searched[0]);
    for (var j = 0; j < WORDS; j++) { // unroll
        b[j + 1] = unpack(searched[j + 1]);
    }
    var sums: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        // The last is read by a sum that nobody reads.
        var difference: array<u32, SPAN + 1>;
        for (var i = 0; i < SPAN; i++) { // unroll
            difference[i] = u32(abs(
                a[(FIRST + i) / 4][(FIRST + i) % 4] - b[(SEARCHED_FIRST + i + DIRECTION * k) / 4][(SEARCHED_FIRST + i + DIRECTION * k) % 4]
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

@compute @workgroup_size(TILES_ACROSS * TILES_DOWN)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    params = uniforms;
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

    var reference: array<array<vec4<i32>, WORDS>, ROWS>;
    // One word more: four disparities on, the same words serve again, one place further.
    var searched: array<array<u32, WORDS + 1>, ROWS>;
    for (var y = 0; y < ROWS; y++) { // unroll
        let row = (y0 + y) * params.stride + column;
        for (var j = 0; j < WORDS; j++) { // unroll
            reference[y][j] = unpack(word_at(params.reference_start + row + j));
            searched[y][j + START] = word_at(searched_start + row + j);
        }
    }

    let nothing = vec4<u32>(NOTHING);
    var searches: array<array<Search, QUADS>, ROWS>;
    for (var y = 0; y < ROWS; y++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            searches[y][q] = Search(nothing, nothing, nothing, nothing, nothing);
        }
    }

    for (var step = first_step; step < end; step++) {
        let tags = tags_of(i32(x), step, range);
        // Row sums of each row, behind as many rows of zeros as the first windows 'lose'.
        var sums: array<Costs, ROWS + SIDE>;
        // Without a value Chromium's compiler lets it keep the last step's.
        var window = Costs();
        for (var y = 0; y < ROWS; y++) { // unroll
            let row = params.searched_start + (y0 + y) * params.stride + column;
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
            sums[y + SIDE] = row_sums(reference[y], searched[y]);
            window = slide(window, sums[y + SIDE], sums[y]);
            if y >= SIDE - 1 {
                searches[y] = consider_all(searches[y], window, tags);
            }
        }
    }

    for (var n = 0; n < TILE_HEIGHT; n++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            finish(4u * (column + q), y0 + n, searches[n + SIDE - 1][q]);
        }
    }
}

// Whether the other view says the same of a pixel's partner; at half the size, of that or a direct neighbour in its row:
// there a window reaches twice as far over the edges of things.
fn is_confirmed(x: u32, y: u32, disparity: i32) -> bool {
    let partner = partner_of(i32(x), disparity, DIRECTION);
    let row = (i32(y >> HALVED) + params.others_first_row) * i32(params.others_width);
    var holds = params.max_difference == 0xffffffffu;
    for (var i = 0; i < HALVED + HALVED + 1; i++) { // unroll
        let column = clamp((partner >> HALVED) + i - HALVED, 0, i32(params.others_width) - 1);
        let other = i32(textureLoad(others, place_of(u32(row + column))).x);
        let scaled = select(NONE, other << HALVED, other != NONE);
        holds = holds || is_consistent(disparity, partner, params.width, scaled, params.max_difference);
    }
    return holds;
}

// Writes the answers of four pixels, of which those of a last column may lie beyond the picture.
fn finish(x: u32, y: u32, s: Search) {
    if x >= params.width || y >= params.rows {
        return;
    }
    let best = best_of(s);
    let answers = array<vec2<u32>, 4>(
        answer(best.x, s.rival.x, s.below.x, s.above.x),
        answer(best.y, s.rival.y, s.below.y, s.above.y),
        answer(best.z, s.rival.z, s.below.z, s.above.z),
        answer(best.w, s.rival.w, s.below.w, s.above.w),
    );
    var word = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < params.width {
            let disparity = i32(answers[t].x);
            let holds = FULL == 0 || is_confirmed(x + t, y, disparity);
            matches[y * params.width + x + t] = select(NONE, disparity, holds);
            word |= select(0u, answers[t].y << (8u * t), holds);
        }
    }
    if FULL != 0 {
        matches[params.confidence_offset + y * ((params.width + 3u) / 4u) + x / 4u] = i32(word);
    }
}
