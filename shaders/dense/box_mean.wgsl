// Mean cost of SIDE neighbouring pixels along one direction, per disparity, rounded to the nearest: along the rows,
// then along the columns, the mean over a square.
//
// One thread owns four disparities of one line of pixels and slides their running sums along the line: at each step one
// pixel enters and one pixel leaves. Beyond its ends a line is continued by its last pixel.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   SIDE               side of the square, odd, in pixels

struct Params {
    // u32 per pixel of the volume: the costs of four disparities packed per u32, 8 bits each.
    words: u32,
    lines: u32,
    // u32 from one line to the next, and from one pixel of a line to the next.
    line_step: u32,
    pixel_step: u32,
    // Pixels per line.
    length: u32,
    // First pixel of a line, and number of pixels, to compute means of.
    first: u32,
    wanted: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> costs: array<u32>;
// Means, with the steps of the costs; the first mean of a line is where the costs of the line begin.
@group(0) @binding(2) var<storage, read_write> means: array<u32>;

const RADIUS = SIDE / 2;

// Division by SIDE is a product and a shift. The result is exact: the reciprocal is too large by less than SIDE, and
// SIDE times any sum stays below 2^QUOTIENT_BITS (31 times 31 * 255 + 15).
const QUOTIENT_BITS = 20u;
const RECIPROCAL = ((1u << QUOTIENT_BITS) + SIDE - 1) / SIDE;

// Costs of four disparities of a pixel: the two even ones in one u32, the two odd ones in the other, 16 bits each.
fn even_and_odd(line: u32, pixel: i32) -> vec2<u32> {
    let inside = u32(clamp(pixel, 0, i32(params.length) - 1));
    let word = costs[line + inside * params.pixel_step];
    return vec2<u32>(word, word >> 8u) & vec2<u32>(0x00ff00ffu);
}

// Means, packed, of sums to which half of SIDE was added for rounding.
fn mean(sums: vec2<u32>) -> u32 {
    let low = ((sums & vec2<u32>(0xffffu)) * RECIPROCAL) >> vec2<u32>(QUOTIENT_BITS);
    let high = ((sums >> vec2<u32>(16u)) * RECIPROCAL) >> vec2<u32>(QUOTIENT_BITS);
    let quotients = low | (high << vec2<u32>(16u));
    return quotients.x | (quotients.y << 8u);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.words || id.y >= params.lines {
        return;
    }
    let line = id.y * params.line_step + id.x;
    let first = i32(params.first);
    var sums = vec2<u32>(0x00010001u * RADIUS);
    for (var i = -RADIUS; i <= RADIUS; i++) {
        sums += even_and_odd(line, first + i);
    }
    for (var i = 0u; i < params.wanted; i++) {
        means[line + i * params.pixel_step] = mean(sums);
        let pixel = first + i32(i);
        sums += even_and_odd(line, pixel + RADIUS + 1) - even_and_odd(line, pixel - RADIUS);
    }
}
