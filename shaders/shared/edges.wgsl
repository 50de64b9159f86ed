// Words of a picture whose edge pixels repeat beyond its left and right edges.

// Mask of the lowest n bytes of a u32; n is clamped to 0 to 4.
fn mask(n: i32) -> u32 {
    let bits = 4u * u32(clamp(n, 0, 4));
    return ~((0xffffffffu << bits) << bits);
}

// The four packed pixels of word `word` of a row of `width` pixels, inside or outside the picture, from `nearest`, the
// nearest word inside.
fn with_edges(word: i32, nearest: u32, width: i32) -> u32 {
    // Masks instead of branches: software drivers run both sides of a branch for every u32.
    let left = mask(-4 * word);
    let right = ~mask(width - 4 * word);
    let first_pixel = (nearest & 255u) * 0x01010101u;
    let last_pixel = ((nearest >> (8u * u32((width - 1) & 3))) & 255u) * 0x01010101u;
    return (first_pixel & left) | (last_pixel & right & ~left) | (nearest & ~left & ~right);
}
