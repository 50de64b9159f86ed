// Which pixels of a map are points: those that are near enough, and sure enough.
//
// The module has `params` with `width`, `least` (the smallest disparity of a point, fixed-point) and `min_confidence`, and the buffers
// `disparities` (one i32 per pixel) and `confidences` (rows of ceil(width / 4) u32, one byte per pixel).

fn confidence_at(x: u32, y: u32) -> u32 {
    let word = confidences[y * ((params.width + 3u) / 4u) + x / 4u];
    return word >> (8u * (x % 4u)) & 255u;
}

// Depth falls with disparity, and the sentinel of pixels without a disparity is below all disparities.
fn is_point(x: u32, y: u32) -> bool {
    if x >= params.width {
        return false;
    }
    return disparities[y * params.width + x] >= params.least && confidence_at(x, y) >= params.min_confidence;
}
