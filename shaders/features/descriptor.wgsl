// Descriptor of each keypoint: 64 values of the gradient in 4x4 subregions (Bay et al., 'Speeded-Up Robust Features',
// CVIU 110, 2008, section 4.2; here with 2x2 samples per subregion and compressed gradients). One workgroup per
// keypoint, one thread per subregion.

#import keypoint
#import haar

// Constants:
//   DISPATCH_WIDTH   workgroups per row of a dispatch
//   UPRIGHT          1: descriptors are not rotated by the orientation

const SUBREGIONS = 16u;

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
// Maxima found, also those for which the list had no room.
@group(0) @binding(2) var<storage, read> keypoint_count: u32;
@group(0) @binding(3) var<storage, read> keypoints: array<Keypoint>;
// 16 subregions per keypoint, row by row: sum dx, sum dy, sum |dx|, sum |dy|.
@group(0) @binding(4) var<storage, read_write> descriptors: array<vec4f>;

var<workgroup> squares: array<f32, SUBREGIONS>;

// Cosine and sine of an angle from 0 to 2 pi, within 2e-7. WGSL allows errors of 2^-11, which SwiftShader has, and
// which move samples to other pixels.
fn direction_of(angle: f32) -> vec2f {
    // Quarter turns and remainder. pi / 2 is a sum of two terms (Cody and Waite), the first of so few bits that its
    // products are exact.
    let quarters = round(angle * 0.6366197723675814);
    let rest = (angle - quarters * 1.5703125) - quarters * 4.838267948966192e-4;
    // Taylor series, for remainders up to pi / 4.
    let square = rest * rest;
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    let sine = rest * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))));
    let turned = select(vec2f(cosine, sine), vec2f(-sine, cosine), (u32(quarters) & 1u) == 1u);
    return select(turned, -turned, (u32(quarters) & 2u) == 2u);
}

// Sampling grid of a keypoint.
struct Sampling {
    position: Position,
    // Unit vector of the keypoint's first axis.
    axis: vec2f,
    // Half the side of the wavelets, in 1/16 px.
    radius: i32,
}

fn sampling_of(keypoint: Keypoint) -> Sampling {
    let position = position_of(keypoint);
    if UPRIGHT == 1 {
        // Upright samples lie at exact positions, and cos(0) need not be exactly 1.
        return Sampling(position, vec2f(1.0, 0.0), (3 * position.scale + 2) / 4);
    }
    return Sampling(position, direction_of(keypoint.orientation), 2 * position.scale);
}

// The gradient with its length replaced by the cube root of the length, so that one strong edge does not dominate the
// descriptor.
fn compress(gradient: vec2f) -> vec2f {
    // The components are integers: the least length above 0 is 1.
    return gradient * pow(max(dot(gradient, gradient), 1.0), -1.0 / 3.0);
}

// Values of the sample at (u, v), in scales along the keypoint's axes: dx, dy, |dx|, |dy|.
fn sample(sampling: Sampling, u: f32, v: f32) -> vec4f {
    let position = sampling.position;
    let along = sampling.axis;
    let across = vec2f(-along.y, along.x);
    let offset = f32(position.scale) * (u * along + v * across);
    let response = haar(position.x + rounded(offset.x), position.y + rounded(offset.y), sampling.radius);
    let gradient = compress(vec2f(response));
    let turned = vec2f(dot(gradient, along), dot(gradient, across));
    return vec4f(turned, abs(turned));
}

@compute @workgroup_size(SUBREGIONS)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(keypoint_count, arrayLength(&keypoints)) {
        return;
    }
    let sampling = sampling_of(keypoints[n]);
    // The subregion's centre, in subregions of 4 scales; samples lie 1 scale from the centre along either axis.
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
    // Without any gradient all values are 0.
    descriptors[SUBREGIONS * n + local] = sums / max(sqrt(square), 1e-6);
}
