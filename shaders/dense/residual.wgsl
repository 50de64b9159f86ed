// The photometric residual: by how much the lumas of a pixel and of its partner differ, at the nearest whole
// disparity, up to LIMIT. It is 0 where there is no disparity, and LIMIT where there is no partner.

#import consistent
#import brightness

struct Params {
    width: u32,
    rows: u32,
    // Of the pictures, the row that the first of the map's belongs to.
    first_row: u32,
    // From a pixel to its partner: -1 where the reference is the left view, 1 where it is the right.
    direction: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Of the right view.
@group(0) @binding(1) var<uniform> brightness: Brightness;
// Four pixels a word, rows of (width + 3) / 4 words.
@group(0) @binding(2) var<storage, read> left: array<u32>;
@group(0) @binding(3) var<storage, read> right: array<u32>;
// Fixed-point, a pixel of the reference view each.
@group(0) @binding(4) var<storage, read> disparities: array<i32>;
// Packed as the pictures are.
@group(0) @binding(5) var<storage, read_write> residuals: array<u32>;

// A thread has four pixels, which are one word.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let width = i32(params.width);
    if x >= width || id.y >= params.rows {
        return;
    }
    let stride = (params.width + 3u) / 4u;
    let row = (params.first_row + id.y) * stride;
    var seen: array<vec4<i32>, 2>;
    var known: vec4<bool>;
    var outside: vec4<bool>;
    for (var t = 0; t < 4; t++) { // unroll
        let column = min(x + t, width - 1);
        let disparity = disparities[id.y * params.width + u32(column)];
        let partner = partner_of(column, disparity, params.direction);
        let nearest = clamp(partner, 0, width - 1);
        let in_left = u32(select(nearest, column, params.direction < 0));
        let in_right = u32(select(column, nearest, params.direction < 0));
        seen[0][t] = i32((left[row + in_left / 4u] >> (8u * (in_left % 4u))) & 255u);
        seen[1][t] = i32((right[row + in_right / 4u] >> (8u * (in_right % 4u))) & 255u);
        known[t] = (disparity != NONE) & (x + t < width);
        outside[t] = partner != nearest;
    }
    let difference = min(abs(seen[0] - brightened(seen[1], brightness)), vec4<i32>(LIMIT));
    let bytes = vec4<u32>(select(vec4<i32>(0), select(difference, vec4<i32>(LIMIT), outside), known));
    residuals[id.y * stride + id.x] = bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}
