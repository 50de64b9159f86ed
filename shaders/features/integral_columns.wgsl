// Integral image, second half (Viola and Jones, CVPR 2001): prefix sums of every column, in place. One thread adds up
// one column, downwards. Sums wrap at 32 bits; the sum over a box is exact if that sum fits in 32 bits.

// Constants:
//   WORKGROUP   threads per workgroup

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Input: prefix sums of the rows. Output: the integral image. height + 1 rows of width + 1 sums.
@group(0) @binding(1) var<storage, read_write> integral: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x > params.width {
        return;
    }
    let stride = params.width + 1u;
    let end = stride * (params.height + 1u);
    var sum = 0u;
    for (var index = id.x; index < end; index += stride) {
        sum += integral[index];
        integral[index] = sum;
    }
}
