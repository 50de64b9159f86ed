// Left-right consistency: a disparity stays if the pixel's partner in the other view has a disparity that leads back.
//
// Fua: 'A parallel stereo algorithm that produces dense depth maps and preserves image features', Machine Vision and
// Applications 6, 1993.

// Constants:
//   SCALE        disparity units per pixel
//   SCALE_BITS   log2(SCALE)
//   NONE         sentinel: the pixel has no disparity

// The column of the partner of the pixel in column x, at the nearest whole disparity. `direction` is -1 if the
// reference is the left view, 1 if the reference is the right view.
fn partner_of(x: i32, disparity: i32, direction: i32) -> i32 {
    return x + direction * ((disparity + SCALE / 2) >> SCALE_BITS);
}

// Whether the disparity of a pixel and the disparity `other` of its partner, in column `partner` of a picture of
// `width` columns, differ by at most `max_difference` disparity units.
fn is_consistent(disparity: i32, partner: i32, width: u32, other: i32, max_difference: u32) -> bool {
    let exists = disparity != NONE && partner >= 0 && partner < i32(width) && other != NONE;
    // Two disparities that exist differ by less than 2^31; a difference from the sentinel may overflow.
    return exists && u32(abs(disparity - other)) <= max_difference;
}
