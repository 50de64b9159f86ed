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

struct Params {
    width: u32,
    rows: u32,
    // Words a row of the padded reference and of the padded searched plane; where the latter begins.
    reference_stride: u32,
    searched_stride: u32,
    searched_offset: u32,
    min_disparity: i32,
    disparities: u32,
    // Steps of four disparities.
    steps: u32,
    // Per cent by which the rival's cost must exceed the winner's.
    uniqueness: u32,
    // Whether columns are counted from the right: the planes are mirrored.
    mirrored: u32,
    // Where the confidences begin.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// The padded reference plane, then the padded searched plane, four pixels a word.
@group(0) @binding(1) var<storage, read> planes: array<u32>;
// A fixed-point disparity a pixel; then, if FULL, a confidence a pixel, 0 to 255.
@group(0) @binding(2) var<storage, read_write> matches: array<i32>;

const NOTHING = 0xffffffffu;
const INDEX_MASK = (1u << SHIFT) - 1u;

// A number for each of a step's four disparities and each pixel of a row of the tile.
alias Costs = array<array<vec4<u32>, QUADS>, 4>;

// What four neighbouring pixels know of the disparities seen so far. All are keys, or NOTHING.
struct Search {
    best: vec4<u32>,
    // The best up to the last disparity but one.
    before: vec4<u32>,
    // The best that is not a direct neighbour of the winner.
    rival: vec4<u32>,
    // The winner's two neighbours.
    below: vec4<u32>,
    above: vec4<u32>,
    // The last key seen.
    previous: vec4<u32>,
}

fn consider(s: Search, key: vec4<u32>) -> Search {
    var next = s;
    next.best = min(s.best, key);
    if FULL == 0 {
        return next;
    }
    let nothing = vec4<u32>(NOTHING);
    let wins = key < s.best;
    // Whether the winner so far lies at least two disparities back, so that it and this key are
    // rivals. If not, a new winner's rival is what was best before the old one.
    let apart = s.best == s.before;
    next.rival = min(s.rival, select(select(nothing, s.before, wins), max(key, s.best), apart));
    next.below = select(s.below, s.previous, wins);
    next.above = select(select(key, s.above, apart), nothing, wins);
    next.before = s.best;
    next.previous = key;
    return next;
}

// What is ored to the costs of a step for pixels from column x on: the disparity's index; or, where
// it leads out of the picture or the range, all ones.
fn tags_of(x: i32, step: u32) -> Costs {
    var tags: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        let index = 4u * step + k;
        let end = select(0u, params.width, index < params.disparities);
        for (var q = 0; q < QUADS; q++) { // unroll
            let partner = vec4<i32>(x + 4 * q - params.min_disparity - i32(index)) + vec4<i32>(0, 1, 2, 3);
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
    for (var k = 0; k < 4; k++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            next[q] = consider(next[q], window[k][q] | tags[k][q]);
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
fn row_sums(reference: array<u32, WORDS>, searched: array<u32, WORDS + 1>) -> Costs {
    var a: array<vec4<i32>, WORDS>;
    var b: array<vec4<i32>, WORDS + 1>;
    b[0] = unpack(searched[0]);
    for (var j = 0; j < WORDS; j++) { // unroll
        a[j] = unpack(reference[j]);
        b[j + 1] = unpack(searched[j + 1]);
    }
    var sums: Costs;
    for (var k = 0; k < 4; k++) { // unroll
        // The last is read by a sum that nobody reads.
        var difference: array<u32, SPAN + 1>;
        for (var i = 0; i < SPAN; i++) { // unroll
            difference[i] = u32(abs(
                a[(FIRST + i) / 4][(FIRST + i) % 4] - b[(FIRST + i + 4 - k) / 4][(FIRST + i + 4 - k) % 4]
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

// The exact quotient, rounded down, where it is below 2^16. By way of floats, since software drivers
// divide integers lane by lane: the estimate is off by one at most, whatever the rounding.
fn quotient(numerator: u32, divisor: u32) -> u32 {
    let estimate = u32(f32(numerator) / f32(divisor));
    let rest = i32(numerator - estimate * divisor);
    return estimate - select(0u, 1u, rest < 0) + select(0u, 1u, rest >= i32(divisor));
}

// The minimum's place between its neighbours' costs, in 1/256 px from the winner, -128 to 128: the
// nearest integer to 128 (left - right) / divisor, halves up.
fn subpixel(below: u32, best: u32, above: u32) -> i32 {
    let left = below - best;
    let right = above - best;
    var divisor = 0u;
    if INTERPOLATION == PARABOLA {
        divisor = left + right;
    } else if INTERPOLATION == EQUIANGULAR {
        divisor = max(left, right);
    }
    // 128 is added before the division, and taken away after it, to keep it unsigned.
    let nearest = i32(quotient(256u * (left - right) + 257u * divisor, max(2u * divisor, 1u))) - 128;
    return select(nearest, 0, divisor == 0u);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let column = QUADS * id.x;
    let x = 4u * column;
    let y0 = TILE_HEIGHT * id.y;
    if x >= params.width || y0 >= params.rows {
        return;
    }

    var reference: array<array<u32, WORDS>, ROWS>;
    // One word more: the four pixels further left that the next step needs come in front.
    var searched: array<array<u32, WORDS + 1>, ROWS>;
    for (var y = 0; y < ROWS; y++) { // unroll
        let reference_row = (y0 + y) * params.reference_stride + column;
        let searched_row = params.searched_offset + (y0 + y) * params.searched_stride + params.steps + column;
        for (var j = 0; j < WORDS; j++) { // unroll
            reference[y][j] = planes[reference_row + j];
            searched[y][j] = planes[searched_row + j];
        }
    }

    let nothing = vec4<u32>(NOTHING);
    var searches: array<array<Search, QUADS>, ROWS>;
    for (var y = 0; y < ROWS; y++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            searches[y][q] = Search(nothing, nothing, nothing, nothing, nothing, nothing);
        }
    }

    for (var step = 0u; step < params.steps; step++) {
        let tags = tags_of(i32(x), step);
        // Row sums of each row, behind as many rows of zeros as the first windows 'lose'.
        var sums: array<Costs, ROWS + SIDE>;
        var window: Costs;
        for (var y = 0; y < ROWS; y++) { // unroll
            for (var j = 0; j < WORDS; j++) { // unroll
                searched[y][WORDS - j] = searched[y][WORDS - j - 1];
            }
            let searched_row = params.searched_offset + (y0 + y) * params.searched_stride + params.steps + column;
            searched[y][0] = planes[searched_row - 1u - step];
            sums[y + SIDE] = row_sums(reference[y], searched[y]);
            window = slide(window, sums[y + SIDE], sums[y]);
            if y >= SIDE - 1 {
                searches[y] = consider_all(searches[y], window, tags);
            }
        }
    }

    for (var n = 0; n < TILE_HEIGHT; n++) { // unroll
        for (var q = 0; q < QUADS; q++) { // unroll
            let s = searches[n + SIDE - 1][q];
            for (var t = 0; t < 4; t++) { // unroll
                finish(x + 4 * q + t, y0 + n, s.best[t], s.rival[t], s.below[t], s.above[t]);
            }
        }
    }
}

// Writes the answer of one pixel.
fn finish(x: u32, y: u32, best: u32, rival: u32, below: u32, above: u32) {
    if x >= params.width || y >= params.rows {
        return;
    }
    let pixel = y * params.width + select(x, params.width - 1u - x, params.mirrored != 0u);
    let whole = (params.min_disparity + i32(best & INDEX_MASK)) * SCALE;
    let exists = best != NOTHING;
    if FULL == 0 {
        matches[pixel] = select(NONE, whole, exists);
        return;
    }
    let cost = best >> SHIFT;
    let rival_cost = rival >> SHIFT;
    let unrivalled = rival == NOTHING;
    let unique = params.uniqueness == 0u || unrivalled || rival_cost * 100u > cost * (100u + params.uniqueness);
    let has_neighbours = below != NOTHING && above != NOTHING;
    let fraction = select(0, subpixel(below >> SHIFT, cost, above >> SHIFT), has_neighbours);
    let margin = select(quotient(254u * (rival_cost - cost), max(rival_cost, 1u)), 0u, unrivalled);
    matches[pixel] = select(NONE, whole + fraction, exists && unique);
    matches[params.confidence_offset + pixel] = select(0, i32(1u + margin), exists && unique);
}
