// A picture with its edges continued for ever, as much of it as block matching will look at.
//
// Writes rows [first_row, first_row + rows) and columns from first_column on, taken from the
// nearest pixel of the picture, so that no window and no search step has to ask where it is.
// Mirrored, it shows the picture as in a mirror: the right view's search to the right becomes the
// left view's search to the left.

struct Params {
    width: u32,
    height: u32,
    // Of the padded plane, which may begin left of and above the picture.
    first_column: i32,
    first_row: i32,
    rows: u32,
    // Words of a row of the padded plane, and where in the output it begins.
    stride: u32,
    offset: u32,
    mirrored: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> luma: array<u32>;
@group(0) @binding(2) var<storage, read_write> padded: array<u32>;

// Four neighbouring pixels of a row, the first at column x in the lowest byte.
//
// Without a branch: software drivers run both sides of one for every word. Pixels outside are cut
// out of whatever the clamped loads brought, and replaced.
fn pixels(row: u32, x: i32) -> u32 {
    let width = i32(params.width);
    let last_word = (width - 1) / 4;
    let low = luma[row + u32(clamp(x >> 2u, 0, last_word))];
    let high = luma[row + u32(clamp((x >> 2u) + 1, 0, last_word))];
    let shift = 8u * u32(x & 3);
    // Twice by half: a shift by 32 would be one by 0.
    let inside = (low >> shift) | ((high << (16u - shift / 2u)) << (16u - shift / 2u));
    let left = mask(-x);
    let right = ~mask(width - x);
    let first_pixel = (low & 255u) * 0x01010101u;
    let last_pixel = ((high >> (8u * u32((width - 1) & 3))) & 255u) * 0x01010101u;
    return (first_pixel & left) | (last_pixel & right & ~left) | (inside & ~left & ~right);
}

// The lowest n bytes, 0 to 4 of them.
fn mask(n: i32) -> u32 {
    let bits = 4u * u32(clamp(n, 0, 4));
    return ~((0xffffffffu << bits) << bits);
}

fn reversed(word: u32) -> u32 {
    let swapped = ((word >> 8u) & 0x00ff00ffu) | ((word & 0x00ff00ffu) << 8u);
    return (swapped >> 16u) | (swapped << 16u);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.stride || id.y >= params.rows {
        return;
    }
    let y = u32(clamp(params.first_row + i32(id.y), 0, i32(params.height) - 1));
    let row = y * ((params.width + 3u) / 4u);
    let x = params.first_column + 4 * i32(id.x);
    let mirrored = params.mirrored != 0u;
    let word = pixels(row, select(x, i32(params.width) - 1 - (x + 3), mirrored));
    padded[params.offset + id.y * params.stride + id.x] = select(word, reversed(word), mirrored);
}
