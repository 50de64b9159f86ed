// Draws the left picture and, beside it, its disparities in false colours.

@group(0) @binding(0) var picture: texture_2d<f32>;
// Disparities in pixels; the sentinel -8388608 stands for no disparity.
@group(0) @binding(1) var disparities: texture_2d<f32>;

// Disparities of the first and the last colour, in pixels.
const FAR = 12.0;
const NEAR = 60.0;

// A triangle that covers the target.
@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let place = vec2f(vec2u(index & 1u, index >> 1u));
    return vec4f(4.0 * place - 1.0, 0.0, 1.0);
}

// The colour map Turbo, by R. Du's polynomial: see src/io/color.rs.
fn turbo(t: f32) -> vec3f {
    let low = vec4f(1.0, t, t * t, t * t * t);
    let high = low.zw * low.z;
    return vec3f(
        dot(low, vec4f(0.13572138, 4.6153926, -42.660324, 132.13108)) + dot(high, vec2f(-152.9424, 59.28638)),
        dot(low, vec4f(0.0914026, 2.1941884, 4.8429667, -14.185033)) + dot(high, vec2f(4.2772986, 2.829566)),
        dot(low, vec4f(0.1066733, 12.641946, -60.58205, 110.36277)) + dot(high, vec2f(-89.90311, 27.34825)),
    );
}

// Converts encoded sRGB levels to linear light, as an sRGB target expects (IEC 61966-2-1).
fn linear(encoded: vec3f) -> vec3f {
    let bright = pow((encoded + 0.055) / 1.055, vec3f(2.4));
    return select(bright, encoded / 12.92, encoded <= vec3f(0.04045));
}

@fragment
fn color(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(place.xy);
    let width = textureDimensions(picture).x;
    if pixel.x < width {
        return textureLoad(picture, pixel, 0);
    }
    let disparity = textureLoad(disparities, pixel - vec2u(width, 0u), 0).r;
    if disparity < -1048576.0 {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let t = clamp((disparity - FAR) / (NEAR - FAR), 0.0, 1.0);
    // Turbo is nearly black at 0.
    return vec4f(linear(clamp(turbo(mix(0.05, 1.0, t)), vec3f(0.0), vec3f(1.0))), 1.0);
}
