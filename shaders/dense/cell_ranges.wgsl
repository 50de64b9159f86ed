// What is to be searched in each cell of a picture, from a disparity map of half its size: from the smallest to the
// largest disparity in and around the cell, and some on either side. Where there are too few, the whole range.
//
// So that a few wrong pixels do not widen it, blocks of BLOCK x BLOCK pixels have a say, each with its third smallest
// disparity and its third largest. A workgroup looks at a square of blocks, and finds the ranges of the
// cells for which it has all those around.

struct Params {
    // The rows of the map that are there.
    width: u32,
    rows: u32,
    // The first cell's row among them.
    first_row: i32,
    // Cells in a row, and rows of them.
    columns: u32,
    cell_rows: u32,
    // The whole range.
    min_disparity: i32,
    disparities: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// A fixed-point disparity a pixel.
@group(0) @binding(1) var<storage, read> map: array<i32>;
// The index of the first disparity, and how many.
@group(0) @binding(2) var<storage, read_write> ranges: array<vec2<u32>>;

// What a block says: its third smallest disparity and its third largest, as whole numbers, and how many it has.
struct Block {
    low: i32,
    high: i32,
    known: u32,
}

var<workgroup> blocks: array<Block, BLOCKS * BLOCKS>;

// The block whose first pixel this is, which may lie outside.
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
            let nearest = clamp(at, vec2<i32>(0), size - 1);
            let disparity = map[nearest.y * size.x + nearest.x];
            let is_known = disparity != NONE && all(at == nearest);
            let whole = (disparity + SCALE / 2) >> SCALE_BITS;
            let low = select(FAR, whole, is_known);
            let high = select(-FAR, whole, is_known);
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
    // Of three and four they lie the other way round.
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
    var around = Block(FAR, -FAR, 0u);
    for (var j = 0u; j < AROUND; j++) {
        for (var i = 0u; i < AROUND; i++) {
            let block = blocks[(STEP * local.y + j) * BLOCKS + STEP * local.x + i];
            around.low = min(around.low, block.low);
            around.high = max(around.high, block.high);
            around.known += block.known;
        }
    }
    let last_index = i32(params.disparities) - 1;
    let first_index = clamp(2 * around.low - MARGIN - params.min_disparity, 0, last_index);
    let end_index = clamp(2 * around.high + MARGIN - params.min_disparity, 0, last_index) + 1;
    // The pixels in and around the cell that are in the map.
    let from_corner = SIDE * vec2<i32>(cell) + vec2<i32>(0, params.first_row) - REACH;
    let size = vec2<i32>(vec2<u32>(params.width, params.rows));
    let covered = min(from_corner + SIDE + 2 * REACH, size) - max(from_corner, vec2<i32>(0));
    let is_enough = around.low < FAR && 100u * around.known >= LEAST * u32(covered.x * covered.y);
    let found = vec2<u32>(u32(first_index), u32(end_index - first_index));
    ranges[cell.y * params.columns + cell.x] = select(vec2<u32>(0u, params.disparities), found, is_enough);
}
