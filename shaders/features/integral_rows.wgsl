// First half of the integral image (Viola and Jones, CVPR 2001): the running sum of every row.
//
// One thread walks one row. Row 0 of the integral image lies above the picture and is 0, and so
// is column 0 to its left.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Four pixels a word, rows of ceil(width / 4) words.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
// Rows of width + 1 sums, height + 1 of them.
@group(0) @binding(2) var<storage, read_write> integral: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if row > params.height {
        return;
    }
    let out = row * (params.width + 1u);
    integral[out] = 0u;
    if row == 0u {
        for (var x = 1u; x <= params.width; x++) {
            integral[x] = 0u;
        }
        return;
    }
    let first = (row - 1u) * ((params.width + 3u) / 4u);
    let whole = params.width / 4u;
    var sum = 0u;
    for (var i = 0u; i < whole; i++) {
        let word = luma[first + i];
        let s1 = sum + (word & 255u);
        let s2 = s1 + ((word >> 8u) & 255u);
        let s3 = s2 + ((word >> 16u) & 255u);
        sum = s3 + (word >> 24u);
        let at = out + 4u * i;
        integral[at + 1u] = s1;
        integral[at + 2u] = s2;
        integral[at + 3u] = s3;
        integral[at + 4u] = sum;
    }
    if params.width % 4u == 0u {
        return;
    }
    var rest = luma[first + whole];
    for (var x = 4u * whole; x < params.width; x++) {
        sum += rest & 255u;
        rest >>= 8u;
        integral[out + x + 1u] = sum;
    }
}
