// Semi-global matching, several paths at once, for devices with many threads: the path costs along all lines of several
// directions. See shared/line.wgsl for the path costs; the result is the same.
//
// Consecutive threads, `lanes` of them, share a line and hold the path costs of the last pixel, four disparities per word. They
// exchange what a pixel needs of its neighbouring disparities, and the least path cost. The module imports one of
// shared/exchange_memory.wgsl and shared/exchange_subgroups.wgsl, and one of shared/lane_words_1.wgsl, lane_words_2.wgsl and
// lane_words_4.wgsl.
//
// A line is a chain of pixels, each of which needs the one before; only its matching costs and lumas are known beforehand.
// They are loaded AHEAD pixels early, so that the chain does not wait for memory.

#import path_step

// Constants:
//   WORKGROUP   threads per workgroup
//   AHEAD       pixels of a line that are loaded early, an even number
//   LANE_WORDS  words per thread

struct Params {
    width: u32,
    // Rows of the band, and the row of the census transforms where the band begins.
    rows: u32,
    first_row: u32,
    // Index in `paths` where the band begins in the volume of the first path, and elements from one volume to the next.
    volumes_start: u32,
    volume_length: u32,
    // Elements per pixel of a volume, and threads per line: the power of two that is not less.
    elements: u32,
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
// Matching costs: `elements` per pixel, four disparities packed per u32, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<Words>;
// Volumes of path costs, packed as the matching costs, one after the other.
@group(0) @binding(3) var<storage, read_write> paths: array<Words>;

// Path costs of a thread, four disparities per vector, between a vector of the thread before and one of the thread after.
alias Costs = array<vec4<u32>, LANE_WORDS + 2>;

fn least_of(path: Costs) -> u32 {
    var least = path[1];
    for (var t = 0; t < LANE_WORDS; t++) { // unroll
        least = min(least, path[t + 1]);
    }
    return min(min(least.x, least.y), min(least.z, least.w));
}

// A pixel of a line.
struct Place {
    x: i32,
    y: i32,
    // Whether a line starts at the pixel: all path costs before the first pixel are 0.
    starts: bool,
}

// The pixel after `place`. A diagonal line that leaves the picture at one side starts anew at the other side.
fn next_place(place: Place, dx: i32, dy: i32) -> Place {
    let x = place.x + dx;
    let starts = dx != 0 && dy != 0 && (x < 0 || x >= i32(params.width));
    return Place(x - select(0, dx * i32(params.width), starts), place.y + dy, starts);
}

// What is known of a pixel beforehand.
struct Loaded {
    // Index of the thread's element in a volume.
    index: u32,
    luma: u32,
    // The thread's matching costs, packed.
    costs: Words,
    starts: bool,
}

// Loads a pixel; behind the end of a line, any pixel.
fn loaded(place: Place, lane: u32) -> Loaded {
    let x = clamp(place.x, 0, i32(params.width) - 1);
    let y = clamp(place.y, 0, i32(params.rows) - 1);
    let pixel = u32(y) * params.width + u32(x);
    let index = pixel * params.elements + min(lane, params.elements - 1u);
    let luma = reference[params.first_row * params.width + pixel].x & 255u;
    return Loaded(index, luma, costs[index], place.starts);
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, builtins: Builtins) {
    let thread = index_of(builtins);
    let path_number = group.y;
    let dx = i32((params.steps_x >> (2u * path_number)) & 3u) - 1;
    let dy = i32((params.steps_y >> (2u * path_number)) & 3u) - 1;
    let volume = params.volumes_start + path_number * params.volume_length;
    let along_rows = dy == 0;
    let lines = select(params.width, params.rows, along_rows);
    let length = select(params.rows, params.width, along_rows);

    let lane = thread % params.lanes;
    let line = group.x * (WORKGROUP / params.lanes) + thread / params.lanes;
    let has_disparities = lane < params.elements;
    // Threads without a line or without disparities go along, since all meet when they exchange.
    let is_busy = line < lines && has_disparities;

    var place = Place(i32(min(line, lines - 1u)), select(0, i32(params.rows) - 1, dy < 0), true);
    if along_rows {
        place = Place(select(0, i32(params.width) - 1, dx < 0), place.x, true);
    }

    // The last pixel: its path costs and luma. At the start of a line all path costs are 0.
    var path: Costs;
    for (var t = 0; t < LANE_WORDS + 2; t++) { // unroll
        path[t] = vec4<u32>(UNREACHABLE);
    }
    var last_luma = 0u;
    let came_from = place.x - dx;
    if ((params.goes_on >> path_number) & 1u) != 0u && !along_rows && came_from >= 0 && came_from < i32(params.width) {
        let pixel = (place.y - dy) * i32(params.width) + came_from;
        last_luma = reference[u32(i32(params.first_row * params.width) + pixel)].x & 255u;
        if is_busy {
            let packed = paths[u32(i32(volume) + pixel * i32(params.elements)) + lane];
            for (var t = 0; t < LANE_WORDS; t++) { // unroll
                path[t + 1] = unpack(word(packed, t));
            }
        }
        place.starts = false;
    }

    var next_pixels: array<Loaded, AHEAD>;
    for (var k = 0; k < AHEAD; k++) { // unroll
        next_pixels[k] = loaded(place, lane);
        place = next_place(place, dx, dy);
    }
    for (var i = 0u; i < length; i += u32(AHEAD)) {
        for (var k = 0; k < AHEAD; k++) { // unroll
            if i + u32(k) < length {
                let pixel = next_pixels[k];
                next_pixels[k] = loaded(place, lane);
                place = next_place(place, dx, dy);
                let least = select(UNREACHABLE, least_of(path), has_disparities);
                let others = exchanged_with(Edges(path[1].x, path[LANE_WORDS].w, least), thread, lane, u32(k));
                path[0] = vec4<u32>(select(others.before, UNREACHABLE, lane == 0u));
                path[LANE_WORDS + 1] = vec4<u32>(select(others.after, UNREACHABLE, lane + 1u >= params.elements));
                // At the start of a line M and M + P2 are 0, as if all path costs before it were 0.
                let minimum = select(others.least, 0u, pixel.starts);
                let jump = select(others.least + penalty(pixel.luma, last_luma), 0u, pixel.starts);
                let last = path;
                var packed: array<u32, LANE_WORDS>;
                for (var t = 0; t < LANE_WORDS; t++) { // unroll
                    let costs = unpack(word(pixel.costs, t));
                    path[t + 1] = advance(last[t], last[t + 1], last[t + 2], jump, costs) - minimum;
                    packed[t] = pack(path[t + 1]);
                }
                if is_busy {
                    paths[volume + pixel.index] = words_of(packed);
                }
                last_luma = pixel.luma;
            }
        }
    }
}
