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

// To the nearest whole number.
fn whole(value: f32) -> i32 {
    return i32(floor(value + 0.5));
}

// A position in pixels, whose centres are whole numbers, in 1/16 px from the picture's corner.
fn from_corner(pixels: f32) -> i32 {
    return whole(16.0 * pixels) + 8;
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

// `area` at the corners and in the middle of the edges of a square.
struct Ring {
    upper: vec3u,
    left: u32,
    right: u32,
    lower: vec3u,
}

// Right minus left half, and lower minus upper half, of a square of side 2 * `radius` in 1/16 px.
// In grey levels, independent of the square's size.
fn halves(ring: Ring, radius: i32) -> vec2f {
    let all = ring.lower.z - ring.lower.x - ring.upper.z + ring.upper.x;
    let left_half = ring.lower.y - ring.lower.x - ring.upper.y + ring.upper.x;
    let upper_half = ring.right - ring.left - ring.upper.z + ring.upper.x;
    return vec2f(bitcast<vec2i>(all - 2u * vec2u(left_half, upper_half))) / f32(radius * radius);
}

// `halves` of the square around (x, y), in 1/16 px from the picture's corner.
fn haar(x: i32, y: i32, radius: i32) -> vec2f {
    let x0 = x - radius;
    let x1 = x + radius;
    let y0 = y - radius;
    let y1 = y + radius;
    let ring = Ring(
        vec3u(area(x0, y0), area(x, y0), area(x1, y0)),
        area(x0, y),
        area(x1, y),
        vec3u(area(x0, y1), area(x, y1), area(x1, y1)),
    );
    return halves(ring, radius);
}
