//! A texture of smooth noise, known between the pixels.

/// Smooth noise, 0 to 255, a pure function of its arguments.
fn noise(x: f32, y: f32) -> f32 {
    let lattice = |i: i32, j: i32| {
        let mixed = (i as u32).wrapping_mul(0x9E37_79B9) ^ (j as u32).wrapping_mul(0x85EB_CA6B);
        let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2C1B_3C6D);
        (mixed >> 16 & 0xFF) as f32
    };
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease(x - i), ease(y - j));
    let row = |j| lattice(i as i32, j) * (1.0 - u) + lattice(i as i32 + 1, j) * u;
    row(j as i32) * (1.0 - v) + row(j as i32 + 1) * v
}

/// Grey value of a textured surface, 30 to 222.
pub fn texture(x: f32, y: f32) -> f32 {
    30.0 + 0.45 * noise(x / 7.0, y / 7.0) + 0.3 * noise(x / 17.0 + 50.0, y / 17.0)
}
