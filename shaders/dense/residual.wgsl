// Photometric residual of each pixel: the absolute difference of the lumas of the pixel and its partner at the nearest
// whole disparity, at most LIMIT; 0 without a disparity, LIMIT with a partner outside the picture.

#import consistent
#import brightness

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   NONE               sentinel: the pixel has no disparity
//   LIMIT              largest residual, in grey levels

struct Params {
    width: u32,
    rows: u32,
    // Picture row of the first row of disparities.
    first_row: u32,
    // Partner column = column + direction * disparity: -1 if the reference is the left view, 1 if the right view.
    direction: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Brightness correction of the right view.
@group(0) @binding(1) var<uniform> brightness: Brightness;
// Four pixels packed per u32, rows of ceil(width / 4) u32.
@group(0) @binding(2) var<storage, read> left: array<u32>;
@group(0) @binding(3) var<storage, read> right: array<u32>;
// One i32 per pixel of the reference view: the disparity, fixed-point.
@group(0) @binding(4) var<storage, read> disparities: array<i32>;
// One byte per pixel, packed as the pictures.
@group(0) @binding(5) var<storage, read_write> residuals: array<u32>;

// One thread computes four pixels, which are one u32.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4 * i32(id.x);
    let width = i32(params.width);
    if x >= width || id.y >= params.rows {
        return;
    }
    let stride = (params.width + 3u) / 4u;
    let row = (params.first_row + id.y) * stride;
    var lumas: array<vec4<i32>, 2>;
    var known: vec4<bool>;
    var outside: vec4<bool>;
    for (var t = 0; t < 4; t++) { // unroll
        let column = min(x + t, width - 1);
        let disparity = disparities[id.y * params.width + u32(column)];
        let partner = partner_of(column, disparity, params.direction);
        let nearest = clamp(partner, 0, width - 1);
        let in_left = u32(select(nearest, column, params.direction < 0));
        let in_right = u32(select(column, nearest, params.direction < 0));
        lumas[0][t] = i32((left[row + in_left / 4u] >> (8u * (in_left % 4u))) & 255u);
        lumas[1][t] = i32((right[row + in_right / 4u] >> (8u * (in_right % 4u))) & 255u);
        known[t] = (disparity != NONE) & (x + t < width);
        outside[t] = partner != nearest;
    }
    let difference = min(abs(lumas[0] - brightened(lumas[1], brightness)), vec4<i32>(LIMIT));
    let bytes = vec4<u32>(select(vec4<i32>(0), select(difference, vec4<i32>(LIMIT), outside), known));
    residuals[id.y * stride + id.x] = bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}
