// The dominant direction of the gradient around each keypoint (Bay et al. 2008, section 4.1): one
// workgroup a keypoint.
//
// The paper slides a window of pi/3 over the angles of the responses. Here the angles fall into
// BINS bins of 2 pi / BINS, and a window is WINDOW = BINS / 6 of them, so that a start is tried
// every 0.15 rad. Bins are sums of fixed-point numbers: the order of the additions is not known,
// and must not matter.

const PI = 3.14159265358979;
// Units in a grey level. 109 samples of at most 510 grey levels stay below 2^31.
const FIXED_POINT = 32768.0;
// Bins start a quarter of their width before angle 0, so that no multiple of 45 degrees, frequent
// in pictures, lies on a border, where the last digit of atan2 would decide.
const PHASE = 0.25;

@group(0) @binding(3) var<storage, read_write> orientations: array<f32>;

var<workgroup> bins_x: array<atomic<i32>, BINS>;
var<workgroup> bins_y: array<atomic<i32>, BINS>;
var<workgroup> sums: array<vec2f, BINS>;

fn bin_of(direction: vec2f) -> u32 {
    let bin = floor(atan2(direction.y, direction.x) * (BINS / (2.0 * PI)) + PHASE);
    return u32(i32(bin) + BINS) % BINS;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(list.count, arrayLength(&list.keypoints)) {
        return;
    }
    if local < BINS {
        atomicStore(&bins_x[local], 0);
        atomicStore(&bins_y[local], 0);
    }
    workgroupBarrier();

    let keypoint = list.keypoints[n];
    let s = keypoint.scale;
    let radius = whole(16.0 * 2.0 * s);
    // The disc of radius 6 in the square of side 11.
    for (var sample = local; sample < 121u; sample += WORKGROUP) {
        let i = f32(sample % 11u) - 5.0;
        let j = f32(sample / 11u) - 5.0;
        let distance = i * i + j * j;
        if distance < 36.0 {
            let weight = exp(-distance / (2.0 * 2.5 * 2.5));
            let response = weight * haar(from_corner(keypoint.x + i * s), from_corner(keypoint.y + j * s), radius);
            if any(response != vec2f(0.0)) {
                let bin = bin_of(response);
                let fixed = vec2i(round(response * FIXED_POINT));
                atomicAdd(&bins_x[bin], fixed.x);
                atomicAdd(&bins_y[bin], fixed.y);
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
            angle += 2.0 * PI;
        }
        // A tiny negative angle rounds to the whole turn.
        orientations[n] = select(angle, 0.0, angle >= 2.0 * PI);
    }
}
