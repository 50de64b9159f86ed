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

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let words = (params.width + 3u) / 4u;
    if id.x >= words || id.y >= params.height {
        return;
    }
    let x = 4u * id.x;
    luma[id.y * words + id.x] = luma_or_nothing(x, id.y)
        | (luma_or_nothing(x + 1u, id.y) << 8u)
        | (luma_or_nothing(x + 2u, id.y) << 16u)
        | (luma_or_nothing(x + 3u, id.y) << 24u);
}
