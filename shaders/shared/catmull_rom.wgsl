// Catmull-Rom splines along x and y (Keys 1981, a = -1/2), with weights in 1 / ONE.

#import warp_map

// Constants:
//   SUBPIXEL_BITS   bits after the point of positions and weights

fn outer_weight(near: i32, far: i32) -> i32 {
    return -((near * far * far + ONE * ONE) >> u32(2 * SUBPIXEL_BITS + 1));
}

// Weights of the pixels at -1, 0, 1 and 2 for the position t. The sum is ONE, and a ramp is reproduced exactly.
fn weights(t: i32) -> vec4<i32> {
    let rest = ONE - t;
    let first = outer_weight(t, rest);
    let last = outer_weight(rest, t);
    return vec4<i32>(first, rest - 2 * first + last, t - 2 * last + first, last);
}
