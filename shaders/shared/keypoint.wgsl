// Keypoint: a local maximum of the Hessian's determinant, one element of the keypoint list.

struct Keypoint {
    // Column, row and scale in pixels.
    x: f32,
    y: f32,
    scale: f32,
    // Angle of the dominant gradient, 0 until computed, in radians.
    orientation: f32,
    // The sample's response as the hessian stage stores responses, its octave, its index in the octave's grid.
    response: i32,
    octave: u32,
    index: u32,
}
