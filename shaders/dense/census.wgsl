// Census transforms (census_bits.wgsl) where a thread walks down rows and keeps its windows in registers: for lavapipe.
// For GPUs: tile_census.wgsl.

#import census_bits

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   ROWS               rows of pixels per thread
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

// The last rows that were read, up to five rows below the pixels.
struct Window {
    // Lumas of the pixels' columns and of four columns on either side, packed, from two rows above the pixels on.
    lumas: array<vec3<u32>, 8>,
    // Sums of three lumas of a row, in the last two rows.
    along_row: array<Sums, 2>,
    // Sums of 3x3 lumas, around rows from four above to four below the pixels.
    sums: array<Sums, 9>,
}

// The window one row further down; the word `first` of the plane is eight columns left of the thread's pixels.
fn next(window: Window, first: u32) -> Window {
    var next = window;
    for (var j = 0; j < 7; j++) { // unroll
        next.lumas[j] = window.lumas[j + 1];
    }
    next.lumas[7] = vec3<u32>(plane[first + 1u], plane[first + 2u], plane[first + 3u]);
    if WIDE != 0 {
        let lumas = array<vec2<u32>, 5>(
            pairs(plane[first]),
            pairs(next.lumas[7].x),
            pairs(next.lumas[7].y),
            pairs(next.lumas[7].z),
            pairs(plane[first + 4u]),
        );
        for (var j = 0; j < 8; j++) { // unroll
            next.sums[j] = window.sums[j + 1];
        }
        next.along_row[0] = window.along_row[1];
        for (var i = 0; i < 3; i++) { // unroll
            next.along_row[1][i] = sums_of_three(lumas[i], lumas[i + 1], lumas[i + 2]);
            next.sums[8][i] = window.along_row[0][i] + window.along_row[1][i] + next.along_row[1][i];
        }
    }
    return next;
}

// One thread transforms 4 x ROWS pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    let first = ROWS * id.y;
    if x >= params.width || first >= params.rows {
        return;
    }
    var window: Window;
    for (var j = 0u; j < 10u; j++) {
        window = next(window, (first + j) * params.stride + id.x);
    }
    for (var y = first; y < min(first + ROWS, params.rows); y++) {
        window = next(window, (y + 10u) * params.stride + id.x);
        let lumas = window.lumas;
        let sums = window.sums;
        let transformed = transforms(
            array<vec3<u32>, 5>(lumas[0], lumas[1], lumas[2], lumas[3], lumas[4]),
            array<Sums, 5>(sums[0], sums[2], sums[4], sums[6], sums[8]),
        );
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < params.width {
                census[y * params.width + x + t] = vec2<u32>(transformed.census[t], transformed.wide[t]);
            }
        }
    }
}
