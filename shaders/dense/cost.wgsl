// The matching cost of each pixel and disparity, 8 bits each: the Hamming distance of the census
// transforms, the difference of the lumas and that of their gradients along the row, each weighted
// and the latter two truncated.
//
// A thread walks through the disparities of eight pixels, four a step: of the other view it then
// needs eleven pixels and their neighbours, of which a step brings four. A pixel without a partner is
// compared with the nearest one of its partner's row.

struct Params {
    width: u32,
    // Of the band whose costs are wanted, and the row of the picture where it begins.
    rows: u32,
    first_row: u32,
    min_disparity: i32,
    // Words a pixel of the volume: a word holds the costs of four disparities, the least in its lowest byte.
    words: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A word a pixel of the reference view and of the other one: the census transform above the luma.
@group(0) @binding(1) var<storage, read> reference: array<u32>;
@group(0) @binding(2) var<storage, read> other: array<u32>;
@group(0) @binding(3) var<storage, read_write> volume: array<u32>;

// The word of a row's pixel, or of the nearest.
fn column(x: i32) -> u32 {
    return u32(clamp(x, 0, i32(params.width) - 1));
}

fn luma(word: u32) -> i32 {
    return i32(word & 255u);
}

// The cost of four pixels.
fn cost(a: vec4<u32>, b: vec4<u32>, gradient_a: vec4<i32>, gradient_b: vec4<i32>) -> vec4<u32> {
    let hamming = countOneBits((a ^ b) >> vec4<u32>(8u));
    let difference = vec4<u32>(abs(vec4<i32>(a & vec4<u32>(255u)) - vec4<i32>(b & vec4<u32>(255u))));
    let gradient = vec4<u32>(abs(gradient_a - gradient_b));
    let sum = CENSUS_WEIGHT * hamming
        + DIFFERENCE_WEIGHT * min(difference, vec4<u32>(DIFFERENCE_LIMIT))
        + GRADIENT_WEIGHT * min(gradient, vec4<u32>(GRADIENT_LIMIT));
    return min(sum >> vec4<u32>(WEIGHT_BITS), vec4<u32>(MAX_COST));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = i32(8u * id.x);
    if u32(x) >= params.width || id.y >= params.rows {
        return;
    }
    let row = (params.first_row + id.y) * params.width;
    var near: array<u32, 10>;
    for (var i = 0; i < 10; i++) { // unroll
        near[i] = reference[row + column(x - 1 + i)];
    }
    var a: array<vec4<u32>, 2>;
    var gradient_a: array<vec4<i32>, 2>;
    for (var q = 0; q < 2; q++) { // unroll
        a[q] = vec4<u32>(near[4 * q + 1], near[4 * q + 2], near[4 * q + 3], near[4 * q + 4]);
        gradient_a[q] = vec4<i32>(
            luma(near[4 * q + 2]) - luma(near[4 * q]),
            luma(near[4 * q + 3]) - luma(near[4 * q + 1]),
            luma(near[4 * q + 4]) - luma(near[4 * q + 2]),
            luma(near[4 * q + 5]) - luma(near[4 * q + 3]),
        );
    }
    // The partners of a step's least disparity and pixel, its neighbour in front, and on: those that the
    // first step has in common with one before it.
    let begin = x + DIRECTION * params.min_disparity - FRONT;
    var b: array<u32, 13>;
    for (var i = 0; i < 9; i++) { // unroll
        b[i + KEPT] = other[row + column(begin + i + KEPT - DIRECTION * 4)];
    }
    for (var step = 0u; step < params.words; step++) {
        let first = begin + DIRECTION * 4 * i32(step);
        if DIRECTION < 0 {
            for (var i = 0; i < 9; i++) { // unroll
                b[12 - i] = b[8 - i];
            }
        } else {
            for (var i = 0; i < 9; i++) { // unroll
                b[i] = b[i + 4];
            }
        }
        for (var i = 0; i < 4; i++) { // unroll
            b[NEW + i] = other[row + column(first + NEW + i)];
        }
        var gradient_b: array<i32, 11>;
        for (var i = 0; i < 11; i++) { // unroll
            gradient_b[i] = luma(b[i + 2]) - luma(b[i]);
        }
        for (var q = 0; q < 2; q++) { // unroll
            var words = vec4<u32>(0u);
            for (var k = 0; k < 4; k++) { // unroll
                let costs = cost(
                    a[q],
                    vec4<u32>(
                        b[FRONT + 4 * q + DIRECTION * k],
                        b[FRONT + 4 * q + DIRECTION * k + 1],
                        b[FRONT + 4 * q + DIRECTION * k + 2],
                        b[FRONT + 4 * q + DIRECTION * k + 3],
                    ),
                    gradient_a[q],
                    vec4<i32>(
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k],
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k + 1],
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k + 2],
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k + 3],
                    ),
                );
                words |= costs << vec4<u32>(8u * k);
            }
            for (var t = 0; t < 4; t++) { // unroll
                let column = u32(x) + 4u * q + t;
                if column < params.width {
                    volume[(id.y * params.width + column) * params.words + step] = words[t];
                }
            }
        }
    }
}
