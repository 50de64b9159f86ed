// Census transforms (census_bits.wgsl) where a workgroup shares a tile and its halo, lumas and sums, in workgroup memory: for
// GPUs.

#import census_bits

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   WIDE               1: wide census transforms too

struct Params {
    width: u32,
    rows: u32,
    // u32 per row of the padded plane, which begins eight columns left of and five rows above the picture.
    stride: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Padded plane, four pixels packed per u32.
@group(0) @binding(1) var<storage, read> plane: array<u32>;
// Per pixel census bits above the luma, and wide census bits above the mark of weak texture.
@group(0) @binding(2) var<storage, read_write> census: array<vec2<u32>>;

// Words of four lumas per row of the tile, two on either side among them, and rows, five above and below among them.
const TILE_WORDS = WORKGROUP_WIDTH + 4u;
const TILE_ROWS = WORKGROUP_HEIGHT + 10u;
// Words of four sums per row, one on either side among them, and rows, four above and below among them.
const SUM_WORDS = WORKGROUP_WIDTH + 2u;
const SUM_ROWS = WORKGROUP_HEIGHT + 8u;
const THREADS = WORKGROUP_WIDTH * WORKGROUP_HEIGHT;

var<workgroup> lumas: array<u32, TILE_WORDS * TILE_ROWS>;
// Sums of 3x3 lumas, in pairs as in Sums.
var<workgroup> sums: array<vec2<u32>, SUM_WORDS * SUM_ROWS>;

// Sums of three lumas below each other, the first of which are in word `index` of the tile.
fn sums_of_rows(index: u32) -> vec2<u32> {
    return pairs(lumas[index]) + pairs(lumas[index + TILE_WORDS]) + pairs(lumas[index + 2u * TILE_WORDS]);
}

// One thread transforms four pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let corner = group.xy * vec2<u32>(WORKGROUP_WIDTH, WORKGROUP_HEIGHT);
    for (var i = thread; i < TILE_WORDS * TILE_ROWS; i += THREADS) {
        // Beyond the plane lie no neighbours of any pixel.
        let word = min(corner.x + i % TILE_WORDS, params.stride - 1u);
        let row = min(corner.y + i / TILE_WORDS, params.rows + 9u);
        lumas[i] = plane[row * params.stride + word];
    }
    workgroupBarrier();
    if WIDE != 0 {
        for (var i = thread; i < SUM_WORDS * SUM_ROWS; i += THREADS) {
            let first = i / SUM_WORDS * TILE_WORDS + i % SUM_WORDS;
            sums[i] = sums_of_three(sums_of_rows(first), sums_of_rows(first + 1u), sums_of_rows(first + 2u));
        }
        workgroupBarrier();
    }
    let x = 4u * (corner.x + local.x);
    let y = corner.y + local.y;
    if x >= params.width || y >= params.rows {
        return;
    }
    var near: array<vec3<u32>, 5>;
    var far: array<Sums, 5>;
    for (var j = 0; j < 5; j++) { // unroll
        let word = (local.y + 3u + j) * TILE_WORDS + local.x + 1u;
        near[j] = vec3<u32>(lumas[word], lumas[word + 1u], lumas[word + 2u]);
        if WIDE != 0 {
            let sum = (local.y + 2u * j) * SUM_WORDS + local.x;
            far[j] = Sums(sums[sum], sums[sum + 1u], sums[sum + 2u]);
        }
    }
    let transformed = transforms(near, far);
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < params.width {
            census[y * params.width + x + t] = vec2<u32>(transformed.census[t], transformed.wide[t]);
        }
    }
}
