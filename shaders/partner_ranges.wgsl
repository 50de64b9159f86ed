// What is to be searched in each cell of the other view: from the smallest to the largest disparity with which a
// pixel of the reference view, searched as its own cell says, can have its partner there.

struct Params {
    // Cells.
    columns: u32,
    rows: u32,
    min_disparity: i32,
    // From a pixel of the reference view to its partner: -1 where that is the left one, 1 where it is the right.
    direction: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// For each cell the index of the first disparity, and how many.
@group(0) @binding(1) var<storage, read> ranges: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read_write> partners: array<vec2<u32>>;

@compute @workgroup_size(WORKGROUP_WIDTH)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.columns || id.y >= params.rows {
        return;
    }
    let row = id.y * params.columns;
    // Indices, both included.
    var first = 0x7fffffff;
    var last = -1;
    for (var column = 0u; column < params.columns; column++) {
        let range = vec2<i32>(ranges[row + column]);
        // From pixels of that cell to pixels of this one.
        let distance = params.direction * CELL * (i32(id.x) - i32(column)) - params.min_disparity;
        let lowest = max(distance - CELL + 1, range.x);
        let highest = min(distance + CELL - 1, range.x + range.y - 1);
        first = select(first, min(first, lowest), lowest <= highest);
        last = select(last, max(last, highest), lowest <= highest);
    }
    partners[row + id.x] = select(vec2<u32>(0u), vec2<u32>(vec2<i32>(first, last - first + 1)), first <= last);
}
