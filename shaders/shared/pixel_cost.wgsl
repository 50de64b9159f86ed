// Matching cost of pixels, 8 bits each: the Hamming distance of the census transforms, the difference of the lumas and the
// difference of their horizontal gradients, each weighted, the two differences truncated. Where the reference view has weak
// texture, the wide census transforms take the place of the census transforms, and the lumas have no part.

// Constants:
//   CENSUS_WEIGHT       weight of the Hamming distance, per bit, in 2^-WEIGHT_BITS
//   DIFFERENCE_WEIGHT   weight of the difference of lumas, in 2^-WEIGHT_BITS
//   DIFFERENCE_LIMIT    truncation of the difference of lumas, in grey levels
//   GRADIENT_WEIGHT     weight of the difference of gradients, in 2^-WEIGHT_BITS
//   GRADIENT_LIMIT      truncation of the difference of gradients, in grey levels
//   WEAK_TEXTURE        1: pixels of weak texture have a cost of their own
//   WEIGHT_BITS         fractional bits of the weights
//   MAX_COST            largest cost

fn luma(word: u32) -> i32 {
    return i32(word & 255u);
}

// Four pixels of the reference view, or four of the other view.
struct Pixels {
    // Census bits above the luma.
    census: vec4<u32>,
    // Wide census bits above the mark of weak texture.
    wide: vec4<u32>,
    gradient: vec4<i32>,
}

// Costs of the pixels `a` and their partners `b`.
fn cost(a: Pixels, b: Pixels) -> vec4<u32> {
    let difference = vec4<u32>(abs(vec4<i32>(a.census & vec4<u32>(255u)) - vec4<i32>(b.census & vec4<u32>(255u))));
    let gradient = vec4<u32>(abs(a.gradient - b.gradient));
    var bits = a.census ^ b.census;
    var limit = vec4<u32>(DIFFERENCE_LIMIT);
    if WEAK_TEXTURE != 0 {
        let is_weak = (a.wide & vec4<u32>(1u)) != vec4<u32>(0u);
        bits = select(bits, a.wide ^ b.wide, is_weak);
        limit = select(limit, vec4<u32>(0u), is_weak);
    }
    let sum = CENSUS_WEIGHT * countOneBits(bits >> vec4<u32>(8u))
        + DIFFERENCE_WEIGHT * min(difference, limit)
        + GRADIENT_WEIGHT * min(gradient, vec4<u32>(GRADIENT_LIMIT));
    return min(sum >> vec4<u32>(WEIGHT_BITS), vec4<u32>(MAX_COST));
}
