// Exact unsigned division by way of floats, since software drivers divide integers one lane at a time.

// floor(numerator / divisor), exact for quotients below 2^20: the estimate is off by at most one, however the float
// division rounds.
fn quotient(numerator: u32, divisor: u32) -> u32 {
    let estimate = u32(f32(numerator) / f32(divisor));
    let remainder = i32(numerator - estimate * divisor);
    return estimate - select(0u, 1u, remainder < 0) + select(0u, 1u, remainder >= i32(divisor));
}
