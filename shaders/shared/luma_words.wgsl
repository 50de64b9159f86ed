// Luma of RGB, four pixels packed per u32, in rows of ceil(width / 4) u32; bytes beyond the width are 0. The weights
// are those of ITU-R BT.601 in 1/256. One thread makes one u32, so that no two threads write to one u32.
//
// The module has `params` with `width`, and `luma_at`, the luma of the pixel in column x of row y.

// Luma of red, green and blue, 0 to 255, rounded to the nearest.
fn luma_of(bytes: vec3u) -> u32 {
    return (77u * bytes.r + 150u * bytes.g + 29u * bytes.b + 128u) >> 8u;
}

fn luma_or_zero(x: u32, y: u32) -> u32 {
    if x >= params.width {
        return 0u;
    }
    return luma_at(x, y);
}

// Luma of the four pixels from column x on, the first in the lowest byte.
fn luma_word(x: u32, y: u32) -> u32 {
    return luma_or_zero(x, y)
        | (luma_or_zero(x + 1u, y) << 8u)
        | (luma_or_zero(x + 2u, y) << 16u)
        | (luma_or_zero(x + 3u, y) << 24u);
}
