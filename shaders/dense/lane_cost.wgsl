// Matching cost of each pixel and disparity, for devices with many threads: see shared/pixel_cost.wgsl. A thread computes the
// costs of 16 disparities of a pixel; neighbouring threads write neighbouring vectors. A partner outside the picture is
// replaced by the nearest pixel of its row.

#import pixel_cost

// Constants:
//   WORKGROUP   threads per workgroup
//   DIRECTION   partner column = column + DIRECTION * disparity: -1 if the reference is the left view, 1 if the right view

struct Params {
    width: u32,
    // Row of the census transforms where the band begins.
    first_row: u32,
    min_disparity: i32,
    // Vectors per pixel of the volume.
    quads: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Per pixel of the reference view, and of the other view: census bits above 8 bits of luma; wide census bits above 8 bits
// that are 1 where texture is weak.
@group(0) @binding(1) var<storage, read> reference: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> other: array<vec2<u32>>;
// The volume: `quads` vectors per pixel, costs of four disparities packed per u32, the smallest disparity in the lowest byte.
@group(0) @binding(3) var<storage, read_write> volume: array<vec4<u32>>;

// The column nearest to x inside the picture.
fn inside(x: i32) -> u32 {
    return u32(clamp(x, 0, i32(params.width) - 1));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = id.x / params.quads;
    let quad = id.x % params.quads;
    if x >= params.width {
        return;
    }
    let row = (params.first_row + id.y) * params.width;
    let pixel = reference[row + x];
    let gradient = luma(reference[row + inside(i32(x) + 1)].x) - luma(reference[row + inside(i32(x) - 1)].x);
    let a = Pixels(vec4<u32>(pixel.x), vec4<u32>(pixel.y), vec4<i32>(gradient));
    // The partners in the order of their disparities, between a neighbour on either side.
    let first = i32(x) + DIRECTION * (params.min_disparity + 16 * i32(quad) - 1);
    var b: array<vec2<u32>, 18>;
    for (var i = 0; i < 18; i++) { // unroll
        b[i] = other[row + inside(first + DIRECTION * i)];
    }
    var packed: vec4<u32>;
    for (var k = 0; k < 4; k++) { // unroll
        let partners = Pixels(
            vec4<u32>(b[4 * k + 1].x, b[4 * k + 2].x, b[4 * k + 3].x, b[4 * k + 4].x),
            vec4<u32>(b[4 * k + 1].y, b[4 * k + 2].y, b[4 * k + 3].y, b[4 * k + 4].y),
            DIRECTION * vec4<i32>(
                luma(b[4 * k + 2].x) - luma(b[4 * k].x),
                luma(b[4 * k + 3].x) - luma(b[4 * k + 1].x),
                luma(b[4 * k + 4].x) - luma(b[4 * k + 2].x),
                luma(b[4 * k + 5].x) - luma(b[4 * k + 3].x),
            ),
        );
        let costs = cost(a, partners);
        packed[k] = costs.x | (costs.y << 8u) | (costs.z << 16u) | (costs.w << 24u);
    }
    volume[(id.y * params.width + x) * params.quads + quad] = packed;
}
