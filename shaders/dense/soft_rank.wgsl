// Soft ranks: padding as by the stage `pad`, of a byte per pixel that does not depend on brightness. The rank transform
// counts the neighbours that are brighter than the pixel; here each neighbour adds its difference from the pixel, at
// most LIMIT to either side, so that noise of a grey level does not decide.
//
// Zabih and Woodfill: 'Non-parametric local transforms for computing visual correspondence', ECCV 1994 (rank transform).
//
// The ten neighbours, with their weights:
//
//     .  .  1  .  2  .  1  .  .
//     .  .  .  .  .  .  .  .  .
//     1  1  .  .  p  .  .  1  1
//     .  .  .  .  .  .  .  .  .
//     .  .  1  .  2  .  1  .  .

#import edges

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   ROWS               rows of words per thread, two rows apart
//   LIMIT              largest difference of a neighbour that counts, in grey levels
//   MIDDLE             soft rank of a pixel as bright as its neighbours

struct Params {
    width: u32,
    height: u32,
    // First column in u32 and first row of the padded plane, from the picture's corner; negative: left of or above the
    // picture.
    first_word: i32,
    first_row: i32,
    rows: u32,
    // u32 per row of the padded plane, and index in `padded` where the plane begins.
    stride: u32,
    offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Four pixels packed per u32, rows of ceil(width / 4) u32.
@group(0) @binding(1) var<storage, read> luma: array<u32>;
@group(0) @binding(2) var<storage, read_write> padded: array<u32>;

// Twelve pixels of a row, four per vector.
struct Row {
    left: vec4<i32>,
    middle: vec4<i32>,
    right: vec4<i32>,
}

// Four pixels of row y, from column 4 word on.
fn pixels_at(word: i32, y: i32) -> vec4<i32> {
    let width = i32(params.width);
    let row = clamp(y, 0, i32(params.height) - 1) * ((width + 3) / 4);
    let packed = with_edges(word, luma[row + clamp(word, 0, (width - 1) / 4)], width);
    return vec4<i32>((vec4<u32>(packed) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u));
}

fn row_at(word: i32, y: i32) -> Row {
    return Row(pixels_at(word - 1, y), pixels_at(word, y), pixels_at(word + 1, y));
}

// What four neighbours add to the soft ranks of four pixels.
fn excess(neighbours: vec4<i32>, pixels: vec4<i32>) -> vec4<i32> {
    return clamp(neighbours - pixels, vec4<i32>(-LIMIT), vec4<i32>(LIMIT));
}

// What the neighbours in a row two rows above or below add.
fn excess_beyond(row: Row, pixels: vec4<i32>) -> vec4<i32> {
    return 2 * excess(row.middle, pixels)
        + excess(vec4<i32>(row.left.zw, row.middle.xy), pixels)
        + excess(vec4<i32>(row.middle.zw, row.right.xy), pixels);
}

// Soft ranks of four pixels, packed, from their row and the rows two above and two below.
fn ranks(above: Row, row: Row, below: Row) -> u32 {
    let pixels = row.middle;
    let sum = excess(row.left, pixels)
        + excess(vec4<i32>(row.left.yzw, row.middle.x), pixels)
        + excess(vec4<i32>(row.middle.w, row.right.xyz), pixels)
        + excess(row.right, pixels)
        + excess_beyond(above, pixels)
        + excess_beyond(below, pixels);
    let bytes = vec4<u32>(MIDDLE + sum);
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}

// One thread makes a column of ROWS words, two rows apart, so that each row is loaded once: two threads take turns with
// the rows of the picture.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let last = i32(params.height) - 1;
    let bottom = params.first_row + i32(params.rows) - 1;
    let first = max(params.first_row, 0) + i32(id.y) / 2 * 2 * ROWS + i32(id.y) % 2;
    if id.x >= params.stride || first > min(bottom, last) {
        return;
    }
    let width = i32(params.width);
    let word = params.first_word + i32(id.x);
    let nearest = clamp(word, 0, (width - 1) / 4);
    var above = row_at(nearest, first - 2);
    var row = row_at(nearest, first);
    for (var i = 0; i < ROWS; i++) {
        let y = first + 2 * i;
        if y > min(bottom, last) {
            return;
        }
        let below = row_at(nearest, y + 2);
        let packed = with_edges(word, ranks(above, row, below), width);
        // Rows outside the picture have the soft ranks of the nearest row inside.
        let top = select(y, params.first_row, y == 0);
        let end = select(y, bottom, y == last);
        for (var at = top; at <= end; at++) {
            padded[params.offset + u32(at - params.first_row) * params.stride + id.x] = packed;
        }
        above = row;
        row = below;
    }
}
