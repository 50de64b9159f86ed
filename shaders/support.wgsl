// Takes away the disparities that hardly any of their neighbours share: speckles, without having to
// follow their outlines. A disparity stays if at least LEAST pixels of the window around it, itself
// included, have one that differs by at most TOLERANCE. Their number becomes the better part of its
// confidence: 1 + 5 (number - 1), and up to 4 more for what its confidence was.

struct Params {
    width: u32,
    height: u32,
    // Where the confidences begin, four a word.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A fixed-point disparity a pixel, then a confidence a pixel, four a word.
@group(0) @binding(1) var<storage, read> matches: array<i32>;
@group(0) @binding(2) var<storage, read_write> supported: array<i32>;

// A thread decides four pixels of a row.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let y = i32(id.y);
    let width = i32(params.width);
    let height = i32(params.height);
    if x >= width || y >= height {
        return;
    }
    var centre: vec4<i32>;
    for (var t = 0; t < 4; t++) { // unroll
        centre[t] = matches[y * width + min(x + t, width - 1)];
    }
    var count = vec4<u32>(0u);
    for (var j = -RADIUS; j <= RADIUS; j++) {
        let row = clamp(y + j, 0, height - 1) * width;
        let is_row = y + j >= 0 && y + j < height;
        var neighbours: array<i32, SPAN>;
        for (var i = 0; i < SPAN; i++) { // unroll
            let column = x + i - RADIUS;
            let disparity = matches[row + clamp(column, 0, width - 1)];
            neighbours[i] = select(NONE, disparity, is_row && column >= 0 && column < width);
        }
        for (var i = 0; i < SIDE; i++) { // unroll
            let other = vec4<i32>(neighbours[i], neighbours[i + 1], neighbours[i + 2], neighbours[i + 3]);
            let shares = (other != vec4<i32>(NONE)) & (abs(other - centre) <= vec4<i32>(TOLERANCE));
            count += select(vec4<u32>(0u), vec4<u32>(1u), shares);
        }
    }
    let word = params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x;
    let confidences = u32(matches[word]);
    var confident = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < width {
            let stays = centre[t] != NONE && count[t] >= LEAST;
            supported[y * width + x + t] = select(NONE, centre[t], stays);
            let margin = (5u * ((confidences >> (8u * t)) & 255u)) >> 8u;
            confident |= select(0u, 5u * count[t] - 4u + margin, stays) << (8u * t);
        }
    }
    supported[word] = i32(confident);
}
