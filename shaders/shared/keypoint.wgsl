// A maximum of the determinant, as the keypoint list holds it.

struct Keypoint {
    // Column, row and scale in pixels.
    x: f32,
    y: f32,
    scale: f32,
    // In radians, 0 until the orientation is known.
    orientation: f32,
    // The sample's response word, and where the sample is.
    response: i32,
    octave: u32,
    index: u32,
}
