// Weighted median of the disparities around a pixel. Neighbours weigh more the closer their luma is to the pixel's
// luma, so that edges of the map move to edges of the picture.
//
// Ma, He, Wei, Sun and Wu: 'Constant time weighted median filtering for stereo matching and beyond', ICCV 2013; here
// with integer weights and straight from the definition. The median is the least disparity of the window for which the
// disparities up to and including it have at least half of the total weight.
//
// Here a thread walks down rows and keeps its windows in registers: for lavapipe. For GPUs: tile_weighted_median.wgsl.

#import halving

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels
//   SIDE               side of the window: 2 RADIUS + 1, in pixels
//   KEPT               rows of a window that the window one row below shares: SIDE - 1
//   SPAN               pixels per row of four windows: SIDE + 3
//   HALVING_BITS       log2 of the difference of lumas that halves the weight, in grey levels
//   ROWS               rows of pixels per thread
//   FARTHEST           bound above any absolute disparity, in 1/256 px
//   NONE               sentinel: the pixel has no disparity

struct Params {
    width: u32,
    height: u32,
    // Index of the first row's first u32 in `luma`.
    luma_start: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Four pixels packed per u32, rows of ceil(width / 4) u32.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
// One i32 per pixel: the disparity, fixed-point.
@group(0) @binding(2) var<storage, read> disparities: array<i32>;
@group(0) @binding(3) var<storage, read_write> filtered: array<i32>;

// One row: disparities of the thread's four pixels and RADIUS columns on either side; lumas, packed, of the four pixels
// and four columns on either side.
struct Row {
    disparities: array<i32, SPAN>,
    luma: array<u32, 3>,
}

// Windows of the thread's four pixels.
alias Window = array<Row, SIDE>;

// Row y of the windows of the four pixels from column x on. Pixels outside the picture have no disparity, and lumas
// that do not matter.
fn row_at(x: i32, y: i32) -> Row {
    let width = i32(params.width);
    let inside_row = clamp(y, 0, i32(params.height) - 1);
    var row: Row;
    for (var i = 0; i < SPAN; i++) { // unroll
        let column = x + i - RADIUS;
        let inside = clamp(column, 0, width - 1);
        let disparity = disparities[inside_row * width + inside];
        row.disparities[i] = select(NONE, disparity, (y == inside_row) & (column == inside));
    }
    let luma_stride = (width + 3) / 4;
    for (var i = 0; i < 3; i++) { // unroll
        let word = clamp(x / 4 + i - 1, 0, luma_stride - 1);
        row.luma[i] = luma[params.luma_start + u32(inside_row * luma_stride + word)];
    }
    return row;
}

// Medians of the thread's four pixels; `otherwise` for pixels that are not `wanted` or have no neighbour with a weight.
fn median(window: Window, wanted: vec4<bool>, otherwise: vec4<i32>) -> vec4<i32> {
    let own = (vec4<u32>(window[RADIUS].luma[1]) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
    var values: array<array<vec4<i32>, SIDE>, SIDE>;
    var weights: array<array<vec4<u32>, SIDE>, SIDE>;
    var total = vec4<u32>(0u);
    var low = vec4<i32>(FARTHEST);
    var high = vec4<i32>(-FARTHEST);
    for (var j = 0; j < SIDE; j++) { // unroll
        var lumas: array<u32, SPAN>;
        for (var i = 0; i < SPAN; i++) { // unroll
            lumas[i] = (window[j].luma[(i + 4 - RADIUS) / 4] >> (8u * ((i + 4 - RADIUS) % 4))) & 255u;
        }
        for (var i = 0; i < SIDE; i++) { // unroll
            let value = vec4<i32>(
                window[j].disparities[i],
                window[j].disparities[i + 1],
                window[j].disparities[i + 2],
                window[j].disparities[i + 3],
            );
            let other = vec4<u32>(lumas[i], lumas[i + 1], lumas[i + 2], lumas[i + 3]);
            let difference = vec4<u32>(abs(vec4<i32>(other) - vec4<i32>(own)));
            let is_known = value != vec4<i32>(NONE);
            values[j][i] = value;
            weights[j][i] = select(vec4<u32>(0u), halving_weight(difference, HALVING_BITS), is_known);
            total += weights[j][i];
            // Neighbours of weight 0 do not bound the search.
            let matters = weights[j][i] > vec4<u32>(0u);
            low = select(low, min(low, value), matters);
            high = select(high, max(high, value), matters);
        }
    }
    let has_median = wanted & (total > vec4<u32>(0u));
    // Bisection for the median, until low = high in all lanes. Lanes that are not wanted begin with low = high.
    low = select(high, low, wanted);
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
    return select(otherwise, low, has_median);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let first = ROWS * i32(id.y);
    let width = i32(params.width);
    let height = i32(params.height);
    if x >= width || first >= height {
        return;
    }
    var window: Window;
    var missing = SIDE;
    for (var y = first; y < min(first + ROWS, height); y++) {
        // All rows of the first window, one more row for each later window.
        for (; missing > 0; missing--) {
            for (var j = 0; j < KEPT; j++) { // unroll
                window[j] = window[j + 1];
            }
            window[KEPT] = row_at(x, y + RADIUS + 1 - missing);
        }
        missing = 1;
        let centre = window[RADIUS].disparities;
        let own = vec4<i32>(centre[RADIUS], centre[RADIUS + 1], centre[RADIUS + 2], centre[RADIUS + 3]);
        let wanted = own != vec4<i32>(NONE);
        let result = median(window, wanted, own);
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < width {
                filtered[y * width + x + t] = result[t];
            }
        }
    }
}
