// What pixels are multiplied with, and what is added to them, in 1/256.
struct Brightness {
    gain: i32,
    offset: i32,
}

// Four pixels after the change of brightness.
fn brightened(pixels: vec4<i32>, by: Brightness) -> vec4<i32> {
    let changed = (by.gain * pixels + by.offset + 128) >> vec4<u32>(8u);
    return clamp(changed, vec4<i32>(0), vec4<i32>(255));
}
