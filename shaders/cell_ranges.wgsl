// What is to be searched in each cell of a picture, from a disparity map of half its size: from the smallest to the
// largest disparity in and around the cell, but for a few that may be wrong, and some on either side. Where there
// are too few, the whole range.
//
// A workgroup finds one cell's, by way of a histogram.

struct Params {
    // The rows of the map that are there.
    width: u32,
    rows: u32,
    // The first cell's row among them.
    first_row: i32,
    // Cells in a row.
    columns: u32,
    // The map's range.
    coarse_min: i32,
    coarse_disparities: u32,
    // A bin holds 2^bin_bits of its disparities.
    bin_bits: u32,
    // The whole range.
    min_disparity: i32,
    disparities: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A fixed-point disparity a pixel.
@group(0) @binding(1) var<storage, read> map: array<i32>;
// The index of the first disparity, and how many.
@group(0) @binding(2) var<storage, read_write> ranges: array<vec2<u32>>;

const THREADS = 64u;

var<workgroup> histogram: array<atomic<u32>, BINS>;

@compute @workgroup_size(THREADS)
fn main(@builtin(workgroup_id) cell: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let bins = ((params.coarse_disparities - 1u) >> params.bin_bits) + 1u;
    for (var bin = thread; bin < bins; bin += THREADS) {
        atomicStore(&histogram[bin], 0u);
    }
    workgroupBarrier();

    let corner = vec2<i32>(0, params.first_row) + SIDE * vec2<i32>(cell.xy) - REACH;
    let first = max(corner, vec2<i32>(0));
    let end = min(corner + SIDE + 2 * REACH, vec2<i32>(vec2<u32>(params.width, params.rows)));
    // In squares of 8x8, without a division.
    for (var y = first.y + i32(thread / 8u); y < end.y; y += 8) {
        for (var x = first.x + i32(thread % 8u); x < end.x; x += 8) {
            let disparity = map[u32(y) * params.width + u32(x)];
            let nearest = (disparity + SCALE / 2) >> firstTrailingBit(u32(SCALE));
            let index = clamp(nearest - params.coarse_min, 0, i32(params.coarse_disparities) - 1);
            if disparity != NONE {
                atomicAdd(&histogram[u32(index) >> params.bin_bits], 1u);
            }
        }
    }
    workgroupBarrier();

    if thread > 0u {
        return;
    }
    var estimated = 0u;
    for (var bin = 0u; bin < bins; bin++) {
        estimated += atomicLoad(&histogram[bin]);
    }
    let wrong = estimated * OUTLIERS / 100u;
    // The bins of the disparities that have just as many below, and above.
    var low = 0u;
    var high = 0u;
    var below = 0u;
    for (var bin = 0u; bin < bins; bin++) {
        low = select(low, bin, below <= wrong);
        below += atomicLoad(&histogram[bin]);
        high = select(high, bin + 1u, below + wrong < estimated);
    }
    let last_of_bin = (1 << params.bin_bits) - 1;
    let lowest = params.coarse_min + i32(low << params.bin_bits);
    let highest = params.coarse_min + i32(high << params.bin_bits) + last_of_bin;
    let last_index = i32(params.disparities) - 1;
    let first_index = clamp(2 * lowest - MARGIN - params.min_disparity, 0, last_index);
    let end_index = clamp(2 * highest + MARGIN - params.min_disparity, 0, last_index) + 1;
    let pixels = u32((end.x - first.x) * (end.y - first.y));
    let enough = estimated > 0u && 100u * estimated >= LEAST * pixels;
    let found = vec2<u32>(u32(first_index), u32(end_index - first_index));
    ranges[cell.y * params.columns + cell.x] = select(vec2<u32>(0u, params.disparities), found, enough);
}
