// Semi-global matching along a line: the cost of each pixel and disparity together with that of the
// best way to it, on which a step of one disparity costs P1 and a larger one P2.
//
//     L(p, d) = C(p, d) + min(L(q, d), L(q, d - 1) + P1, L(q, d + 1) + P1, M + P2) - M,  M = min L(q, .)
//
// where q is the pixel before p. Hirschmueller: 'Stereo processing by semiglobal matching and mutual
// information', PAMI 30(2), 2008, equations 12 and 13. P2 falls where the luma changes:
// P2 = max(LEAST_P2, P2 K / (K + |luma(p) - luma(q)|)), rounded down.
//
// A thread owns a line and keeps the costs of its last pixel, of all disparities, in registers. A
// slanted line goes on at the other side of the picture where it leaves it, and begins anew there.

#import quotient

// More than any cost; what no path comes from.
const FAR = 0x10000u;

// The costs at a pixel, four disparities each, between two that nothing is reached from.
alias State = array<vec4<u32>, WORDS + 2>;

fn unpack(word: u32) -> vec4<u32> {
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

fn pack(costs: vec4<u32>) -> u32 {
    return costs.x | (costs.y << 8u) | (costs.z << 16u) | (costs.w << 24u);
}

// Four disparities of the next pixel from those of the last one and their neighbours.
fn advance(before: vec4<u32>, here: vec4<u32>, after: vec4<u32>, jump: u32, cost: vec4<u32>) -> vec4<u32> {
    let below = vec4<u32>(before.w, here.xyz);
    let above = vec4<u32>(here.yzw, after.x);
    return cost + min(min(here, min(below, above) + P1), vec4<u32>(jump));
}

fn least(state: State) -> u32 {
    var least = state[1];
    for (var k = 0; k < WORDS; k++) { // unroll
        least = min(least, state[k + 1]);
    }
    return min(min(least.x, least.y), min(least.z, least.w));
}

// A line on its way.
struct Line {
    x: i32,
    y: i32,
    // The luma of the last pixel.
    luma: u32,
    // Whether it begins here: where it does, all costs before it are 0.
    fresh: bool,
    state: State,
}

fn line_count() -> u32 {
    return select(params.width, params.rows, params.dy == 0);
}

fn line_length() -> u32 {
    return select(params.rows, params.width, params.dy == 0);
}

fn begin(index: u32) -> Line {
    var line: Line;
    line.x = i32(index);
    line.y = select(0, i32(params.rows) - 1, params.dy < 0);
    if params.dy == 0 {
        line.x = select(0, i32(params.width) - 1, params.dx < 0);
        line.y = i32(index);
    }
    line.luma = 0u;
    line.fresh = true;
    line.state[0] = vec4<u32>(FAR);
    line.state[WORDS + 1] = vec4<u32>(FAR);
    let width = i32(params.width);
    let came_from = line.x - params.dx;
    if params.dy != 0 && params.goes_on != 0u && came_from >= 0 && came_from < width {
        let pixel = (line.y - params.dy) * width + came_from;
        line.luma = reference[u32(i32(params.first_row) * width + pixel)] & 255u;
        for (var k = 0; k < WORDS; k++) { // unroll
            line.state[k + 1] = unpack(paths[params.path_start + u32(pixel) * WORDS + k]);
        }
        line.fresh = false;
    }
    return line;
}

// The luma of the line's pixel.
fn luma_at(line: Line) -> u32 {
    return reference[(params.first_row + u32(line.y)) * params.width + u32(line.x)] & 255u;
}

// The costs at the line's pixel, whose luma is `here`, packed.
fn follow(line: Line, here: u32) -> array<u32, WORDS> {
    let change = u32(abs(i32(here) - i32(line.luma)));
    let p2 = max(LEAST_P2, quotient(P2 * P2_SCALE, P2_SCALE + change));
    // A line that begins has no past: the same as one of zeros.
    let scale = select(0xffffffffu, 0u, line.fresh);
    let minimum = least(line.state) & scale;
    let jump = (minimum + p2) & scale;
    let start = (u32(line.y) * params.width + u32(line.x)) * WORDS;
    var words: array<u32, WORDS>;
    for (var k = 0; k < WORDS; k++) { // unroll
        let cost = unpack(costs[start + k]);
        words[k] = pack(advance(line.state[k], line.state[k + 1], line.state[k + 2], jump, cost) - minimum);
    }
    return words;
}

// The line at its next pixel. The costs are unpacked again, so that software drivers pack vectors and
// not lane by lane.
fn next_of(line: Line, words: array<u32, WORDS>, here: u32) -> Line {
    var next = line;
    for (var k = 0; k < WORDS; k++) { // unroll
        next.state[k + 1] = unpack(words[k]);
    }
    next.luma = here;
    next.x += params.dx;
    next.y += params.dy;
    next.fresh = false;
    if params.dx != 0 && params.dy != 0 && (next.x < 0 || next.x >= i32(params.width)) {
        next.x -= params.dx * i32(params.width);
        next.fresh = true;
    }
    return next;
}
