// Haar wavelet responses at any position and of any size, exact: what the stages for orientation
// and descriptor share. Their own text follows.

struct Params {
    width: u32,
    height: u32,
}

struct Keypoint {
    x: f32,
    y: f32,
    scale: f32,
    response: i32,
    octave: u32,
    index: u32,
}

struct KeypointList {
    count: u32,
    keypoints: array<Keypoint>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
@group(0) @binding(2) var<storage, read> list: KeypointList;

// Pixels to 1/16 px.
fn sixteenths(pixels: f32) -> i32 {
    return i32(floor(pixels * 16.0 + 0.5));
}

// 256 times the sum of the grey values left of and above a point in 1/16 px, where pixels are unit
// squares and the first one's corner is the origin: bilinear between four entries of the integral
// image. It wraps at 32 bits, as they do.
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

// Right minus left half, and lower minus upper half, of the square of side 2 * `radius` around a
// point, both in 1/16 px; the point in pixels, whose centres are whole numbers. The result is in
// grey levels, independent of the square's size.
fn haar(x: f32, y: f32, radius: i32) -> vec2f {
    let cx = sixteenths(x) + 8;
    let cy = sixteenths(y) + 8;
    let x0 = cx - radius;
    let x1 = cx + radius;
    let y0 = cy - radius;
    let y1 = cy + radius;
    let upper_left = area(x0, y0);
    let upper = area(cx, y0);
    let upper_right = area(x1, y0);
    let left = area(x0, cy);
    let right = area(x1, cy);
    let lower_left = area(x0, y1);
    let lower = area(cx, y1);
    let lower_right = area(x1, y1);
    let all = lower_right - lower_left - upper_right + upper_left;
    let left_half = lower - lower_left - upper + upper_left;
    let upper_half = right - left - upper_right + upper_left;
    return vec2f(vec2i(bitcast<i32>(all - 2u * left_half), bitcast<i32>(all - 2u * upper_half))) / f32(radius * radius);
}
