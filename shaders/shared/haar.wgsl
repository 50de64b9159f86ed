// Haar wavelet responses at any position and of any size, from an integral image, exact in integers (Bay et al.,
// 'Speeded-Up Robust Features', CVIU 110, 2008, section 4.1). Lengths are in 1/16 px; positions are in 1/16 px from the
// picture's upper left corner, where pixels are unit squares.
//
// The module has `params` with `width` and `height`, and the integral image `integral`.

#import keypoint

// `value` rounded to the nearest integer, halves up.
fn rounded(value: f32) -> i32 {
    return i32(floor(value + 0.5));
}

// Position and scale of a keypoint, rounded once, so that every device samples at the same points.
struct Position {
    x: i32,
    y: i32,
    scale: i32,
}

fn position_of(keypoint: Keypoint) -> Position {
    // The origin of keypoints is the first pixel's centre: half a pixel from the corner.
    return Position(rounded(16.0 * keypoint.x) + 8, rounded(16.0 * keypoint.y) + 8, rounded(16.0 * keypoint.scale));
}

// 256 times the sum of the grey values left of and above a point: four entries of the integral image, interpolated
// bilinearly. The sum wraps at 32 bits, as the entries do.
fn area_sum(x: i32, y: i32) -> u32 {
    let px = u32(clamp(x, 0, 16 * i32(params.width)));
    let py = u32(clamp(y, 0, 16 * i32(params.height)));
    let fx = px & 15u;
    let fy = py & 15u;
    let left = px >> 4u;
    let top = (py >> 4u) * (params.width + 1u);
    let right = min(left + 1u, params.width);
    let bottom = min((py >> 4u) + 1u, params.height) * (params.width + 1u);
    let upper = (16u - fx) * integral[top + left] + fx * integral[top + right];
    let lower = (16u - fx) * integral[bottom + left] + fx * integral[bottom + right];
    return (16u - fy) * upper + fy * lower;
}

// Wavelet responses dx and dy over the square of side 2 * `radius` around (x, y), times 256: right half minus left
// half, lower half minus upper half.
fn haar(x: i32, y: i32, radius: i32) -> vec2i {
    let x0 = x - radius;
    let x1 = x + radius;
    let y0 = y - radius;
    let y1 = y + radius;
    let upper = vec3u(area_sum(x0, y0), area_sum(x, y0), area_sum(x1, y0));
    let left = area_sum(x0, y);
    let right = area_sum(x1, y);
    let lower = vec3u(area_sum(x0, y1), area_sum(x, y1), area_sum(x1, y1));
    let whole_square = lower.z - lower.x - upper.z + upper.x;
    let left_half = lower.y - lower.x - upper.y + upper.x;
    let upper_half = right - left - upper.z + upper.x;
    return bitcast<vec2i>(whole_square - 2u * vec2u(left_half, upper_half));
}
