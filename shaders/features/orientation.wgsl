// Orientation of each keypoint: the dominant direction of the gradient around the keypoint (Bay et al., 'Speeded-Up
// Robust Features', CVIU 110, 2008, section 4.1). One workgroup per keypoint.
//
// The paper slides a window of pi/3 over the angles of the responses. Here windows start at BINS angles, so that
// responses are first summed per bin, and a window is WINDOW consecutive bins. Bins hold fixed-point sums, which do not
// depend on the order of the atomic additions.

#import keypoint
#import haar

// Constants:
//   WORKGROUP        threads per workgroup
//   DISPATCH_WIDTH   workgroups per row of a dispatch
//   BINS             bins per full turn
//   WINDOW           bins per window of pi/3

const TAU = 6.28318530717958;
// Fixed-point units per grey level: the sum of 109 samples of at most 510 grey levels stays below 2^31.
const FIXED_POINT = 32768.0;
// Angle at which bin 0 starts, in bins: with half a bin no multiple of 45 degrees, frequent in pictures, lies on a
// border between bins, where the rounding of atan2 would decide.
const PHASE = 0.5;

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
// Maxima found, also those for which the list had no room.
@group(0) @binding(2) var<storage, read> keypoint_count: u32;
@group(0) @binding(3) var<storage, read_write> keypoints: array<Keypoint>;

var<workgroup> bins_x: array<atomic<i32>, BINS>;
var<workgroup> bins_y: array<atomic<i32>, BINS>;
var<workgroup> sums: array<vec2f, BINS>;

fn bin_of(direction: vec2f) -> u32 {
    let bin = floor(atan2(direction.y, direction.x) * (BINS / TAU) - PHASE);
    return u32(i32(bin) + BINS) % BINS;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(keypoint_count, arrayLength(&keypoints)) {
        return;
    }
    if local < BINS {
        atomicStore(&bins_x[local], 0);
        atomicStore(&bins_y[local], 0);
    }
    workgroupBarrier();

    let position = position_of(keypoints[n]);
    let radius = 2 * position.scale;
    let unit = FIXED_POINT / f32(radius * radius);
    // Samples in the disc of radius 6, of the square of side 11, at distances of one scale.
    for (var sample = local; sample < 121u; sample += WORKGROUP) {
        let i = i32(sample % 11u) - 5;
        let j = i32(sample / 11u) - 5;
        let distance = i * i + j * j;
        if distance < 36 {
            let response = vec2f(haar(position.x + i * position.scale, position.y + j * position.scale, radius));
            // atan2(0, 0) is undefined; a response of 0 adds nothing.
            if any(response != vec2f(0.0)) {
                let weight = exp(-f32(distance) / (2.0 * 2.5 * 2.5));
                let weighted = vec2i(round(weight * unit * response));
                let bin = bin_of(response);
                atomicAdd(&bins_x[bin], weighted.x);
                atomicAdd(&bins_y[bin], weighted.y);
            }
        }
    }
    workgroupBarrier();

    if local < BINS {
        var sum = vec2i(0);
        for (var k = 0u; k < WINDOW; k++) {
            let bin = (local + k) % BINS;
            sum += vec2i(atomicLoad(&bins_x[bin]), atomicLoad(&bins_y[bin]));
        }
        sums[local] = vec2f(sum);
    }
    workgroupBarrier();

    if local == 0u {
        var longest = vec2f(0.0);
        for (var k = 0u; k < BINS; k++) {
            let sum = sums[k];
            if dot(sum, sum) > dot(longest, longest) {
                longest = sum;
            }
        }
        var angle = 0.0;
        if any(longest != vec2f(0.0)) {
            angle = atan2(longest.y, longest.x);
        }
        if angle < 0.0 {
            angle += TAU;
        }
        // A negative angle near 0 plus TAU may round to TAU.
        keypoints[n].orientation = select(angle, 0.0, angle >= TAU);
    }
}
