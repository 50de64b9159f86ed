// Wide census transform: one bit per neighbour of a pixel, 1 if the 3x3 lumas around the neighbour have a smaller sum
// than those around the pixel. The neighbours are 5x5 pixels at a distance of two columns and two rows, so that a pixel
// is compared with all of 11x11. Sums have a third of the noise: they tell neighbours apart where the lumas of weak
// texture differ by less than their noise.
//
// One u32 per pixel: 24 bits, the upper left neighbour the highest, above 8 bits that are 1 where texture is weak and 0
// elsewhere. Texture is weak where the 25 sums differ by at most SPREAD.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   ROWS               rows of pixels per thread
//   SPREAD             largest difference of the sums of weak texture

struct Params {
    width: u32,
    rows: u32,
    // u32 per row of the padded plane, which begins eight columns left of and five rows above the picture.
    stride: u32,
    // Index in `census` where the wide census transforms begin.
    offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Padded plane, four pixels packed per u32.
@group(0) @binding(1) var<storage, read> plane: array<u32>;
// One u32 per pixel: wide census bits above the mark of weak texture.
@group(0) @binding(2) var<storage, read_write> census: array<u32>;

// Values in one row: of the thread's four pixels and of four pixels on either side.
alias Row = array<vec4<u32>, 3>;

fn lumas_at(word: u32) -> vec4<u32> {
    return (vec4<u32>(plane[word]) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

// Sums of three lumas of a row, from the word eight columns left of the thread's pixels on.
fn sums_along_row(first: u32) -> Row {
    var lumas: array<vec4<u32>, 5>;
    for (var i = 0; i < 5; i++) { // unroll
        lumas[i] = lumas_at(first + i);
    }
    var sums: Row;
    for (var i = 0; i < 3; i++) { // unroll
        sums[i] = vec4<u32>(lumas[i].w, lumas[i + 1].xyz) + lumas[i + 1] + vec4<u32>(lumas[i + 1].yzw, lumas[i + 2].x);
    }
    return sums;
}

// Sums of 3x3 lumas, from the sums along three rows.
fn sums_of(above: Row, middle: Row, below: Row) -> Row {
    return Row(above[0] + middle[0] + below[0], above[1] + middle[1] + below[1], above[2] + middle[2] + below[2]);
}

// The sums of four pixels' neighbours in a row: two pixels apart, the first four columns to the left.
fn neighbours(sums: Row) -> array<vec4<u32>, 5> {
    return array<vec4<u32>, 5>(
        sums[0],
        vec4<u32>(sums[0].zw, sums[1].xy),
        sums[1],
        vec4<u32>(sums[1].zw, sums[2].xy),
        sums[2],
    );
}

// Wide census transforms of four pixels, from the sums in nine rows.
fn transformed(window: array<Row, 9>) -> vec4<u32> {
    let centre = window[4][1];
    var bits = vec4<u32>(0u);
    var least = centre;
    var largest = centre;
    for (var j = 0; j < 5; j++) { // unroll
        let row = neighbours(window[2 * j]);
        for (var i = 0; i < 5; i++) { // unroll
            if i != 2 || j != 2 {
                bits = (bits << vec4<u32>(1u)) | select(vec4<u32>(0u), vec4<u32>(1u), row[i] < centre);
                least = min(least, row[i]);
                largest = max(largest, row[i]);
            }
        }
    }
    let weak = select(vec4<u32>(0u), vec4<u32>(1u), largest - least <= vec4<u32>(SPREAD));
    return (bits << vec4<u32>(8u)) | weak;
}

// One thread transforms 4 x ROWS pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    let first = ROWS * id.y;
    if x >= params.width || first >= params.rows {
        return;
    }
    var above = sums_along_row(first * params.stride + id.x);
    var middle = sums_along_row((first + 1u) * params.stride + id.x);
    var window: array<Row, 9>;
    for (var j = 0; j < 8; j++) { // unroll
        let below = sums_along_row((first + j + 2u) * params.stride + id.x);
        window[j + 1] = sums_of(above, middle, below);
        above = middle;
        middle = below;
    }
    for (var y = first; y < min(first + ROWS, params.rows); y++) {
        for (var j = 0; j < 8; j++) { // unroll
            window[j] = window[j + 1];
        }
        let below = sums_along_row((y + 10u) * params.stride + id.x);
        window[8] = sums_of(above, middle, below);
        above = middle;
        middle = below;
        let words = transformed(window);
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < params.width {
                census[params.offset + y * params.width + x + t] = words[t];
            }
        }
    }
}
