// Support (support_rule.wgsl) where a workgroup shares a tile and its halo in workgroup memory: for GPUs.

#import support_rule

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels; at most 4
//   SIDE               side of the window: 2 RADIUS + 1, in pixels
//   NONE               sentinel: the pixel has no disparity
//   FAR                sentinel farther than twice TOLERANCE from any disparity: no disparity

struct Params {
    width: u32,
    height: u32,
    // Index of the first u32 of the confidences in `matches` and `supported`.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point. Then the confidences, four packed per u32.
@group(0) @binding(1) var<storage, read> matches: array<i32>;
// Residuals, four packed per u32, rows of ceil(width / 4) u32; bytes beyond the width are 0.
@group(0) @binding(2) var<storage, read> residuals: array<u32>;
// Disparities and confidences, laid out as `matches`.
@group(0) @binding(3) var<storage, read_write> supported: array<i32>;

// Quads of four pixels per row of the tile, one on either side among them, and rows, RADIUS above and below among them.
const TILE_QUADS = WORKGROUP_WIDTH + 2;
const TILE_ROWS = WORKGROUP_HEIGHT + 2 * RADIUS;

// Disparities of the tile, FAR for pixels without a disparity, and residuals.
var<workgroup> tile: array<vec4<i32>, TILE_QUADS * TILE_ROWS>;
var<workgroup> tile_residuals: array<u32, TILE_QUADS * TILE_ROWS>;

// Loads quad `index` of the tile, whose first quad begins in column 4 first.x of row first.y.
fn load(index: i32, first: vec2<i32>) {
    let width = i32(params.width);
    let quad = first.x + index % TILE_QUADS;
    let y = first.y + index / TILE_QUADS;
    let inside_row = clamp(y, 0, i32(params.height) - 1);
    let is_row = y == inside_row;
    var disparities: vec4<i32>;
    for (var t = 0; t < 4; t++) { // unroll
        let column = 4 * quad + t;
        let inside = clamp(column, 0, width - 1);
        let disparity = matches[inside_row * width + inside];
        disparities[t] = select(FAR, disparity, is_row & (column == inside) & (disparity != NONE));
    }
    tile[index] = disparities;
    let stride = (width + 3) / 4;
    let inside_quad = clamp(quad, 0, stride - 1);
    tile_residuals[index] = select(0u, residuals[inside_row * stride + inside_quad], is_row & (quad == inside_quad));
}

// One thread decides four pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let corner = vec2<i32>(group.xy) * vec2<i32>(WORKGROUP_WIDTH, WORKGROUP_HEIGHT);
    for (var i = i32(thread); i < TILE_QUADS * TILE_ROWS; i += WORKGROUP_WIDTH * WORKGROUP_HEIGHT) {
        load(i, corner - vec2<i32>(1, RADIUS));
    }
    workgroupBarrier();
    let at = vec2<i32>(4, 1) * (corner + vec2<i32>(local.xy));
    if at.x >= i32(params.width) || at.y >= i32(params.height) {
        return;
    }
    // Left neighbour of the thread's quad in the first row of its windows.
    let first = i32(local.y) * TILE_QUADS + i32(local.x);
    let centre = tile[first + RADIUS * TILE_QUADS + 1];
    var counts: Counts;
    for (var j = 0; j < SIDE; j++) {
        let index = first + j * TILE_QUADS;
        let quads = array<vec4<i32>, 3>(tile[index], tile[index + 1], tile[index + 2]);
        for (var i = 0; i < SIDE; i++) { // unroll
            let others = vec4<i32>(
                quads[(i + 4 - RADIUS) / 4][(i + 4 - RADIUS) % 4],
                quads[(i + 5 - RADIUS) / 4][(i + 5 - RADIUS) % 4],
                quads[(i + 6 - RADIUS) / 4][(i + 6 - RADIUS) % 4],
                quads[(i + 7 - RADIUS) / 4][(i + 7 - RADIUS) % 4],
            );
            counts = with_others(counts, others, centre);
        }
    }
    var residual_sum = vec4<u32>(0u);
    for (var j = -2; j <= 2; j++) {
        let index = first + (RADIUS + j) * TILE_QUADS;
        let words = vec3<u32>(tile_residuals[index], tile_residuals[index + 1], tile_residuals[index + 2]);
        residual_sum += residual_sums(words);
    }
    store(at, centre, counts, residual_sum);
}
