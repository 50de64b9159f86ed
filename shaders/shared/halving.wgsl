// Weights that halve at equal steps of a difference.

// Weight of a difference, 0 to 256: 256 / 2^(difference / 2^halving_bits), interpolated between powers of two.
fn halving_weight(difference: vec4<u32>, halving_bits: u32) -> vec4<u32> {
    let sixteenths = (difference << vec4<u32>(4u)) >> vec4<u32>(halving_bits);
    let fraction = sixteenths & vec4<u32>(15u);
    return ((32u - fraction) * 8u) >> min(sixteenths >> vec4<u32>(4u), vec4<u32>(31u));
}
