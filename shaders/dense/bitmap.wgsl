// Bitmaps of the pixels that have a disparity, 32 pixels per u32: along rows, columns and both diagonals, so that a ray
// finds the first such pixel by a few loads.
//
// The words of a row follow each other. The other three bitmaps have one word per column and block of 32 rows: bit j is
// row j of the block, and a diagonal's columns shift by one per row. A word belongs to the column of its first row, from
// MARGIN columns left of the picture to MARGIN columns right of it, so that every diagonal through the picture has words.
//
// A last bitmap, along rows, has the holes that are shown, which shall be filled.

#import bitmap_rows
#import words

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   MARGIN             columns beside the picture: pixels per word
//   NONE               sentinel: the pixel has no disparity

struct Params {
    width: u32,
    height: u32,
    // Row of `shown` of the first row of the map.
    first_row: u32,
    // 1 where `shown` hides pixels; else 0, and all pixels are shown.
    is_masked: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point. A texture, since the loads are scattered.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
// The bitmap along rows; then those along the diagonal to the lower left, the column, and the diagonal to the lower
// right, each block by block of rows; then the holes that are shown.
@group(0) @binding(2) var<storage, read_write> bitmaps: array<u32>;
// Mask of the view, four pixels packed per u32, rows of ceil(width / 4) u32: 0 for a hidden pixel.
@group(0) @binding(3) var<storage, read> shown: array<u32>;

// The bits of 32 pixels from `first` on, in steps of `step`; pixels outside the picture have none.
fn bits(first: vec2<i32>, step: vec2<i32>) -> u32 {
    let last = vec2<i32>(i32(params.width), i32(params.height)) - vec2<i32>(1);
    var result = 0u;
    for (var j = 0; j < 32; j++) {
        let at = first + j * step;
        let inside = clamp(at, vec2<i32>(0), last);
        let disparity = bitcast<i32>(word_at(u32(inside.y) * params.width + u32(inside.x)));
        result |= select(0u, 1u << u32(j), all(at == inside) & (disparity != NONE));
    }
    return result;
}

// The pixels of word `word` of row `y` that are shown; bits beyond the picture have any value.
fn shown_of(word: u32, y: u32) -> u32 {
    if params.is_masked == 0u {
        return 0xffffffffu;
    }
    let row_words = (params.width + 3u) / 4u;
    let row = (params.first_row + y) * row_words;
    var result = 0u;
    for (var i = 0u; i < 8u; i++) {
        let four = shown[row + min(8u * word + i, row_words - 1u)];
        let bytes = (vec4<u32>(four) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
        let bits = select(vec4<u32>(0u), vec4<u32>(1u, 2u, 4u, 8u), bytes != vec4<u32>(0u));
        result |= (bits.x | bits.y | bits.z | bits.w) << (4u * i);
    }
    return result;
}

// One thread makes one word, or two along a row; threads along x make words of different rows, or of different columns.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let row_words = (params.width + 31u) / 32u;
    let columns = params.width + 2u * MARGIN;
    let blocks = (params.height + 31u) / 32u;
    if id.z == 0u {
        if id.x < params.height && id.y < row_words {
            let found = bits(vec2<i32>(32 * i32(id.y), i32(id.x)), vec2<i32>(1, 0));
            let word = id.x * row_words + id.y;
            bitmaps[word] = found;
            let holes = params.height * row_words + 3u * blocks * columns;
            bitmaps[holes + word] = ~found & in_picture(i32(id.y)) & shown_of(id.y, id.x);
        }
    } else if id.x < columns && id.y < blocks {
        let first = vec2<i32>(i32(id.x) - MARGIN, 32 * i32(id.y));
        let word = params.height * row_words + ((id.z - 1u) * blocks + id.y) * columns + id.x;
        bitmaps[word] = bits(first, vec2<i32>(i32(id.z) - 2, 1));
    }
}
