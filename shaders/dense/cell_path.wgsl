// Semi-global matching, one path through cells with ranges of their own: the path costs along all lines of one direction.
// One thread per line; a diagonal line that leaves the picture at one side starts anew at the other side. Long lines are
// followed in parts, by a dispatch each.
//
// The path costs of the last pixel are read back from the volume, at an offset of whole words where its range begins
// elsewhere: each vector is put together from two. A disparity that the last pixel does not have has the largest path cost
// there.

#import path_step
#import cell_layout

// Constants:
//   WORKGROUP   threads per workgroup

struct Params {
    width: u32,
    // Rows of the band, the row of the picture where the band begins, and that of the census transforms.
    rows: u32,
    top: u32,
    first_row: u32,
    // Index in `paths`, in u32, where the band begins in the volume of this path, and where the row before it is.
    path_start: u32,
    halo_start: u32,
    // 1: lines continue, from the row before the band or from the part before.
    goes_on: u32,
    // The part: pixels of a line before it, and in it.
    skipped: u32,
    steps: u32,
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
// Matching costs, and volumes of path costs: four disparities packed per u32, 8 bits each, 16 disparities per vector. The
// words of a pixel fill whole vectors. Software drivers load and store a vector in little more time than a u32.
@group(0) @binding(2) var<storage, read> costs: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(4) var words: texture_storage_2d<r32uint, read>;

// The largest path costs.
const ALL_LARGEST = vec4<u32>(0xffffffffu);

// Path costs of 16 disparities from word `k` on, a multiple of four, of the pixel with the words `span` in `paths`.
fn vector_at(span: Span, k: u32) -> vec4<u32> {
    let exists = k < span.count;
    return select(ALL_LARGEST, paths[(span.start + select(0u, k, exists)) / 4u], exists);
}

// The four words from word `shift` on, 0 to 3, of the eight of two vectors.
fn shifted(first: vec4<u32>, second: vec4<u32>, shift: u32) -> vec4<u32> {
    let by_one = (shift & 1u) != 0u;
    let low = select(first, vec4<u32>(first.yzw, second.x), by_one);
    let high = select(second.xy, second.yz, by_one);
    return select(low, vec4<u32>(low.zw, high), (shift & 2u) != 0u);
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
    let skipped = i32(params.skipped);
    let width = i32(params.width);
    var x = (i32(id.x) + params.dx * (skipped % width) + width) % width;
    var y = select(skipped, i32(params.rows) - 1 - skipped, params.dy < 0);
    if along_rows {
        x = select(skipped, width - 1 - skipped, params.dx < 0);
        y = i32(id.x);
    }
    // The last pixel: its words in `paths`, luma and least path cost. At the start of a line it has no disparities, and a
    // jump costs nothing.
    var last = Span(params.path_start, 0u, 0u);
    var last_luma = 0u;
    var least = 0u;
    var starts = true;
    let came_from = x - params.dx;
    if params.goes_on != 0u && came_from >= 0 && came_from < width {
        let row = u32(i32(params.top) + y - params.dy);
        last = in_row(u32(came_from), row);
        last.start += select(params.path_start + word_at(row), params.halo_start, skipped == 0);
        last_luma = reference[u32((i32(params.first_row) + y - params.dy) * width + came_from)].x & 255u;
        var lowest = vec4<u32>(UNREACHABLE);
        for (var k = 0u; k < last.count; k += 4u) {
            let packed = vector_at(last, k);
            for (var j = 0; j < 4; j++) { // unroll
                lowest = min(lowest, unpack(packed[j]));
            }
        }
        least = least_of(lowest);
        starts = false;
    }
    for (var i = 0u; i < params.steps; i++) {
        let luma = reference[(params.first_row + u32(y)) * params.width + u32(x)].x & 255u;
        let jump = select(least + penalty(luma, last_luma), 0u, starts);
        let span = span_at(u32(x), params.top + u32(y));
        let out = params.path_start + span.start;
        // Word k of this pixel is word k + shift of the last one; below 0 the sum wraps, and no pixel has such a word.
        let shift = span.first - last.first;
        let aligned = shift & ~3u;
        var loaded = vector_at(last, aligned);
        var next_loaded = vector_at(last, aligned + 4u);
        var quads = shifted(loaded, next_loaded, shift & 3u);
        var before = unpack(shifted(vector_at(last, aligned - 4u), loaded, shift & 3u).w);
        var lowest = vec4<u32>(UNREACHABLE);
        for (var k = 0u; k < span.count; k += 4u) {
            loaded = next_loaded;
            next_loaded = vector_at(last, aligned + k + 8u);
            let next_quads = shifted(loaded, next_loaded, shift & 3u);
            let ahead = vec4<u32>(quads.yzw, next_quads.x);
            let packed = costs[(span.start + k) / 4u];
            var result: vec4<u32>;
            for (var j = 0; j < 4; j++) { // unroll
                let quad = unpack(quads[j]);
                let path = advance(before, quad, unpack(ahead[j]), jump, unpack(packed[j])) - least;
                result[j] = pack(path);
                lowest = min(lowest, path);
                before = quad;
            }
            paths[(out + k) / 4u] = result;
            quads = next_quads;
        }
        least = least_of(lowest);
        last = Span(out, span.first, span.count);
        last_luma = luma;
        starts = false;
        x += params.dx;
        y += params.dy;
        if params.dx != 0 && params.dy != 0 && (x < 0 || x >= width) {
            x -= params.dx * width;
            last.count = 0u;
            least = 0u;
            starts = true;
        }
    }
}
