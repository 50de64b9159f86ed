// Texel of a disparity map in pixels. The sentinel of pixels without a disparity becomes a number below all
// disparities.

// Constants:
//   SCALE   disparity units per pixel

alias Map = texture_storage_2d<r32float, write>;

fn texel(disparity: i32) -> vec4f {
    // Conversion and product are exact: f32 holds integers up to 2^24, and the factor is a power of two.
    return vec4f(f32(disparity) * (1.0 / f32(SCALE)), 0.0, 0.0, 1.0);
}
