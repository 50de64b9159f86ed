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
//   WIDE               1: wide census transforms too
//   SPREAD             largest difference of the sums of weak texture

// Sums of lumas in one row, two per u32: of the thread's four pixels and of four pixels on either side; of four pixels the
// first and the third, then the second and the fourth.
alias Sums = array<vec2<u32>, 3>;
// Lumas or sums in one row, one each.
alias Row = array<vec4<u32>, 3>;

// Two pairs of lumas: of a word's four lumas the first and the third, then the second and the fourth.
fn pairs(word: u32) -> vec2<u32> {
    return vec2<u32>(word, word >> 8u) & vec2<u32>(0x00ff00ffu);
}

// The second of `first` and the first of `second`.
fn joined(first: u32, second: u32) -> u32 {
    return (first >> 16u) | (second << 16u);
}

// Per luma of four: sum of the luma and its neighbours in the row, from the pairs of the word and of those beside it. Of sums in
// place of lumas too.
fn sums_of_three(before: vec2<u32>, own: vec2<u32>, after: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(joined(before.y, own.y), joined(own.x, after.x)) + own + own.yx;
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

// The transforms of four pixels, from five rows of lumas: of the pixels and of four columns on either side, packed; and from
// five rows of sums of 3x3 lumas, two rows apart. The pixels are in the third of the rows.
fn transforms(lumas: array<vec3<u32>, 5>, sums: array<Sums, 5>) -> Transforms {
    let centre = lumas_of(lumas[2].y);
    let sum = sums_of(sums[2][1]);
    var bits = vec4<u32>(0u);
    var wide_bits = vec4<u32>(0u);
    var least = sum;
    var largest = sum;
    for (var j = 0; j < 5; j++) { // unroll
        let words = lumas[j];
        let row = neighbours(Row(lumas_of(words.x), lumas_of(words.y), lumas_of(words.z)));
        let far = far_neighbours(Row(sums_of(sums[j][0]), sums_of(sums[j][1]), sums_of(sums[j][2])));
        for (var i = 0; i < 5; i++) { // unroll
            if i != 2 || j != 2 {
                let is_darker = row[i] < centre;
                bits = with_bit(bits, is_darker);
                if WIDE != 0 {
                    if (i + j) % 2 == 0 {
                        wide_bits = with_bit(wide_bits, far[i] < sum);
                        least = min(least, far[i]);
                        largest = max(largest, far[i]);
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
