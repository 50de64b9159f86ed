// Semi-global matching, several paths at once, for devices with many threads: the path costs along all lines of several
// directions. See shared/line.wgsl for the path costs; the result is the same.
//
// Consecutive threads, `lanes` of them, share a line and hold the path costs of the last pixel, 16 disparities each. What
// a pixel needs of its neighbouring disparities, and the least path cost, go through workgroup memory, which two
// consecutive pixels use in turn, so that a pixel has one barrier.

#import path_step

// Constants:
//   WORKGROUP   threads per workgroup

struct Params {
    width: u32,
    // Rows of the band, and the row of the census transforms where the band begins.
    rows: u32,
    first_row: u32,
    // Index in `paths`, in vectors, where the band begins in the volume of the first path, and vectors from one volume to
    // the next.
    volumes_start: u32,
    volume_quads: u32,
    // Vectors per pixel of a volume, and threads per line: the power of two that is not less.
    quads: u32,
    lanes: u32,
    // Steps to the next pixel of a line, -1, 0 or 1 each, plus 1: two bits per path.
    steps_x: u32,
    steps_y: u32,
    // A bit per path: 1 if lines continue from the row before the band, whose path costs are in `paths`.
    goes_on: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// From census.wgsl: the luma of a pixel is the lowest byte of its first u32.
@group(0) @binding(1) var<storage, read> reference: array<vec2<u32>>;
// Matching costs: `quads` vectors per pixel, four disparities packed per u32, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<vec4<u32>>;
// Volumes of path costs, packed as the matching costs, one after the other.
@group(0) @binding(3) var<storage, read_write> paths: array<vec4<u32>>;

// Path costs of a thread's first and last disparity, and its least path cost.
struct Shared {
    first: u32,
    last: u32,
    least: u32,
}

var<workgroup> exchanged: array<Shared, 2 * WORKGROUP>;

// Path costs of 16 disparities.
alias Costs = array<vec4<u32>, 4>;

fn least_of(path: Costs) -> u32 {
    let least = min(min(path[0], path[1]), min(path[2], path[3]));
    return min(min(least.x, least.y), min(least.z, least.w));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let path_number = group.y;
    let dx = i32((params.steps_x >> (2u * path_number)) & 3u) - 1;
    let dy = i32((params.steps_y >> (2u * path_number)) & 3u) - 1;
    let volume = params.volumes_start + path_number * params.volume_quads;
    let along_rows = dy == 0;
    let lines = select(params.width, params.rows, along_rows);
    let length = select(params.rows, params.width, along_rows);

    let lane = thread % params.lanes;
    let first_thread = thread - lane;
    let line = group.x * (WORKGROUP / params.lanes) + thread / params.lanes;
    // Threads without a line or without disparities go along, since all meet at barriers.
    let is_busy = line < lines && lane < params.quads;

    var x = i32(min(line, lines - 1u));
    var y = select(0, i32(params.rows) - 1, dy < 0);
    if along_rows {
        y = x;
        x = select(0, i32(params.width) - 1, dx < 0);
    }

    // The last pixel: its path costs, luma and least path cost. At the start of a line all are 0.
    var last: Costs;
    for (var t = 0; t < 4; t++) { // unroll
        last[t] = vec4<u32>(UNREACHABLE);
    }
    var last_luma = 0u;
    var starts = true;
    let came_from = x - dx;
    if ((params.goes_on >> path_number) & 1u) != 0u && !along_rows && came_from >= 0 && came_from < i32(params.width) {
        let pixel = (y - dy) * i32(params.width) + came_from;
        last_luma = reference[u32(i32(params.first_row * params.width) + pixel)].x & 255u;
        if is_busy {
            let packed = paths[u32(i32(volume) + pixel * i32(params.quads)) + lane];
            for (var t = 0; t < 4; t++) { // unroll
                last[t] = unpack(packed[t]);
            }
        }
        starts = false;
    }
    exchanged[thread] = Shared(last[0].x, last[3].w, least_of(last));
    workgroupBarrier();

    for (var i = 0u; i < length; i++) {
        // Threads at the ends of a line read any neighbour.
        let read = (i & 1u) * WORKGROUP;
        var before = exchanged[read + max(thread, 1u) - 1u].last;
        var after = exchanged[read + min(thread + 1u, WORKGROUP - 1u)].first;
        before = select(before, UNREACHABLE, lane == 0u);
        after = select(after, UNREACHABLE, lane + 1u >= params.quads);
        var least = exchanged[read + first_thread].least;
        for (var k = 1u; k < params.quads; k++) {
            least = min(least, exchanged[read + first_thread + k].least);
        }

        let pixel = u32(y) * params.width + u32(x);
        let luma = reference[params.first_row * params.width + pixel].x & 255u;
        // At the start of a line M and M + P2 are 0, as if all path costs before it were 0.
        let minimum = select(least, 0u, starts);
        let jump = select(least + penalty(luma, last_luma), 0u, starts);
        let place = pixel * params.quads + min(lane, params.quads - 1u);
        let packed = costs[place];
        var next: Costs;
        next[0] = advance(vec4<u32>(before), last[0], last[1], jump, unpack(packed.x)) - minimum;
        next[1] = advance(last[0], last[1], last[2], jump, unpack(packed.y)) - minimum;
        next[2] = advance(last[1], last[2], last[3], jump, unpack(packed.z)) - minimum;
        next[3] = advance(last[2], last[3], vec4<u32>(after), jump, unpack(packed.w)) - minimum;
        if is_busy {
            paths[volume + place] = vec4<u32>(pack(next[0]), pack(next[1]), pack(next[2]), pack(next[3]));
        }
        last = next;
        last_luma = luma;
        x += dx;
        y += dy;
        starts = dx != 0 && dy != 0 && (x < 0 || x >= i32(params.width));
        x -= select(0, dx * i32(params.width), starts);
        exchanged[WORKGROUP - read + thread] = Shared(next[0].x, next[3].w, least_of(next));
        workgroupBarrier();
    }
}
