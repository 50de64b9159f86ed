// Matching cost of each pixel and disparity, 8 bits each: see shared/pixel_cost.wgsl.
//
// One thread owns PIXELS pixels and visits the disparities, four per step. A step needs three pixels more of the other
// view, and their two neighbours; four of these are new. A partner outside the picture is replaced by the nearest pixel of
// its row.
//
// The shader is built for two layouts of the volume, in its own file in shared/, which has the words of a pixel:
// whole_layout.wgsl and cell_layout.wgsl.

#import pixel_cost

// Constants:
//   WORKGROUP_WIDTH     threads per workgroup along x
//   WORKGROUP_HEIGHT    threads per workgroup along y
//   PIXELS              pixels per thread
//   QUADS               PIXELS / 4
//   DIRECTION           partner column = column + DIRECTION * disparity: -1 if the reference is the left view, 1 if the
//                       right view
//   FRONT               element of `b` that holds the partner of the first pixel at a step's first disparity
//   KEPT                first element of `b` that the first step takes over from the load before the loop
//   NEW                 first element of `b` that a step loads

struct Params {
    width: u32,
    // Rows of the band, and the row of the census transforms where the band begins.
    rows: u32,
    first_row: u32,
    min_disparity: i32,
    // The volume: costs of four disparities packed per u32, the smallest disparity in the lowest byte. With one range for
    // all pixels, u32 per pixel; with ranges of cells, the row of the picture where the band begins, and see
    // shared/cell_layout.wgsl.
    pixel_words: u32,
    top: u32,
    columns: u32,
    cells: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Per pixel of the reference view, and of the other view: census bits above 8 bits of luma; wide census bits above 8 bits
// that are 1 where texture is weak.
@group(0) @binding(1) var<storage, read> reference: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> other: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> volume: array<u32>;

// The column nearest to x inside the picture.
fn inside(x: i32) -> u32 {
    return u32(clamp(x, 0, i32(params.width) - 1));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = i32(PIXELS * id.x);
    if u32(x) >= params.width || id.y >= params.rows {
        return;
    }
    let row = (params.first_row + id.y) * params.width;
    var a_row: array<vec2<u32>, PIXELS + 2>;
    for (var i = 0; i < PIXELS + 2; i++) { // unroll
        a_row[i] = reference[row + inside(x - 1 + i)];
    }
    var a: array<Pixels, QUADS>;
    for (var q = 0; q < QUADS; q++) { // unroll
        a[q].census = vec4<u32>(a_row[4 * q + 1].x, a_row[4 * q + 2].x, a_row[4 * q + 3].x, a_row[4 * q + 4].x);
        a[q].wide = vec4<u32>(a_row[4 * q + 1].y, a_row[4 * q + 2].y, a_row[4 * q + 3].y, a_row[4 * q + 4].y);
        a[q].gradient = vec4<i32>(
            luma(a_row[4 * q + 2].x) - luma(a_row[4 * q].x),
            luma(a_row[4 * q + 3].x) - luma(a_row[4 * q + 1].x),
            luma(a_row[4 * q + 4].x) - luma(a_row[4 * q + 2].x),
            luma(a_row[4 * q + 5].x) - luma(a_row[4 * q + 3].x),
        );
    }
    // Consecutive pixels of the other view: the PIXELS + 3 partners of a step and one neighbour on either side.
    // Before the loop the pixels are loaded that the first step shares with a step before it.
    let span = span_at(u32(x), params.top + id.y);
    let begin = x + DIRECTION * (params.min_disparity + 4 * i32(span.first)) - FRONT;
    var b: array<vec2<u32>, PIXELS + 5>;
    for (var i = 0; i < PIXELS + 1; i++) { // unroll
        b[i + KEPT] = other[row + inside(begin + i + KEPT - DIRECTION * 4)];
    }
    for (var step = 0u; step < span.count; step++) {
        let first = begin + DIRECTION * 4 * i32(step);
        if DIRECTION < 0 {
            for (var i = 0; i < PIXELS + 1; i++) { // unroll
                b[PIXELS + 4 - i] = b[PIXELS - i];
            }
        } else {
            for (var i = 0; i < PIXELS + 1; i++) { // unroll
                b[i] = b[i + 4];
            }
        }
        for (var i = 0; i < 4; i++) { // unroll
            b[NEW + i] = other[row + inside(first + NEW + i)];
        }
        var gradient_b: array<i32, PIXELS + 3>;
        for (var i = 0; i < PIXELS + 3; i++) { // unroll
            gradient_b[i] = luma(b[i + 2].x) - luma(b[i].x);
        }
        for (var q = 0; q < QUADS; q++) { // unroll
            var costs_of = vec4<u32>(0u);
            for (var k = 0; k < 4; k++) { // unroll
                let partners = Pixels(
                    vec4<u32>(
                        b[FRONT + 4 * q + DIRECTION * k].x,
                        b[FRONT + 4 * q + DIRECTION * k + 1].x,
                        b[FRONT + 4 * q + DIRECTION * k + 2].x,
                        b[FRONT + 4 * q + DIRECTION * k + 3].x,
                    ),
                    vec4<u32>(
                        b[FRONT + 4 * q + DIRECTION * k].y,
                        b[FRONT + 4 * q + DIRECTION * k + 1].y,
                        b[FRONT + 4 * q + DIRECTION * k + 2].y,
                        b[FRONT + 4 * q + DIRECTION * k + 3].y,
                    ),
                    vec4<i32>(
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k],
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k + 1],
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k + 2],
                        gradient_b[FRONT - 1 + 4 * q + DIRECTION * k + 3],
                    ),
                );
                let costs = cost(a[q], partners);
                costs_of |= costs << vec4<u32>(8u * k);
            }
            for (var t = 0; t < 4; t++) { // unroll
                let column = u32(x) + 4u * q + t;
                if column < params.width {
                    volume[span.start + (4u * q + t) * span.count + step] = costs_of[t];
                }
            }
        }
    }
}
