// Luma, packed four pixels a word, in rows of ceil(width / 4) words; what lies beyond the width is 0.
//
// The module around it has `params` with `width` and `height`, the output `luma`, and `luma_at`, the luma of a pixel. One
// thread makes one word, so that no two threads write the same one.

fn luma_of(bytes: vec3u) -> u32 {
    return (77u * bytes.r + 150u * bytes.g + 29u * bytes.b + 128u) >> 8u;
}

fn luma_or_nothing(x: u32, y: u32) -> u32 {
    if x >= params.width {
        return 0u;
    }
    return luma_at(x, y);
}

fn luma_word(x: u32, y: u32) -> u32 {
    return luma_or_nothing(x, y)
        | (luma_or_nothing(x + 1u, y) << 8u)
        | (luma_or_nothing(x + 2u, y) << 16u)
        | (luma_or_nothing(x + 3u, y) << 24u);
}
