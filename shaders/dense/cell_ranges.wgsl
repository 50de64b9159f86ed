// Disparity range to search in each cell of a picture, from the disparity map of the picture at half the size: from the
// smallest to the largest disparity in and around the cell, plus a margin. Cells with too few disparities get the whole
// range.
//
// The map is reduced to blocks of BLOCK x BLOCK pixels, each with its third smallest and third largest disparity, so
// that a few wrong pixels do not widen the range. One workgroup reduces a square of BLOCKS x BLOCKS blocks, and
// computes the ranges of the cells whose surrounding blocks all lie in the square. Lengths are in pixels of the map.

// Constants:
//   SIDE         side of a cell, in pixels
//   REACH        width of the frame around a cell whose disparities count as well, in pixels
//   MARGIN       disparities added to a range at either end
//   LEAST        pixels with a disparity in and around a cell, at least, or the whole range is searched, in per cent
//   BLOCK        side of a block, in pixels
//   BLOCKS       blocks per workgroup along a side; threads per workgroup along x and y
//   STEP         blocks from one cell to the next
//   AROUND       blocks in and around a cell along a side
//   CELLS        cells per workgroup along a side
//   FAR          sentinel above any disparity, less than half of the largest i32
//   SCALE        disparity units per pixel
//   SCALE_BITS   log2(SCALE)
//   NONE         sentinel: the pixel has no disparity

struct Params {
    // Size of the part of the map that is bound, in pixels.
    width: u32,
    rows: u32,
    // Row of this part at which the first row of cells begins.
    first_row: i32,
    // Cells per row, and rows of cells.
    columns: u32,
    cell_rows: u32,
    // Whole range of the picture.
    min_disparity: i32,
    disparities: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point.
@group(0) @binding(1) var<storage, read> map: array<i32>;
// Per cell: index of the first disparity, number of disparities.
@group(0) @binding(2) var<storage, read_write> ranges: array<vec2<u32>>;

// Third smallest and third largest disparity of a block, in pixels of the map, and number of pixels with a disparity.
struct Block {
    low: i32,
    high: i32,
    known: u32,
}

var<workgroup> blocks: array<Block, BLOCKS * BLOCKS>;

// Reduces the block whose upper left pixel is `first`; pixels outside the map count as pixels without a disparity.
fn block_at(first: vec2<i32>) -> Block {
    let size = vec2<i32>(vec2<u32>(params.width, params.rows));
    var lowest = FAR;
    var highest = -FAR;
    var second_lowest = FAR;
    var second_highest = -FAR;
    var third_lowest = FAR;
    var third_highest = -FAR;
    var known = 0u;
    for (var j = 0; j < BLOCK; j++) { // unroll
        for (var i = 0; i < BLOCK; i++) { // unroll
            let at = first + vec2<i32>(i, j);
            let inside = clamp(at, vec2<i32>(0), size - 1);
            let disparity = map[inside.y * size.x + inside.x];
            let is_known = disparity != NONE && all(at == inside);
            let rounded = (disparity + SCALE / 2) >> SCALE_BITS;
            let low = select(FAR, rounded, is_known);
            let high = select(-FAR, rounded, is_known);
            third_lowest = min(third_lowest, max(second_lowest, low));
            third_highest = max(third_highest, min(second_highest, high));
            second_lowest = min(second_lowest, max(lowest, low));
            second_highest = max(second_highest, min(highest, high));
            lowest = min(lowest, low);
            highest = max(highest, high);
            known += select(0u, 1u, is_known);
        }
    }
    if known < 3u {
        return Block(FAR, -FAR, known);
    }
    // Of three or four disparities the third smallest is not below the third largest.
    return Block(min(third_lowest, third_highest), max(third_lowest, third_highest), known);
}

@compute @workgroup_size(BLOCKS, BLOCKS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first_cell = CELLS * group.xy;
    let corner = SIDE * vec2<i32>(first_cell) + vec2<i32>(0, params.first_row) - REACH;
    blocks[thread] = block_at(corner + BLOCK * vec2<i32>(local.xy));
    workgroupBarrier();

    let cell = first_cell + local.xy;
    if local.x >= CELLS || local.y >= CELLS || cell.x >= params.columns || cell.y >= params.cell_rows {
        return;
    }
    var merged = Block(FAR, -FAR, 0u);
    for (var j = 0u; j < AROUND; j++) {
        for (var i = 0u; i < AROUND; i++) {
            let block = blocks[(STEP * local.y + j) * BLOCKS + STEP * local.x + i];
            merged.low = min(merged.low, block.low);
            merged.high = max(merged.high, block.high);
            merged.known += block.known;
        }
    }
    let last_index = i32(params.disparities) - 1;
    let first_index = clamp(2 * merged.low - MARGIN - params.min_disparity, 0, last_index);
    let end_index = clamp(2 * merged.high + MARGIN - params.min_disparity, 0, last_index) + 1;
    // Pixels of the map in and around the cell.
    let from_corner = SIDE * vec2<i32>(cell) + vec2<i32>(0, params.first_row) - REACH;
    let size = vec2<i32>(vec2<u32>(params.width, params.rows));
    let covered = min(from_corner + SIDE + 2 * REACH, size) - max(from_corner, vec2<i32>(0));
    let is_enough = merged.low < FAR && 100u * merged.known >= LEAST * u32(covered.x * covered.y);
    let range = vec2<u32>(u32(first_index), u32(end_index - first_index));
    ranges[cell.y * params.columns + cell.x] = select(vec2<u32>(0u, params.disparities), range, is_enough);
}
