// The map of a resampling: the position in the source that each pixel shows, from nodes at every 2^spacing_bits-th pixel along x
// and y.
//
// The module has `params` with `columns`, the nodes per row, and `spacing_bits`, and `nodes`.

// Constants:
//   SUBPIXEL_BITS      bits after the point of positions
//   NONE_NODE          coordinates of a node without a position

const ONE = 1 << SUBPIXEL_BITS;

// (a (S - t) + b t) / S with S = 2^spacing_bits, rounded to the nearest, halves up. The difference fits in 32 bits, its
// product with t may not.
fn between(a: vec2<i32>, b: vec2<i32>, t: i32) -> vec2<i32> {
    let difference = b - a;
    let spacing = 1 << params.spacing_bits;
    let bits = vec2<u32>(params.spacing_bits);
    let rest = difference & vec2<i32>(spacing - 1);
    return a + (difference >> bits) * t + ((rest * t + spacing / 2) >> bits);
}

// The position that pixel (x, y) shows; NONE_NODE without one.
fn position_at(x: u32, y: u32) -> vec2<i32> {
    let node = (y >> params.spacing_bits) * params.columns + (x >> params.spacing_bits);
    let below = node + params.columns;
    let corners = array<vec2<i32>, 4>(nodes[node], nodes[node + 1u], nodes[below], nodes[below + 1u]);
    if any(vec4<i32>(corners[0].x, corners[1].x, corners[2].x, corners[3].x) == vec4<i32>(NONE_NODE)) {
        return vec2<i32>(NONE_NODE);
    }
    let t = vec2<i32>(vec2<u32>(x, y)) & vec2<i32>((1 << params.spacing_bits) - 1);
    return between(between(corners[0], corners[2], t.y), between(corners[1], corners[3], t.y), t.x);
}
