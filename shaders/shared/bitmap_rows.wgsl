// Reading the bitmap along rows of bitmap.wgsl.
//
// The module has `params` with `width` and `height`, and `bitmaps`.

// Word `word` of row `y`: bit i is pixel 32 word + i. Outside the picture no bit is set.
fn row_word(word: i32, y: i32) -> u32 {
    let row_words = (i32(params.width) + 31) / 32;
    let inside = vec2<i32>(clamp(word, 0, row_words - 1), clamp(y, 0, i32(params.height) - 1));
    return select(0u, bitmaps[inside.y * row_words + inside.x], (inside.x == word) & (inside.y == y));
}

// The bits of word `word` that lie in the picture.
fn in_picture(word: i32) -> u32 {
    let pixels = i32(params.width) - 32 * word;
    return select((1u << (u32(pixels) % 32u)) - 1u, 0xffffffffu, pixels >= 32);
}

// The pixels of word `word` of row `y` that lie in the picture and have no disparity.
fn holes_of(word: i32, y: i32) -> u32 {
    let row_words = (i32(params.width) + 31) / 32;
    let is_in_picture = (word >= 0) & (word < row_words) & (y >= 0) & (y < i32(params.height));
    return select(0u, ~row_word(word, y) & in_picture(word), is_in_picture);
}
