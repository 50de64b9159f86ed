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

fn pixel(row: u32, x: i32) -> u32 {
    let column = u32(clamp(x, 0, i32(params.width) - 1));
    return extractBits(luma[row + column / 4u], 8u * (column % 4u), 8u);
}

// Four neighbouring pixels of a row, the first at column x in the lowest byte.
fn pixels(row: u32, x: i32) -> u32 {
    if x < 0 || x + 3 >= i32(params.width) {
        return pixel(row, x) | (pixel(row, x + 1) << 8u) | (pixel(row, x + 2) << 16u) | (pixel(row, x + 3) << 24u);
    }
    let word = row + u32(x) / 4u;
    let shift = 8u * (u32(x) % 4u);
    let low = luma[word] >> shift;
    if shift == 0u {
        return low;
    }
    return low | (luma[word + 1u] << (32u - shift));
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
    var word: u32;
    if params.mirrored == 0u {
        word = pixels(row, x);
    } else {
        word = reversed(pixels(row, i32(params.width) - 1 - (x + 3)));
    }
    padded[params.offset + id.y * params.stride + id.x] = word;
}
