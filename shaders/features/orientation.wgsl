// The dominant direction of the gradient around each keypoint (Bay et al. 2008, section 4.1): one
// workgroup a keypoint.
//
// The paper slides a window of pi/3 over the angles of the responses. Here it starts at BINS
// directions, so that the responses can be gathered in bins first, and a window is WINDOW of them.
// Bins are sums of fixed-point numbers: the order of the additions is not known, and must not
// matter.

#import keypoint
#import haar

const TAU = 6.28318530717958;
// Units in a grey level. 109 samples of at most 510 grey levels stay below 2^31.
const FIXED_POINT = 32768.0;
// Bins start half of their width after angle 0, so that no multiple of 45 degrees, frequent in
// pictures, lies on a border, where the last digit of atan2 would decide.
const PHASE = 0.5;

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
@group(0) @binding(2) var<storage, read> found: u32;
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
    if n >= min(found, arrayLength(&keypoints)) {
        return;
    }
    if local < BINS {
        atomicStore(&bins_x[local], 0);
        atomicStore(&bins_y[local], 0);
    }
    workgroupBarrier();

    let place = place_of(keypoints[n]);
    let radius = 2 * place.scale;
    let unit = FIXED_POINT / f32(radius * radius);
    // The disc of radius 6 in the square of side 11.
    for (var sample = local; sample < 121u; sample += WORKGROUP) {
        let i = i32(sample % 11u) - 5;
        let j = i32(sample / 11u) - 5;
        let distance = i * i + j * j;
        if distance < 36 {
            let response = vec2f(haar(place.x + i * place.scale, place.y + j * place.scale, radius));
            // atan2(0, 0) may be anything, and adds nothing.
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
        // A tiny negative angle rounds to the whole turn.
        keypoints[n].orientation = select(angle, 0.0, angle >= TAU);
    }
}
