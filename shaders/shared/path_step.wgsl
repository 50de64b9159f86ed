// A step of semi-global matching from a pixel q to the next pixel p of a path, for four disparities at once:
//
//     L(p, d) = C(p, d) + min(L(q, d), L(q, d - 1) + P1, L(q, d + 1) + P1, M + P2) - M,  M = min L(q, .)
//
// P2 is smaller where the luma changes, rounded down:
//
//     P2(p, q) = max(LEAST_P2, P2 K / (K + |luma(p) - luma(q)|)),  K = P2_SCALE

#import quotient

// Constants:
//   P1         penalty of a change of disparity by one
//   P2         penalty of a larger change, at equal lumas
//   LEAST_P2   penalty of a larger change, at least
//   P2_SCALE   change of luma at which P2 is halved, in grey levels

// Sentinel above any path cost, of disparities outside the range.
const UNREACHABLE = 0x10000u;

// P2 between pixels of these lumas.
fn penalty(luma: u32, luma_before: u32) -> u32 {
    let change = u32(abs(i32(luma) - i32(luma_before)));
    return max(LEAST_P2, quotient(P2 * P2_SCALE, P2_SCALE + change));
}

fn unpack(word: u32) -> vec4<u32> {
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

fn pack(costs: vec4<u32>) -> u32 {
    return costs.x | (costs.y << 8u) | (costs.z << 16u) | (costs.w << 24u);
}

// Path costs of four disparities of the next pixel. `quad` holds the path costs of these disparities at the last pixel,
// `quad_before` and `quad_after` those of the next smaller and the next larger four; `jump` is M + P2.
fn advance(
    quad_before: vec4<u32>,
    quad: vec4<u32>,
    quad_after: vec4<u32>,
    jump: u32,
    cost: vec4<u32>,
) -> vec4<u32> {
    let below = vec4<u32>(quad_before.w, quad.xyz);
    let above = vec4<u32>(quad.yzw, quad_after.x);
    return cost + min(min(quad, min(below, above) + P1), vec4<u32>(jump));
}
