// Data cost of each pixel and disparity: the mean absolute difference over a square window, of the colours and of the
// horizontal gradients of the luma, each truncated and weighted.
//
// One thread computes one pixel of the left view, four disparities at a time. Pixels outside the picture are replaced
// by the nearest pixel inside.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels
//   SIDE               side of the window: 2 RADIUS + 1, in pixels
//   SPAN               pixels per row that four disparities compare with: SIDE + 3
//   COLOUR_WEIGHT      weight of the colour difference, in 1/16
//   COLOUR_LIMIT       largest colour difference, mean of three channels, in levels
//   GRADIENT_WEIGHT    weight of the gradient difference, in 1/16
//   GRADIENT_LIMIT     largest gradient difference, in levels
//   MAX_COST           largest data cost
//   FAR                sentinel: cost of disparities beyond the range

struct Params {
    width: u32,
    // Rows of the picture.
    height: u32,
    // First row and number of rows of the strip to compute.
    first_row: u32,
    rows: u32,
    min_disparity: i32,
    disparities: u32,
    // Vectors of four disparities per pixel.
    fours: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One u32 per pixel: red in the lowest byte, then green, blue, and gradient + 128.
@group(0) @binding(1) var<storage, read> left: array<u32>;
@group(0) @binding(2) var<storage, read> right: array<u32>;
// 2 fours u32 per pixel, two disparities packed per u32, 16 bits each; FAR for disparities beyond the range.
@group(0) @binding(3) var<storage, read_write> costs: array<u32>;

// Absolute differences of one channel, at bit `shift`, between a pixel and four others.
fn difference(a: u32, b: vec4<u32>, shift: u32) -> vec4<u32> {
    let own = vec4<i32>(i32((a >> shift) & 255u));
    return vec4<u32>(abs(own - vec4<i32>((b >> vec4<u32>(shift)) & vec4<u32>(255u))));
}

// Cost of a pixel and its partners at four disparities, in 1/48: 1/16 by the weights, 1/3 by the mean of three
// channels.
fn compare(a: u32, b: vec4<u32>) -> vec4<u32> {
    let colour = difference(a, b, 0u) + difference(a, b, 8u) + difference(a, b, 16u);
    let gradient = difference(a, b, 24u);
    return COLOUR_WEIGHT * min(colour, vec4<u32>(3u * COLOUR_LIMIT))
        + 3u * GRADIENT_WEIGHT * min(gradient, vec4<u32>(GRADIENT_LIMIT));
}

// The nearest index from 0 to count - 1.
fn clamped(x: i32, count: u32) -> u32 {
    return u32(clamp(x, 0, i32(count) - 1));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.rows {
        return;
    }
    let x = i32(id.x);
    for (var four = 0u; four < params.fours; four++) {
        let partner = x - params.min_disparity - 4 * i32(four);
        var sum = vec4<u32>(0u);
        for (var j = -RADIUS; j <= RADIUS; j++) {
            let row = params.width * clamped(i32(params.first_row + id.y) + j, params.height);
            // Consecutive pixels, from the partner of the window's first column at the largest of the four disparities
            // on.
            var partners: array<u32, SPAN>;
            for (var i = 0; i < SPAN; i++) { // unroll
                partners[i] = right[row + clamped(partner - RADIUS - 3 + i, params.width)];
            }
            for (var i = 0; i < SIDE; i++) { // unroll
                let own = left[row + clamped(x - RADIUS + i, params.width)];
                sum += compare(own, vec4<u32>(partners[i + 3], partners[i + 2], partners[i + 1], partners[i]));
            }
        }
        let index = vec4<u32>(4u * four) + vec4<u32>(0u, 1u, 2u, 3u);
        let mean = min(sum / vec4<u32>(48u * SIDE * SIDE), vec4<u32>(MAX_COST));
        let cost = select(vec4<u32>(FAR), mean, index < vec4<u32>(params.disparities));
        let word = 2u * ((id.y * params.width + id.x) * params.fours + four);
        costs[word] = cost.x | (cost.y << 16u);
        costs[word + 1u] = cost.z | (cost.w << 16u);
    }
}
