// Division of integers that may be negative.

#import quotient

// floor(numerator / divisor) for a positive divisor, exact for quotients below 2^20 in magnitude.
fn floor_div(numerator: i32, divisor: i32) -> i32 {
    let is_negative = numerator < 0;
    // The floor of a negative quotient is the ceiling of its magnitude.
    let magnitude = select(numerator, divisor - 1 - numerator, is_negative);
    let result = i32(quotient(u32(magnitude), u32(divisor)));
    return select(result, -result, is_negative);
}

// The nearest integer to numerator / divisor for a positive divisor; halves of even divisors go up.
fn rounded_div(numerator: i32, divisor: i32) -> i32 {
    return floor_div(numerator + divisor / 2, divisor);
}
