// A disparity in pixels; the one that says 'none' as well, which leaves a number below all others.

alias Map = texture_storage_2d<r32float, write>;

fn texel(disparity: i32) -> vec4f {
    // Both are exact: a float holds whole numbers up to 2^24, and the factor is a power of two.
    return vec4f(f32(disparity) * (1.0 / f32(SCALE)), 0.0, 0.0, 1.0);
}
