// Fills holes along the rows. A hole is mostly an area that the other view does not see, which is background: the
// farther one of the two surfaces at the ends of the hole is extrapolated at its own slope.
//
// The slope is the least-squares slope of up to RUN disparities from the hole on, consecutive ones differing by at most
// one pixel: at most STEEPEST, and 0 for fewer than SHORTEST disparities.

#import words

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RUN                disparities that a surface is fitted to, at most
//   SHORTEST           disparities of a surface with a slope, at least
//   STEEPEST           largest slope, in 1/256 px of disparity per pixel
//   FARTHEST           largest change by extrapolation, in 1/256 px
//   SCALE              disparity units per pixel
//   NONE               sentinel: the pixel has no disparity
//   NOTHING            sentinel above any disparity: no surface at this end

struct Params {
    width: u32,
    height: u32,
    // Smallest and largest filled disparity, in 1/256 px.
    least: i32,
    most: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One u32 per pixel: the disparity, fixed-point. A texture, since the loads of neighbouring threads are scattered.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
// One i32 per pixel: the disparity, fixed-point.
@group(0) @binding(2) var<storage, read_write> filled: array<i32>;

// Disparity of a pixel.
fn disparity_at(pixel: i32) -> i32 {
    return bitcast<i32>(word_at(u32(pixel)));
}

// floor(numerator / divisor) for a positive divisor.
fn floor_div(numerator: i32, divisor: i32) -> i32 {
    let quotient = numerator / divisor;
    return quotient - select(0, 1, numerator - quotient * divisor < 0);
}

// Column of the first pixel with a disparity from x on, in steps of -1 or 1; outside the picture without any.
fn first_with_disparity(row: i32, x: i32, step: i32) -> i32 {
    var column = x + step;
    while column >= 0 && column < i32(params.width) {
        if disparity_at(row + column) != NONE {
            break;
        }
        column += step;
    }
    return column;
}

// Surface at one end of a hole: a line fitted to disparities relative to the first one.
struct Surface {
    // Column next to the hole.
    end: i32,
    // Disparity in this column.
    first: i32,
    // Number of disparities, and mean of the disparities minus the first.
    count: i32,
    mean: i32,
    // Change of disparity per column, away from the hole, in 1/16 of 1/256 px.
    slope: i32,
}

// Surface from column `end` on, in steps of -1 or 1.
fn surface(row: i32, end: i32, step: i32) -> Surface {
    let first = disparity_at(row + end);
    // Relative to the first disparity: number of disparities, sum of the disparities, sum of index times disparity.
    var count = 0;
    var sum = 0;
    var moment = 0;
    var previous = first;
    while count < RUN {
        let column = end + step * count;
        if column < 0 || column >= i32(params.width) {
            break;
        }
        let disparity = disparity_at(row + column);
        if disparity == NONE || abs(disparity - previous) > SCALE {
            break;
        }
        sum += disparity - first;
        moment += count * (disparity - first);
        previous = disparity;
        count++;
    }
    // Slope = 12 sum((index - mean index) disparity) / (count (count^2 - 1)).
    let slope = floor_div(96 * (2 * moment - (count - 1) * sum), max(count * (count * count - 1), 1));
    return Surface(end, first, count, floor_div(sum, max(count, 1)), clamp(slope, -16 * STEEPEST, 16 * STEEPEST));
}

// Extrapolated disparity of a surface in column x.
fn extrapolated(surface: Surface, x: i32) -> i32 {
    let change = surface.mean - ((surface.slope * (2 * abs(x - surface.end) + surface.count - 1)) >> 5u);
    let sloped = clamp(surface.first + clamp(change, -FARTHEST, FARTHEST), params.least, params.most);
    return select(sloped, surface.first, surface.count < SHORTEST);
}

// One thread fills four pixels of a row, which mostly lie in one hole.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let width = i32(params.width);
    if x >= width || id.y >= params.height {
        return;
    }
    let row = i32(id.y * params.width);
    var disparities: vec4<i32>;
    var pending = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        let disparity = disparity_at(row + min(x + t, width - 1));
        disparities[t] = disparity;
        pending |= select(0u, 1u << t, disparity == NONE);
    }
    while pending != 0u {
        let first = x + i32(firstTrailingBit(pending));
        let left = first_with_disparity(row, first, -1);
        let right = first_with_disparity(row, first, 1);
        let from_left = surface(row, max(left, 0), -1);
        let from_right = surface(row, min(right, width - 1), 1);
        for (var t = 0; t < 4; t++) { // unroll
            let farther = min(
                select(NOTHING, extrapolated(from_left, x + t), left >= 0),
                select(NOTHING, extrapolated(from_right, x + t), right < width),
            );
            let is_in_hole = (pending & (1u << t)) != 0u && x + t < right;
            let fills = is_in_hole && farther != NOTHING;
            disparities[t] = select(disparities[t], farther, fills);
            pending &= select(0xffffffffu, ~(1u << t), is_in_hole);
        }
        // Pixels right of the picture belong to no hole.
        pending &= select(0xffffffffu, 0u, right >= width);
    }
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < width {
            filled[row + x + t] = disparities[t];
        }
    }
}
