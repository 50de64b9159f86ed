// Brightness correction of one view: gain and offset.

struct Brightness {
    // Factor and summand of a luma, in 1/256.
    gain: i32,
    offset: i32,
}

// Four corrected lumas, 0 to 255: rounded to the nearest, then clamped.
fn brightened(lumas: vec4<i32>, by: Brightness) -> vec4<i32> {
    let corrected = (by.gain * lumas + by.offset + 128) >> vec4<u32>(8u);
    return clamp(corrected, vec4<i32>(0), vec4<i32>(255));
}
