// Fills holes along their rows. Where one view sees what the other does not, it sees background: of the
// surfaces at both ends of a hole the one further away goes on behind the other, in its own slope.
//
// The slope is that of the line through up to RUN disparities from the hole on, of which each differs
// by at most a pixel from the one before: the least squares' one, at most STEEPEST, and none at all if
// there are fewer than SHORTEST.

struct Params {
    width: u32,
    height: u32,
    // What a filled disparity may be.
    least: i32,
    most: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
@group(0) @binding(2) var<storage, read_write> filled: array<i32>;

// The quotient, rounded down.
fn divided(numerator: i32, divisor: i32) -> i32 {
    let quotient = numerator / divisor;
    return quotient - select(0, 1, numerator - quotient * divisor < 0);
}

// The column of the first pixel with a disparity from x on, in steps of -1 or 1; outside if there is none.
fn first_with_disparity(row: i32, x: i32, step: i32) -> i32 {
    var column = x + step;
    while column >= 0 && column < i32(params.width) {
        if disparities[row + column] != NONE {
            break;
        }
        column += step;
    }
    return column;
}

// The disparity at x of the surface that ends at column `end`, and lies beyond it in steps of -1 or 1.
fn surface(row: i32, x: i32, end: i32, step: i32) -> i32 {
    let first = disparities[row + end];
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
        let disparity = disparities[row + column];
        if disparity == NONE || abs(disparity - previous) > SCALE {
            break;
        }
        sum += disparity - first;
        moment += count * (disparity - first);
        previous = disparity;
        count++;
    }
    if count < SHORTEST {
        return first;
    }
    // Sixteenths: 12 sum((place - mean place) disparity) / (count (count^2 - 1)) is the slope.
    let slope = divided(96 * (2 * moment - (count - 1) * sum), count * (count * count - 1));
    let limited = clamp(slope, -16 * STEEPEST, 16 * STEEPEST);
    let change = divided(sum, count) - ((limited * (2 * abs(x - end) + count - 1)) >> 5u);
    return clamp(first + clamp(change, -FARTHEST, FARTHEST), params.least, params.most);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.height {
        return;
    }
    let x = i32(id.x);
    let row = i32(id.y * params.width);
    var disparity = disparities[row + x];
    if disparity == NONE {
        let left = first_with_disparity(row, x, -1);
        let right = first_with_disparity(row, x, 1);
        var from_left = NOTHING;
        if left >= 0 {
            from_left = surface(row, x, left, -1);
        }
        var from_right = NOTHING;
        if right < i32(params.width) {
            from_right = surface(row, x, right, 1);
        }
        let nearer = min(from_left, from_right);
        disparity = select(nearer, NONE, nearer == NOTHING);
    }
    filled[row + x] = disparity;
}
