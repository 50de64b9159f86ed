// Semi-global matching, one path through cells with ranges of their own: the path costs along all lines of one direction.
// One thread per line; a diagonal line that leaves the picture at one side starts anew at the other side.
//
// The path costs of the last pixel are read back from the volume, at an offset where its range begins elsewhere. A
// disparity that the last pixel does not have is reached by a jump alone.

#import path_step
#import cell_layout

// Constants:
//   WORKGROUP   threads per workgroup
//   GRAIN       u32 of a step of a pixel's number of words

struct Params {
    width: u32,
    // Rows of the band, the row of the picture where the band begins, and that of the census transforms.
    rows: u32,
    top: u32,
    first_row: u32,
    // Index in `paths` where the band begins in the volume of this path, and where the row before it is.
    path_start: u32,
    halo_start: u32,
    // 1: lines continue from the row before the band.
    goes_on: u32,
    // Step to the next pixel of a line, -1, 0 or 1 each.
    dx: i32,
    dy: i32,
    // See shared/cell_layout.wgsl.
    columns: u32,
    cells: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// From census.wgsl: the luma of a pixel is the lowest byte of its first u32.
@group(0) @binding(1) var<storage, read> reference: array<vec2<u32>>;
// Matching costs, 16 disparities per vector, and volumes of path costs, four disparities packed per u32, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> paths: array<u32>;
@group(0) @binding(4) var words: texture_storage_2d<r32uint, read>;

// Path costs of word `k` of the pixel with the words `span` in `paths`.
fn quad_at(span: Span, k: u32) -> vec4<u32> {
    let exists = k < span.count;
    let quad = unpack(paths[span.start + select(0u, k, exists)]);
    return select(vec4<u32>(UNREACHABLE), quad, exists);
}

fn least_of(costs: vec4<u32>) -> u32 {
    return min(min(costs.x, costs.y), min(costs.z, costs.w));
}

@compute @workgroup_size(WORKGROUP, 1)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let along_rows = params.dy == 0;
    if id.x >= select(params.width, params.rows, along_rows) {
        return;
    }
    var x = i32(id.x);
    var y = select(0, i32(params.rows) - 1, params.dy < 0);
    if along_rows {
        x = select(0, i32(params.width) - 1, params.dx < 0);
        y = i32(id.x);
    }
    // The last pixel: its words in `paths`, luma and least path cost. At the start of a line it has no disparities, and a
    // jump costs nothing.
    var last = Span(params.path_start, 0u, 0u);
    var last_luma = 0u;
    var least = 0u;
    var starts = true;
    let came_from = x - params.dx;
    if !along_rows && params.goes_on != 0u && came_from >= 0 && came_from < i32(params.width) {
        last = in_row(u32(came_from), u32(i32(params.top) + y - params.dy));
        last.start += params.halo_start;
        last_luma = reference[u32((i32(params.first_row) + y - params.dy) * i32(params.width) + came_from)].x & 255u;
        var lowest = vec4<u32>(UNREACHABLE);
        for (var k = 0u; k < last.count; k++) {
            lowest = min(lowest, unpack(paths[last.start + k]));
        }
        least = least_of(lowest);
        starts = false;
    }
    for (var i = 0u; i < select(params.rows, params.width, along_rows); i++) {
        let luma = reference[(params.first_row + u32(y)) * params.width + u32(x)].x & 255u;
        let jump = select(least + penalty(luma, last_luma), 0u, starts);
        let span = span_at(u32(x), params.top + u32(y));
        let out = params.path_start + span.start;
        // Word k of this pixel is word k + shift of the last one; below 0 the sum wraps, and no pixel has such a word.
        let shift = span.first - last.first;
        var before = quad_at(last, shift - 1u);
        var quad = quad_at(last, shift);
        var lowest = vec4<u32>(UNREACHABLE);
        for (var k = 0u; k < span.count; k += GRAIN) {
            let packed = costs[(span.start + k) / GRAIN];
            for (var j = 0; j < GRAIN; j++) { // unroll
                let after = quad_at(last, shift + k + j + 1u);
                let path = advance(before, quad, after, jump, unpack(packed[j])) - least;
                paths[out + k + j] = pack(path);
                lowest = min(lowest, path);
                before = quad;
                quad = after;
            }
        }
        least = least_of(lowest);
        last = Span(out, span.first, span.count);
        last_luma = luma;
        starts = false;
        x += params.dx;
        y += params.dy;
        if params.dx != 0 && params.dy != 0 && (x < 0 || x >= i32(params.width)) {
            x -= params.dx * i32(params.width);
            last.count = 0u;
            least = 0u;
            starts = true;
        }
    }
}
