// Haar wavelet responses at any position and of any size, exact in integers. All lengths are in
// 1/16 px and all positions from the picture's corner, where pixels are unit squares.

#import keypoint

// To the nearest whole number.
fn whole(value: f32) -> i32 {
    return i32(floor(value + 0.5));
}

// A keypoint's place, rounded once: what is sampled around it is then the same on every device.
struct Place {
    x: i32,
    y: i32,
    scale: i32,
}

fn place_of(keypoint: Keypoint) -> Place {
    // The first pixel's centre, the origin of keypoints, is half a pixel from the corner.
    return Place(whole(16.0 * keypoint.x) + 8, whole(16.0 * keypoint.y) + 8, whole(16.0 * keypoint.scale));
}

// 256 times the sum of the grey values left of and above a point: bilinear between four entries of
// the integral image. It wraps at 32 bits, as they do.
fn area(x: i32, y: i32) -> u32 {
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

// Right minus left half, and lower minus upper half, of the square of side 2 * `radius` around
// (x, y), times 256.
fn haar(x: i32, y: i32, radius: i32) -> vec2i {
    let x0 = x - radius;
    let x1 = x + radius;
    let y0 = y - radius;
    let y1 = y + radius;
    let upper = vec3u(area(x0, y0), area(x, y0), area(x1, y0));
    let left = area(x0, y);
    let right = area(x1, y);
    let lower = vec3u(area(x0, y1), area(x, y1), area(x1, y1));
    let whole_square = lower.z - lower.x - upper.z + upper.x;
    let left_half = lower.y - lower.x - upper.y + upper.x;
    let upper_half = right - left - upper.z + upper.x;
    return bitcast<vec2i>(whole_square - 2u * vec2u(left_half, upper_half));
}
