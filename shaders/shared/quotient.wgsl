// The exact quotient, rounded down, where it is below 2^16. By way of floats, since software drivers
// divide integers lane by lane: the estimate is off by one at most, whatever the rounding.
fn quotient(numerator: u32, divisor: u32) -> u32 {
    let estimate = u32(f32(numerator) / f32(divisor));
    let rest = i32(numerator - estimate * divisor);
    return estimate - select(0u, 1u, rest < 0) + select(0u, 1u, rest >= i32(divisor));
}
