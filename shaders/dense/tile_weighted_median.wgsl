// Weighted median of the disparities around a pixel, as weighted_median.wgsl defines it, where a workgroup shares a tile
// and its halo in workgroup memory: for GPUs.

#import halving

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels
//   SIDE               side of the window: 2 RADIUS + 1, in pixels
//   HALVING_BITS       log2 of the difference of lumas that halves the weight, in grey levels
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

// Columns and rows of the tile, RADIUS on each side among them.
const TILE_COLUMNS = WORKGROUP_WIDTH + 2 * RADIUS;
const TILE_ROWS = WORKGROUP_HEIGHT + 2 * RADIUS;

// Disparity and luma of a pixel. Pixels outside the picture have no disparity, and lumas that do not matter.
var<workgroup> tile: array<vec2<i32>, TILE_COLUMNS * TILE_ROWS>;

fn pixel(at: vec2<i32>) -> vec2<i32> {
    let size = vec2<i32>(i32(params.width), i32(params.height));
    let inside = clamp(at, vec2<i32>(0), size - vec2<i32>(1));
    let disparity = select(NONE, disparities[inside.y * size.x + inside.x], all(at == inside));
    let word = luma[params.luma_start + u32(inside.y * ((size.x + 3) / 4) + inside.x / 4)];
    return vec2<i32>(disparity, i32((word >> (8u * (u32(inside.x) % 4u))) & 255u));
}

// Median of the window whose first pixel is `first` of the tile and whose central pixel has `own`, a disparity and a luma.
fn median(first: i32, own: vec2<i32>) -> i32 {
    var values: array<array<i32, SIDE>, SIDE>;
    var weights: array<array<u32, SIDE>, SIDE>;
    var total = 0u;
    var low = FARTHEST;
    var high = -FARTHEST;
    for (var j = 0; j < SIDE; j++) { // unroll
        for (var i = 0; i < SIDE; i++) { // unroll
            let neighbour = tile[first + j * TILE_COLUMNS + i];
            let weight = halving_weight(vec4<u32>(u32(abs(neighbour.y - own.y))), HALVING_BITS).x;
            values[j][i] = neighbour.x;
            weights[j][i] = select(0u, weight, neighbour.x != NONE);
            total += weights[j][i];
            // Neighbours of weight 0 do not bound the search.
            let matters = weights[j][i] > 0u;
            low = select(low, min(low, neighbour.x), matters);
            high = select(high, max(high, neighbour.x), matters);
        }
    }
    // Bisection: the pixel itself has a weight, so that low <= high.
    while low < high {
        let middle = low + ((high - low) >> 1u);
        var below = 0u;
        for (var j = 0; j < SIDE; j++) { // unroll
            for (var i = 0; i < SIDE; i++) { // unroll
                below += select(0u, weights[j][i], values[j][i] <= middle);
            }
        }
        let reached = 2u * below >= total;
        high = select(high, middle, reached);
        low = select(middle + 1, low, reached);
    }
    return low;
}

// One thread filters one pixel.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let corner = vec2<i32>(group.xy) * vec2<i32>(WORKGROUP_WIDTH, WORKGROUP_HEIGHT);
    for (var i = i32(thread); i < TILE_COLUMNS * TILE_ROWS; i += WORKGROUP_WIDTH * WORKGROUP_HEIGHT) {
        tile[i] = pixel(corner - vec2<i32>(RADIUS) + vec2<i32>(i % TILE_COLUMNS, i / TILE_COLUMNS));
    }
    workgroupBarrier();
    let at = corner + vec2<i32>(local.xy);
    if at.x >= i32(params.width) || at.y >= i32(params.height) {
        return;
    }
    let first = i32(local.y) * TILE_COLUMNS + i32(local.x);
    let own = tile[first + RADIUS * TILE_COLUMNS + RADIUS];
    var result = NONE;
    if own.x != NONE {
        result = median(first, own);
    }
    filtered[at.y * i32(params.width) + at.x] = result;
}
