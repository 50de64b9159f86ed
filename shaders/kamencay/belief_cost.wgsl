// The data cost of each pixel and disparity: the sum of absolute differences over a square window, of the
// colours and of the lumas' gradients along the row, each weighted and truncated.
//
// A thread compares one pixel, four disparities at a time. Rows and columns outside are the nearest ones inside.

struct Params {
    width: u32,
    // Of the picture.
    height: u32,
    // The strip whose costs are wanted.
    first_row: u32,
    rows: u32,
    min_disparity: i32,
    disparities: u32,
    // Fours of disparities a pixel.
    fours: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Red, green, blue and the gradient + 128, from the lowest byte on.
@group(0) @binding(1) var<storage, read> left: array<u32>;
@group(0) @binding(2) var<storage, read> right: array<u32>;
// Two disparities a word, 16 bits each; FAR beyond the last.
@group(0) @binding(3) var<storage, read_write> costs: array<u32>;

fn difference(a: u32, b: vec4<u32>, shift: u32) -> vec4<u32> {
    let own = vec4<i32>(i32((a >> shift) & 255u));
    return vec4<u32>(abs(own - vec4<i32>((b >> vec4<u32>(shift)) & vec4<u32>(255u))));
}

// What a pixel and its partners at four disparities differ by, in 1/48.
fn compare(a: u32, b: vec4<u32>) -> vec4<u32> {
    let colour = difference(a, b, 0u) + difference(a, b, 8u) + difference(a, b, 16u);
    let gradient = difference(a, b, 24u);
    return COLOUR_WEIGHT * min(colour, vec4<u32>(3u * COLOUR_LIMIT))
        + 3u * GRADIENT_WEIGHT * min(gradient, vec4<u32>(GRADIENT_LIMIT));
}

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
            // The partner of the window's first column at the last of the four disparities, and on.
            var others: array<u32, SPAN>;
            for (var i = 0; i < SPAN; i++) { // unroll
                others[i] = right[row + clamped(partner - RADIUS - 3 + i, params.width)];
            }
            for (var i = 0; i < SIDE; i++) { // unroll
                let own = left[row + clamped(x - RADIUS + i, params.width)];
                sum += compare(own, vec4<u32>(others[i + 3], others[i + 2], others[i + 1], others[i]));
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
