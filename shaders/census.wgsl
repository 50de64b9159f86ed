// The census transform: of each pixel, which of the 24 others of its 5x5 window are darker than it.
//
// Zabih and Woodfill: 'Non-parametric local transforms for computing visual correspondence', ECCV
// 1994. The 24 bits, the neighbour above and to the left the highest, stand above the pixel's own
// luma: one word holds all that the matching cost wants to know.

struct Params {
    width: u32,
    rows: u32,
    // Words a row of the padded plane, which begins four columns left of and two rows above the picture.
    stride: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// The padded plane, four pixels a word.
@group(0) @binding(1) var<storage, read> plane: array<u32>;
// A word a pixel.
@group(0) @binding(2) var<storage, read_write> census: array<u32>;

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    if x >= params.width || id.y >= params.rows {
        return;
    }
    // Two columns left of the thread's four pixels to two right of them.
    var window: array<array<u32, 8>, 5>;
    for (var j = 0; j < 5; j++) { // unroll
        let first = (id.y + j) * params.stride + id.x;
        let left = plane[first];
        let middle = plane[first + 1u];
        let right = plane[first + 2u];
        window[j] = array<u32, 8>(
            (left >> 16u) & 255u, left >> 24u,
            middle & 255u, (middle >> 8u) & 255u, (middle >> 16u) & 255u, middle >> 24u,
            right & 255u, (right >> 8u) & 255u,
        );
    }
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
    let words = (bits << vec4<u32>(8u)) | centre;
    for (var t = 0; t < 4; t++) { // unroll
        if x + t < params.width {
            census[id.y * params.width + x + t] = words[t];
        }
    }
}
