// Draws points as squares, from a camera that is turned around a point in front of the first one.

struct View {
    // Cosine and sine of the turn around the vertical axis, and the depth of the point that it turns around, in metres.
    cosine: f32,
    sine: f32,
    pivot: f32,
    // Focal length of the camera in units of half the width and of half the height of the frame, and its principal point.
    focal_x: f32,
    focal_y: f32,
    centre_x: f32,
    centre_y: f32,
    // Width and height of a pixel, in the same units.
    side_x: f32,
    side_y: f32,
}

@group(0) @binding(0) var<uniform> view: View;

struct Corner {
    @builtin(position) place: vec4f,
    @location(0) colour: vec3f,
}

// Converts encoded sRGB levels to linear light, as an sRGB target expects (IEC 61966-2-1).
fn linear(encoded: vec3f) -> vec3f {
    let bright = pow((encoded + 0.055) / 1.055, vec3f(2.4));
    return select(bright, encoded / 12.92, encoded <= vec3f(0.04045));
}

// `position`: x to the right, y down and z forward, in metres; `colour`: red, green, blue and confidence.
@vertex
fn corner(
    @location(0) position: vec3f,
    @location(1) colour: vec4f,
    @builtin(vertex_index) index: u32,
) -> Corner {
    let from_pivot = vec3f(position.xy, position.z - view.pivot);
    let x = view.cosine * from_pivot.x + view.sine * from_pivot.z;
    let z = view.pivot + view.cosine * from_pivot.z - view.sine * from_pivot.x;
    let corner = vec2f(vec2u(index & 1u, index >> 1u)) - 0.5;
    // A square of one pixel of the first camera, at any depth.
    let across = view.focal_x * x + view.centre_x * z + corner.x * view.side_x * z;
    let down = view.focal_y * from_pivot.y + view.centre_y * z + corner.y * view.side_y * z;
    // Depths from 0.1 m on are in front of the camera; the nearer one is drawn.
    return Corner(vec4f(across, -down, z - 0.1, z), linear(colour.rgb));
}

@fragment
fn colour(corner: Corner) -> @location(0) vec4f {
    return vec4f(corner.colour, 1.0);
}
