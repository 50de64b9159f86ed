// Disparity and confidence of a pixel, from the costs of the winner, its two neighbours and its rival: uniqueness
// check, sub-pixel interpolation, confidence. The rival is the best disparity two or more away from the winner.
//
// A key is a cost shifted left by SHIFT with the disparity's index in the free bits: comparing keys compares costs and
// keeps the index, and of equal costs the smaller disparity wins.
//
// The module has `params` with `min_disparity`, the disparity of index 0 in pixels, and `uniqueness` in per cent.

#import quotient

// Constants:
//   SHIFT           bits of a disparity's index in a key
//   FULL            1: sub-pixel disparity, uniqueness check and confidence; 0: the winner's whole disparity alone
//   INTERPOLATION   sub-pixel interpolation: PARABOLA, EQUIANGULAR, or 0 for none
//   PARABOLA        value of INTERPOLATION: vertex of the parabola through the three costs
//   EQUIANGULAR     value of INTERPOLATION: intersection of two lines of opposite slopes through the three costs
//   SCALE           disparity units per pixel
//   NONE            sentinel: the pixel has no disparity
//   MEASURED        least confidence of a disparity

// Sentinel: no disparity; larger than any key.
const NO_KEY = 0xffffffffu;
const INDEX_MASK = (1u << SHIFT) - 1u;

// Offset of the sub-pixel minimum from the winner, -128 to 128 in 1/256 px, from the costs of the winner and its two
// neighbours: 128 (left - right) / divisor, rounded to the nearest, halves up.
fn subpixel(below: u32, best: u32, above: u32) -> i32 {
    let left = below - best;
    let right = above - best;
    var divisor = 0u;
    if INTERPOLATION == PARABOLA {
        divisor = left + right;
    } else if INTERPOLATION == EQUIANGULAR {
        divisor = max(left, right);
    }
    // Adding 128 before the division, and subtracting 128 after the division, keeps the numerator unsigned.
    let nearest = i32(quotient(256u * (left - right) + 257u * divisor, max(2u * divisor, 1u))) - 128;
    return select(nearest, 0, divisor == 0u);
}

// The disparity of a pixel, the bits of an i32, and its confidence, MEASURED to 255 or 0 without a disparity; from the keys of
// the winner, the rival and the winner's two neighbours.
fn disparity_and_confidence(best: u32, rival: u32, below: u32, above: u32) -> vec2<u32> {
    let winner = (params.min_disparity + i32(best & INDEX_MASK)) * SCALE;
    let exists = best != NO_KEY;
    if FULL == 0 {
        return vec2<u32>(u32(select(NONE, winner, exists)), 0u);
    }
    let cost = best >> SHIFT;
    let rival_cost = rival >> SHIFT;
    let unrivalled = rival == NO_KEY;
    let unique = params.uniqueness == 0u || unrivalled || rival_cost * 100u > cost * (100u + params.uniqueness);
    let has_neighbours = below != NO_KEY && above != NO_KEY;
    let fraction = select(0, subpixel(below >> SHIFT, cost, above >> SHIFT), has_neighbours);
    let margin = select(quotient(254u * (rival_cost - cost), max(rival_cost, 1u)), 0u, unrivalled);
    let is_match = exists && unique;
    return vec2<u32>(u32(select(NONE, winner + fraction, is_match)), select(0u, max(1u + margin, MEASURED), is_match));
}
