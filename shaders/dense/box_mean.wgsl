// The mean cost of SIDE neighbouring pixels along one direction, for each of their disparities, rounded to
// the nearest. Along the rows, then along the columns, it is that of a square.
//
// A thread owns four disparities of a line and walks along it with their running sums: at each step a
// pixel enters and another leaves. Beyond its ends a line goes on with its last pixel.

struct Params {
    // Words a pixel of the volume: a word holds the costs of four disparities, 8 bits each.
    words: u32,
    lines: u32,
    // Words from a line to the next, and from a pixel to the next of its line.
    line_step: u32,
    pixel_step: u32,
    // Pixels of a line.
    length: u32,
    // The pixel that the means begin with, and how many are wanted.
    first: u32,
    wanted: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> costs: array<u32>;
// The wanted means of a line, from where its costs begin on, with the same steps.
@group(0) @binding(2) var<storage, read_write> means: array<u32>;

const RADIUS = SIDE / 2;

// A quotient by SIDE is a product and a shift: exact, since the reciprocal is too large by less than SIDE,
// which, times any sum, stays below 2^QUOTIENT_BITS (31 times 31 * 255 + 15).
const QUOTIENT_BITS = 20u;
const RECIPROCAL = ((1u << QUOTIENT_BITS) + SIDE - 1) / SIDE;

// The even and the odd disparities of a line's pixel, each two of 16 bits.
fn halves(line: u32, pixel: i32) -> vec2<u32> {
    let nearest = u32(clamp(pixel, 0, i32(params.length) - 1));
    let word = costs[line + nearest * params.pixel_step];
    return vec2<u32>(word, word >> 8u) & vec2<u32>(0x00ff00ffu);
}

// Of sums in which half of SIDE is contained already.
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
        sums += halves(line, first + i);
    }
    for (var i = 0u; i < params.wanted; i++) {
        means[line + i * params.pixel_step] = mean(sums);
        let pixel = first + i32(i);
        sums += halves(line, pixel + RADIUS + 1) - halves(line, pixel - RADIUS);
    }
}
