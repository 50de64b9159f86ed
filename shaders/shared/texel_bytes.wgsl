// Channels of a texel as bytes.

// sRGB encoding, IEC 61966-2-1. Neighbouring bytes differ by more than twice the error of a conforming decoder and of
// `pow`, so that rounding restores the byte.
fn encoded(levels: vec3f) -> vec3f {
    let dark = 12.92 * levels;
    let bright = 1.055 * pow(levels, vec3f(1.0 / 2.4)) - 0.055;
    return select(bright, dark, levels <= vec3f(0.0031308));
}

// Red, green and blue as bytes, three times the red of a `grey` format; levels that are `linear`, since the format
// decodes sRGB, are encoded again.
fn texel_bytes(texel: vec4f, grey: bool, linear: bool) -> vec3u {
    var levels = clamp(texel.rgb, vec3f(0.0), vec3f(1.0));
    if linear {
        levels = encoded(levels);
    }
    let bytes = vec3u(255.0 * levels + 0.5);
    return select(bytes, bytes.rrr, grey);
}
