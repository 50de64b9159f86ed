// Census transform: one bit per neighbour of a pixel in its 5x5 window, 1 if the neighbour is darker.
//
// Zabih and Woodfill: 'Non-parametric local transforms for computing visual correspondence', ECCV 1994. Two u32 per
// pixel hold all inputs of the matching cost. The first: 24 bits, the upper left neighbour the highest, above 8 bits of the
// pixel's luma.
//
// The second, if WIDE, otherwise 0: the wide census transform, for weak texture. Of its 24 bits every second one, as on a
// chessboard, belongs to a neighbour twice as far away: 1 if the 3x3 lumas around the neighbour have a smaller sum than
// those around the pixel. Sums have a third of the noise of lumas: they tell neighbours apart where texture is weak. The
// other bits are those of the census transform. Below are 8 bits that are 1 where texture is weak and 0 elsewhere:
// weak where the 13 sums differ by at most SPREAD.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   ROWS               rows of pixels per thread
//   WIDE               1: wide census transforms too
//   SPREAD             largest difference of the sums of weak texture

struct Params {
    width: u32,
    rows: u32,
    // u32 per row of the padded plane, which begins eight columns left of and five rows above the picture.
    stride: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Padded plane, four pixels packed per u32.
@group(0) @binding(1) var<storage, read> plane: array<u32>;
// Per pixel census bits above the luma, and wide census bits above the mark of weak texture.
@group(0) @binding(2) var<storage, read_write> census: array<vec2<u32>>;

// Sums of lumas in one row, two per u32: of the thread's four pixels and of four pixels on either side; of four pixels the
// first and the third, then the second and the fourth.
alias Sums = array<vec2<u32>, 3>;
// Lumas or sums in one row, one each.
alias Row = array<vec4<u32>, 3>;

// The last rows that were read, up to five rows below the pixels.
struct Window {
    // Lumas of the pixels' columns and of four columns on either side, packed, from two rows above the pixels on.
    lumas: array<vec3<u32>, 8>,
    // Sums of three lumas of a row, in the last two rows.
    along_row: array<Sums, 2>,
    // Sums of 3x3 lumas, around rows from four above to four below the pixels.
    sums: array<Sums, 9>,
}

// Two pairs of lumas: of a word's four lumas the first and the third, then the second and the fourth.
fn pairs(word: u32) -> vec2<u32> {
    return vec2<u32>(word, word >> 8u) & vec2<u32>(0x00ff00ffu);
}

// The second of `first` and the first of `second`.
fn joined(first: u32, second: u32) -> u32 {
    return (first >> 16u) | (second << 16u);
}

// The window one row further down; the word `first` of the plane is eight columns left of the thread's pixels.
fn next(window: Window, first: u32) -> Window {
    var next = window;
    for (var j = 0; j < 7; j++) { // unroll
        next.lumas[j] = window.lumas[j + 1];
    }
    next.lumas[7] = vec3<u32>(plane[first + 1u], plane[first + 2u], plane[first + 3u]);
    if WIDE != 0 {
        let lumas = array<vec2<u32>, 5>(
            pairs(plane[first]),
            pairs(next.lumas[7].x),
            pairs(next.lumas[7].y),
            pairs(next.lumas[7].z),
            pairs(plane[first + 4u]),
        );
        for (var j = 0; j < 8; j++) { // unroll
            next.sums[j] = window.sums[j + 1];
        }
        next.along_row[0] = window.along_row[1];
        for (var i = 0; i < 3; i++) { // unroll
            let left = joined(lumas[i].y, lumas[i + 1].y);
            let right = joined(lumas[i + 1].x, lumas[i + 2].x);
            next.along_row[1][i] = vec2<u32>(left, right) + lumas[i + 1] + lumas[i + 1].yx;
            next.sums[8][i] = window.along_row[0][i] + window.along_row[1][i] + next.along_row[1][i];
        }
    }
    return next;
}

fn lumas_of(word: u32) -> vec4<u32> {
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

fn sums_of(pairs: vec2<u32>) -> vec4<u32> {
    return vec4<u32>(pairs & vec2<u32>(0xffffu), pairs >> vec2<u32>(16u));
}

// The values of four pixels' neighbours in a row, from the second to the left to the second to the right.
fn neighbours(row: Row) -> array<vec4<u32>, 5> {
    return array<vec4<u32>, 5>(
        vec4<u32>(row[0].zw, row[1].xy),
        vec4<u32>(row[0].w, row[1].xyz),
        row[1],
        vec4<u32>(row[1].yzw, row[2].x),
        vec4<u32>(row[1].zw, row[2].xy),
    );
}

// The same, two columns apart, from the fourth to the left to the fourth to the right.
fn far_neighbours(row: Row) -> array<vec4<u32>, 5> {
    return array<vec4<u32>, 5>(
        row[0],
        vec4<u32>(row[0].zw, row[1].xy),
        row[1],
        vec4<u32>(row[1].zw, row[2].xy),
        row[2],
    );
}

// Appends one bit to each of four: 1 where `is_one`.
fn with_bit(bits: vec4<u32>, is_one: vec4<bool>) -> vec4<u32> {
    return (bits << vec4<u32>(1u)) | select(vec4<u32>(0u), vec4<u32>(1u), is_one);
}

// The transforms of four pixels.
struct Transforms {
    census: vec4<u32>,
    wide: vec4<u32>,
}

fn transforms(window: Window) -> Transforms {
    let centre = lumas_of(window.lumas[2].y);
    let sum = sums_of(window.sums[4][1]);
    var bits = vec4<u32>(0u);
    var wide_bits = vec4<u32>(0u);
    var least = sum;
    var largest = sum;
    for (var j = 0; j < 5; j++) { // unroll
        let words = window.lumas[j];
        let row = neighbours(Row(lumas_of(words.x), lumas_of(words.y), lumas_of(words.z)));
        let far = window.sums[2 * j];
        let sums = far_neighbours(Row(sums_of(far[0]), sums_of(far[1]), sums_of(far[2])));
        for (var i = 0; i < 5; i++) { // unroll
            if i != 2 || j != 2 {
                let is_darker = row[i] < centre;
                bits = with_bit(bits, is_darker);
                if WIDE != 0 {
                    if (i + j) % 2 == 0 {
                        wide_bits = with_bit(wide_bits, sums[i] < sum);
                        least = min(least, sums[i]);
                        largest = max(largest, sums[i]);
                    } else {
                        wide_bits = with_bit(wide_bits, is_darker);
                    }
                }
            }
        }
    }
    var transforms = Transforms((bits << vec4<u32>(8u)) | centre, vec4<u32>(0u));
    if WIDE != 0 {
        let weak = select(vec4<u32>(0u), vec4<u32>(1u), largest - least <= vec4<u32>(SPREAD));
        transforms.wide = (wide_bits << vec4<u32>(8u)) | weak;
    }
    return transforms;
}

// One thread transforms 4 x ROWS pixels.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    let first = ROWS * id.y;
    if x >= params.width || first >= params.rows {
        return;
    }
    var window: Window;
    for (var j = 0u; j < 10u; j++) {
        window = next(window, (first + j) * params.stride + id.x);
    }
    for (var y = first; y < min(first + ROWS, params.rows); y++) {
        window = next(window, (y + 10u) * params.stride + id.x);
        let transformed = transforms(window);
        for (var t = 0; t < 4; t++) { // unroll
            if x + t < params.width {
                census[y * params.width + x + t] = vec2<u32>(transformed.census[t], transformed.wide[t]);
            }
        }
    }
}
