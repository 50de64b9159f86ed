// Integral image, first half (Viola and Jones, CVPR 2001): prefix sums of every row. One thread adds up one row. Row 0
// and column 0 of the integral image, above and left of the picture, are 0.

// Constants:
//   WORKGROUP   threads per workgroup

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Four pixels packed per u32, rows of ceil(width / 4) u32.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
// height + 1 rows of width + 1 sums.
@group(0) @binding(2) var<storage, read_write> integral: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if row > params.height {
        return;
    }
    let row_start = row * (params.width + 1u);
    integral[row_start] = 0u;
    if row == 0u {
        for (var x = 1u; x <= params.width; x++) {
            integral[x] = 0u;
        }
        return;
    }
    let first = (row - 1u) * ((params.width + 3u) / 4u);
    let full_words = params.width / 4u;
    var sum = 0u;
    for (var i = 0u; i < full_words; i++) {
        let word = luma[first + i];
        let s1 = sum + (word & 255u);
        let s2 = s1 + ((word >> 8u) & 255u);
        let s3 = s2 + ((word >> 16u) & 255u);
        sum = s3 + (word >> 24u);
        let at = row_start + 4u * i;
        integral[at + 1u] = s1;
        integral[at + 2u] = s2;
        integral[at + 3u] = s3;
        integral[at + 4u] = sum;
    }
    if params.width % 4u == 0u {
        return;
    }
    var last_word = luma[first + full_words];
    for (var x = 4u * full_words; x < params.width; x++) {
        sum += last_word & 255u;
        last_word >>= 8u;
        integral[row_start + x + 1u] = sum;
    }
}
