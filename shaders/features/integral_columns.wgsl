// Second half of the integral image: the running sum of every column, in place.
//
// One thread walks one column, downwards. Sums wrap at 32 bits; differences of them are exact all
// the same wherever the box's own sum fits.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Row sums on the way in, the integral image on the way out.
@group(0) @binding(1) var<storage, read_write> integral: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x > params.width {
        return;
    }
    let stride = params.width + 1u;
    let end = stride * (params.height + 1u);
    var sum = 0u;
    for (var at = id.x; at < end; at += stride) {
        sum += integral[at];
        integral[at] = sum;
    }
}
