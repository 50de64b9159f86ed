// From the costs of a pixel's disparities that matter to its answer: uniqueness, sub-pixel interpolation,
// confidence.
//
// A cost is carried shifted left by SHIFT, with the disparity's index in the free bits: that number
// is the comparison key and the answer at once, and of equal costs the smaller disparity wins.
//
// The module around it has `params` with `min_disparity` (of index 0) and `uniqueness` (per cent).

#import quotient

const NOTHING = 0xffffffffu;
const INDEX_MASK = (1u << SHIFT) - 1u;

// The minimum's place between its neighbours' costs, in 1/256 px from the winner, -128 to 128: the
// nearest integer to 128 (left - right) / divisor, halves up.
fn subpixel(below: u32, best: u32, above: u32) -> i32 {
    let left = below - best;
    let right = above - best;
    var divisor = 0u;
    if INTERPOLATION == PARABOLA {
        divisor = left + right;
    } else if INTERPOLATION == EQUIANGULAR {
        divisor = max(left, right);
    }
    // 128 is added before the division, and taken away after it, to keep it unsigned.
    let nearest = i32(quotient(256u * (left - right) + 257u * divisor, max(2u * divisor, 1u))) - 128;
    return select(nearest, 0, divisor == 0u);
}

// The disparity of a pixel, as bits, and its confidence.
fn answer(best: u32, rival: u32, below: u32, above: u32) -> vec2<u32> {
    let whole = (params.min_disparity + i32(best & INDEX_MASK)) * SCALE;
    let exists = best != NOTHING;
    if FULL == 0 {
        return vec2<u32>(u32(select(NONE, whole, exists)), 0u);
    }
    let cost = best >> SHIFT;
    let rival_cost = rival >> SHIFT;
    let unrivalled = rival == NOTHING;
    let unique = params.uniqueness == 0u || unrivalled || rival_cost * 100u > cost * (100u + params.uniqueness);
    let has_neighbours = below != NOTHING && above != NOTHING;
    let fraction = select(0, subpixel(below >> SHIFT, cost, above >> SHIFT), has_neighbours);
    let margin = select(quotient(254u * (rival_cost - cost), max(rival_cost, 1u)), 0u, unrivalled);
    let holds = exists && unique;
    return vec2<u32>(u32(select(NONE, whole + fraction, holds)), select(0u, 1u + margin, holds));
}
