// The median of the disparities around a pixel, each weighted by how much its luma is like the pixel's:
// edges of the map move to edges of the picture.
//
// Ma, He, Wei, Sun and Wu: 'Constant time weighted median filtering for stereo matching and beyond',
// ICCV 2013; here with integer weights and straight from the definition. A neighbour whose luma differs
// by g weighs 256 / 2^(g / 2^HALVING_BITS), interpolated between whole powers. The median is the least
// disparity of the window for which those up to it weigh at least half of all.

struct Params {
    width: u32,
    height: u32,
    // Where the rows begin in the luma.
    luma_start: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Four pixels a word, rows of (width + 3) / 4 words.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
@group(0) @binding(2) var<storage, read> disparities: array<i32>;
// With HOLES_ONLY those before holes were filled: only what was filled is filtered.
@group(0) @binding(3) var<storage, read> before: array<i32>;
@group(0) @binding(4) var<storage, read_write> filtered: array<i32>;

fn weight(difference: vec4<u32>) -> vec4<u32> {
    let sixteenths = (difference << vec4<u32>(4u)) >> vec4<u32>(HALVING_BITS);
    let fraction = sixteenths & vec4<u32>(15u);
    return ((32u - fraction) * 8u) >> min(sixteenths >> vec4<u32>(4u), vec4<u32>(31u));
}

// A thread filters four pixels of a row.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let y = i32(id.y);
    let width = i32(params.width);
    let height = i32(params.height);
    if x >= width || y >= height {
        return;
    }
    let luma_stride = (params.width + 3u) / 4u;
    let own_word = luma[params.luma_start + u32(y) * luma_stride + id.x];
    let own = (vec4<u32>(own_word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);

    var values: array<array<vec4<i32>, SIDE>, SIDE>;
    var weights: array<array<vec4<u32>, SIDE>, SIDE>;
    var total = vec4<u32>(0u);
    var low = vec4<i32>(FARTHEST);
    var high = vec4<i32>(-FARTHEST);
    for (var j = 0; j < SIDE; j++) { // unroll
        let row = y + j - RADIUS;
        let nearest_row = clamp(row, 0, height - 1);
        var neighbours: array<i32, SPAN>;
        // The words of the thread's pixels and of those left and right of them, which hold at least four more
        // each. Lumas of columns outside are anything: their disparities do not count.
        var words: array<u32, 3>;
        for (var i = 0; i < 3; i++) { // unroll
            let word = clamp(i32(id.x) + i - 1, 0, i32(luma_stride) - 1);
            words[i] = luma[params.luma_start + u32(nearest_row) * luma_stride + u32(word)];
        }
        var lumas: array<u32, SPAN>;
        for (var i = 0; i < SPAN; i++) { // unroll
            let column = x + i - RADIUS;
            let nearest = clamp(column, 0, width - 1);
            let disparity = disparities[nearest_row * width + nearest];
            neighbours[i] = select(NONE, disparity, row == nearest_row && column == nearest);
            lumas[i] = (words[(i + 4 - RADIUS) / 4] >> (8u * ((i + 4 - RADIUS) % 4))) & 255u;
        }
        for (var i = 0; i < SIDE; i++) { // unroll
            let value = vec4<i32>(neighbours[i], neighbours[i + 1], neighbours[i + 2], neighbours[i + 3]);
            let other = vec4<u32>(lumas[i], lumas[i + 1], lumas[i + 2], lumas[i + 3]);
            let difference = vec4<u32>(abs(vec4<i32>(other) - vec4<i32>(own)));
            let counts = value != vec4<i32>(NONE);
            values[j][i] = value;
            weights[j][i] = select(vec4<u32>(0u), weight(difference), counts);
            total += weights[j][i];
            // Those that weigh nothing do not matter.
            let matters = weights[j][i] > vec4<u32>(0u);
            low = select(low, min(low, value), matters);
            high = select(high, max(high, value), matters);
        }
    }
    // Halve the span in which the median lies until it is one number.
    while any(low < high) {
        let middle = low + ((high - low) >> vec4<u32>(1u));
        var below = vec4<u32>(0u);
        for (var j = 0; j < SIDE; j++) { // unroll
            for (var i = 0; i < SIDE; i++) { // unroll
                below += select(vec4<u32>(0u), weights[j][i], values[j][i] <= middle);
            }
        }
        let reached = 2u * below >= total;
        high = select(high, middle, reached);
        low = select(middle + 1, low, reached);
    }
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < width {
            let pixel = y * width + x + t;
            let disparity = disparities[pixel];
            let wanted = disparity != NONE && (HOLES_ONLY == 0 || before[pixel] == NONE);
            filtered[pixel] = select(disparity, low[t], wanted && total[t] > 0u);
        }
    }
}
