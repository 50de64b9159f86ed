// Fills holes along their rows. Where one view sees what the other does not, it sees background: of the
// surfaces at both ends of a hole the one further away goes on behind the other, in its own slope.
//
// The slope is that of the line through up to RUN disparities from the hole on, of which each differs
// by at most a pixel from the one before: the least squares' one, at most STEEPEST, and none at all if
// there are fewer than SHORTEST.

#import words

struct Params {
    width: u32,
    height: u32,
    // What a filled disparity may be.
    least: i32,
    most: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// The disparities, in a texture, since they are read here and there.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
@group(0) @binding(2) var<storage, read_write> filled: array<i32>;

// The disparity of a pixel.
fn disparity_at(pixel: i32) -> i32 {
    return bitcast<i32>(word_at(u32(pixel)));
}

// The quotient, rounded down.
fn divided(numerator: i32, divisor: i32) -> i32 {
    let quotient = numerator / divisor;
    return quotient - select(0, 1, numerator - quotient * divisor < 0);
}

// The column of the first pixel with a disparity from x on, in steps of -1 or 1; outside if there is none.
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

// A surface that ends at a column.
struct Surface {
    end: i32,
    // The disparity there.
    first: i32,
    // How many disparities are known of it, and what is their mean less the first.
    count: i32,
    mean: i32,
    // By how many sixteenths the disparity changes a column, away from the hole.
    slope: i32,
}

// The surface that ends at column `end`, and lies beyond it in steps of -1 or 1.
fn surface(row: i32, end: i32, step: i32) -> Surface {
    let first = disparity_at(row + end);
    // All relative to the first: the number of disparities, their sum, and that of each times its place.
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
    // 12 sum((place - mean place) disparity) / (count (count^2 - 1)) is the slope.
    let slope = divided(96 * (2 * moment - (count - 1) * sum), max(count * (count * count - 1), 1));
    return Surface(end, first, count, divided(sum, max(count, 1)), clamp(slope, -16 * STEEPEST, 16 * STEEPEST));
}

// The disparity at x of a surface that goes on.
fn continued(surface: Surface, x: i32) -> i32 {
    let change = surface.mean - ((surface.slope * (2 * abs(x - surface.end) + surface.count - 1)) >> 5u);
    let sloped = clamp(surface.first + clamp(change, -FARTHEST, FARTHEST), params.least, params.most);
    return select(sloped, surface.first, surface.count < SHORTEST);
}

// A thread has four pixels of a row, which mostly lie in one hole.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let width = i32(params.width);
    if x >= width || id.y >= params.height {
        return;
    }
    let row = i32(id.y * params.width);
    var disparities_here: vec4<i32>;
    var pending = 0u;
    for (var t = 0; t < 4; t++) { // unroll
        let disparity = disparity_at(row + min(x + t, width - 1));
        disparities_here[t] = disparity;
        pending |= select(0u, 1u << t, disparity == NONE);
    }
    while pending != 0u {
        let first = x + i32(firstTrailingBit(pending));
        let left = first_with_disparity(row, first, -1);
        let right = first_with_disparity(row, first, 1);
        let from_left = surface(row, max(left, 0), -1);
        let from_right = surface(row, min(right, width - 1), 1);
        for (var t = 0; t < 4; t++) { // unroll
            let nearer = min(
                select(NOTHING, continued(from_left, x + t), left >= 0),
                select(NOTHING, continued(from_right, x + t), right < width),
            );
            let is_here = (pending & (1u << t)) != 0u && x + t < right;
            let fills = is_here && nearer != NOTHING;
            disparities_here[t] = select(disparities_here[t], nearer, fills);
            pending &= select(0xffffffffu, ~(1u << t), is_here);
        }
        // What lies right of the picture is nobody's.
        pending &= select(0xffffffffu, 0u, right >= width);
    }
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < width {
            filled[row + x + t] = disparities_here[t];
        }
    }
}
