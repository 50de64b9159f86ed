// The 64 values that describe each keypoint's surroundings (Bay et al. 2008, section 4.2, with
// 2x2 samples a subregion and compressed gradients): one workgroup a keypoint, a thread for each
// of its 4x4 subregions.

#import keypoint
#import haar

const SUBREGIONS = 16u;

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
@group(0) @binding(2) var<storage, read> found: u32;
@group(0) @binding(3) var<storage, read> keypoints: array<Keypoint>;
// 16 subregions a keypoint, row by row: sum dx, sum dy, sum |dx|, sum |dy|.
@group(0) @binding(4) var<storage, read_write> descriptors: array<vec4f>;

var<workgroup> squares: array<f32, SUBREGIONS>;

// Cosine and sine of an angle from 0 to 2 pi, within 2e-7. A device's own may be off by 2^-11, which puts samples
// elsewhere: SwiftShader's are.
fn direction_of(angle: f32) -> vec2f {
    // In quarter turns, and what is left of it. A quarter is written in two parts, of which the first has so few bits
    // that its products are exact.
    let quarters = round(angle * 0.6366197723675814);
    let rest = (angle - quarters * 1.5703125) - quarters * 4.838267948966192e-4;
    // Taylor's series, up to pi / 4.
    let square = rest * rest;
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    let sine = rest * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))));
    let turned = select(vec2f(cosine, sine), vec2f(-sine, cosine), (u32(quarters) & 1u) == 1u);
    return select(turned, -turned, (u32(quarters) & 2u) == 2u);
}

// How a keypoint's surroundings are sampled.
struct Sampling {
    place: Place,
    // The direction of the keypoint's first axis.
    axis: vec2f,
    // Half the side of the wavelets.
    radius: i32,
}

fn sampling_of(keypoint: Keypoint) -> Sampling {
    let place = place_of(keypoint);
    if UPRIGHT == 1 {
        // Written out, as cos(0) need not be exactly 1 and upright samples lie at exact places.
        return Sampling(place, vec2f(1.0, 0.0), (3 * place.scale + 2) / 4);
    }
    return Sampling(place, direction_of(keypoint.orientation), 2 * place.scale);
}

// The vector of the same direction whose length is the cube root, so that one strong edge does not
// drown the rest.
fn compress(gradient: vec2f) -> vec2f {
    // Of integers, the smallest length but 0 is 1.
    return gradient * pow(max(dot(gradient, gradient), 1.0), -1.0 / 3.0);
}

// A sample's part of its subregion's values; (u, v) is its place in scales and the keypoint's axes.
fn sample(sampling: Sampling, u: f32, v: f32) -> vec4f {
    let place = sampling.place;
    let along = sampling.axis;
    let across = vec2f(-along.y, along.x);
    let offset = f32(place.scale) * (u * along + v * across);
    let gradient = compress(vec2f(haar(place.x + whole(offset.x), place.y + whole(offset.y), sampling.radius)));
    let turned = vec2f(dot(gradient, along), dot(gradient, across));
    return vec4f(turned, abs(turned));
}

@compute @workgroup_size(SUBREGIONS)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(found, arrayLength(&keypoints)) {
        return;
    }
    let sampling = sampling_of(keypoints[n]);
    // In subregions, which are 4 scales wide; their samples are 1 scale off their centre.
    let from_centre = vec2f(f32(local % 4u), f32(local / 4u)) - 1.5;
    let u = 4.0 * from_centre.x;
    let v = 4.0 * from_centre.y;
    var sums = sample(sampling, u - 1.0, v - 1.0) + sample(sampling, u + 1.0, v - 1.0)
        + sample(sampling, u - 1.0, v + 1.0) + sample(sampling, u + 1.0, v + 1.0);
    sums *= exp(-dot(from_centre, from_centre) / (2.0 * 1.5 * 1.5));

    squares[local] = dot(sums, sums);
    workgroupBarrier();
    var square = 0.0;
    for (var k = 0u; k < SUBREGIONS; k++) {
        square += squares[k];
    }
    // Flat surroundings have no direction, and stay 0.
    descriptors[SUBREGIONS * n + local] = sums / max(sqrt(square), 1e-6);
}
