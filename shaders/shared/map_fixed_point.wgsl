// Texel of a disparity map in fixed point: the disparity as stored, the sentinel included.

alias Map = texture_storage_2d<r32sint, write>;

fn texel(disparity: i32) -> vec4i {
    return vec4i(disparity, 0, 0, 1);
}
