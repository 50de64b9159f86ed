// Left-right consistency: a disparity stays if its partner in the other view points back at it.
//
// Fua: 'A parallel stereo algorithm that produces dense depth maps and preserves image features',
// Machine Vision and Applications 6, 1993.

// The column of the pixel's partner, of `direction` -1 where the reference is the left view, 1 where it is the right.
fn partner_of(x: i32, disparity: i32, direction: i32) -> i32 {
    return x + direction * ((disparity + SCALE / 2) >> SCALE_BITS);
}

// Whether the disparity of a pixel and that of its partner, in a picture so wide, are at most so far apart.
fn is_consistent(disparity: i32, partner: i32, width: u32, other: i32, max_difference: u32) -> bool {
    let exists = disparity != NONE && partner >= 0 && partner < i32(width) && other != NONE;
    // Only where both exist is their difference sure to be one.
    return exists && u32(abs(disparity - other)) <= max_difference;
}
