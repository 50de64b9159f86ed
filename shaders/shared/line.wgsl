// Semi-global matching along one line of pixels: the path cost L of pixel p at disparity d is the matching cost C plus
// the cost of the cheapest way to (p, d), on which a change of disparity by one costs P1 and a larger change P2.
//
//     L(p, d) = C(p, d) + min(L(q, d), L(q, d - 1) + P1, L(q, d + 1) + P1, M + P2) - M,  M = min L(q, .)
//
// where q is the pixel before p. Hirschmueller: 'Stereo processing by semiglobal matching and mutual information', PAMI
// 30(2), 2008, equations 12 and 13. P2 depends on the luma: see path_step.wgsl.
//
// One thread owns one line and keeps the path costs of the last pixel, all disparities, in registers. A diagonal line
// that leaves the picture at one side starts anew at the other side.
//
// The module has `params` with `width`, `rows`, `first_row`, `path_start`, `goes_on`, `dx` and `dy`, and the buffers
// `reference`, `costs` and `paths`: see path.wgsl.

#import path_step

// Constants:
//   WORDS   u32 per pixel of a volume, four disparities packed per u32
//   QUADS   vectors per pixel of a volume: WORDS / 4

// Path costs of a pixel, four disparities per vector, between two vectors of sentinels.
alias PathCosts = array<vec4<u32>, WORDS + 2>;
// The same, packed: 16 disparities per vector. Software drivers load and store a vector in little more time than a u32.
alias PackedCosts = array<vec4<u32>, QUADS>;

// M: the least path cost of a pixel.
fn min_cost(path: PathCosts) -> u32 {
    var least = path[1];
    for (var k = 0; k < WORDS; k++) { // unroll
        least = min(least, path[k + 1]);
    }
    return min(min(least.x, least.y), min(least.z, least.w));
}

// State of a line at one pixel.
struct Line {
    x: i32,
    y: i32,
    // Luma of the last pixel.
    luma: u32,
    // Whether the line starts at this pixel: all path costs before the first pixel are 0.
    starts: bool,
    // Path costs of the last pixel.
    path: PathCosts,
}

// Lines of the path through the band.
fn line_count() -> u32 {
    return select(params.width, params.rows, params.dy == 0);
}

// Pixels per line.
fn line_length() -> u32 {
    return select(params.rows, params.width, params.dy == 0);
}

// Line `index` at its first pixel. Where the band before this one holds the pixel that the line comes from, the path
// costs of that pixel are read back.
fn first_pixel(index: u32) -> Line {
    var line: Line;
    line.x = i32(index);
    line.y = select(0, i32(params.rows) - 1, params.dy < 0);
    if params.dy == 0 {
        line.x = select(0, i32(params.width) - 1, params.dx < 0);
        line.y = i32(index);
    }
    line.luma = 0u;
    line.starts = true;
    line.path[0] = vec4<u32>(UNREACHABLE);
    line.path[WORDS + 1] = vec4<u32>(UNREACHABLE);
    let width = i32(params.width);
    let came_from = line.x - params.dx;
    if params.dy != 0 && params.goes_on != 0u && came_from >= 0 && came_from < width {
        let pixel = (line.y - params.dy) * width + came_from;
        line.luma = reference[u32(i32(params.first_row) * width + pixel)].x & 255u;
        for (var q = 0; q < QUADS; q++) { // unroll
            let packed = paths[params.path_start + u32(pixel) * QUADS + q];
            for (var t = 0; t < 4; t++) { // unroll
                line.path[4 * q + t + 1] = unpack(packed[t]);
            }
        }
        line.starts = false;
    }
    return line;
}

// Luma of the line's pixel.
fn luma_at(line: Line) -> u32 {
    return reference[(params.first_row + u32(line.y)) * params.width + u32(line.x)].x & 255u;
}

// Path costs of the line's pixel, of luma `luma`, packed: equation 13.
fn path_costs(line: Line, luma: u32) -> PackedCosts {
    let p2 = penalty(luma, line.luma);
    // At the start of a line M and M + P2 are 0, as if all path costs before it were 0.
    let mask = select(0xffffffffu, 0u, line.starts);
    let minimum = min_cost(line.path) & mask;
    let jump = (minimum + p2) & mask;
    let start = (u32(line.y) * params.width + u32(line.x)) * QUADS;
    var result: PackedCosts;
    for (var q = 0; q < QUADS; q++) { // unroll
        let packed = costs[start + q];
        for (var t = 0; t < 4; t++) { // unroll
            let before = line.path[4 * q + t];
            let after = line.path[4 * q + t + 2];
            result[q][t] = pack(advance(before, line.path[4 * q + t + 1], after, jump, unpack(packed[t])) - minimum);
        }
    }
    return result;
}

// The line at its next pixel, from the path costs `packed` and the luma of this pixel. The path costs are packed and
// unpacked again, so that software drivers pack whole vectors instead of single lanes.
fn next_pixel(line: Line, packed: PackedCosts, luma: u32) -> Line {
    var next = line;
    for (var q = 0; q < QUADS; q++) { // unroll
        for (var t = 0; t < 4; t++) { // unroll
            next.path[4 * q + t + 1] = unpack(packed[q][t]);
        }
    }
    next.luma = luma;
    next.x += params.dx;
    next.y += params.dy;
    next.starts = false;
    if params.dx != 0 && params.dy != 0 && (next.x < 0 || next.x >= i32(params.width)) {
        next.x -= params.dx * i32(params.width);
        next.starts = true;
    }
    return next;
}
