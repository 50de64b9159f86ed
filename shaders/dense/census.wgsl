// Census transform: one bit per neighbour of a pixel in its 5x5 window, 1 if the neighbour is darker.
//
// Zabih and Woodfill: 'Non-parametric local transforms for computing visual correspondence', ECCV 1994. One u32 per
// pixel holds all inputs of the matching cost: 24 bits, the upper left neighbour the highest, above 8 bits of the
// pixel's luma.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   ROWS               rows of pixels per thread
//   HALO_WORDS         u32 of the padded plane on either side of a row of the picture
//   HALO_ROWS          rows of the padded plane above the picture

struct Params {
    width: u32,
    rows: u32,
    // u32 per row of the padded plane.
    stride: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Padded plane, four pixels packed per u32.
@group(0) @binding(1) var<storage, read> plane: array<u32>;
// One u32 per pixel: census bits above the luma.
@group(0) @binding(2) var<storage, read_write> census: array<u32>;

// One row: lumas of the thread's four pixels and of the halo, two pixels on either side.
alias Row = array<u32, 8>;

fn row_at(first: u32) -> Row {
    let left = plane[first];
    let middle = plane[first + 1u];
    let right = plane[first + 2u];
    return Row(
        (left >> 16u) & 255u, left >> 24u,
        middle & 255u, (middle >> 8u) & 255u, (middle >> 16u) & 255u, middle >> 24u,
        right & 255u, (right >> 8u) & 255u,
    );
}

// Census transforms of four pixels.
fn transformed(window: array<Row, 5>) -> vec4<u32> {
    let centre = vec4<u32>(window[2][2], window[2][3], window[2][4], window[2][5]);
    var bits = vec4<u32>(0u);
    for (var j = 0; j < 5; j++) { // unroll
        for (var i = 0; i < 5; i++) { // unroll
            if i != 2 || j != 2 {
                let other = vec4<u32>(window[j][i], window[j][i + 1], window[j][i + 2], window[j][i + 3]);
                bits = (bits << vec4<u32>(1u)) | select(vec4<u32>(0u), vec4<u32>(1u), other < centre);
            }
        }
    }
    return (bits << vec4<u32>(8u)) | centre;
}

// One thread transforms 4 x ROWS pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    let first = ROWS * id.y;
    if x >= params.width || first >= params.rows {
        return;
    }
    // The first row of the window and the four pixels left of the thread's pixels.
    let begin = (HALO_ROWS - 2u) * params.stride + HALO_WORDS - 1u + id.x;
    var window: array<Row, 5>;
    var missing = 5u;
    for (var y = first; y < min(first + ROWS, params.rows); y++) {
        // All rows of the first window, one more row for each later window.
        for (; missing > 0u; missing--) {
            for (var j = 0; j < 4; j++) { // unroll
                window[j] = window[j + 1];
            }
            window[4] = row_at(begin + (y + 5u - missing) * params.stride);
        }
        missing = 1u;
        let words = transformed(window);
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < params.width {
                census[y * params.width + x + t] = words[t];
            }
        }
    }
}
