// Determinant of the Hessian by box filters (Bay et al., 'Speeded-Up Robust Features', CVIU 110,
// 2008, section 3.2), for the four layers of one octave.
//
// Every corner that the three filters of a point read from the integral image has a counterpart
// one lobe (a third of the filter's side) further on. So, where the grid has a point for every
// pixel, a thread takes four points, two by two, a lobe apart (TILE = 2), and reads 76 corners
// instead of 4 * 32. On coarser grids no corners meet, and a thread takes one point (TILE = 1).

struct Layer {
    // A third of the filter's side.
    lobe: u32,
    // Factors that bring Dxx and Dyy, and Dxy, to 1/256 grey level.
    scale_xx: f32,
    scale_xy: f32,
    padding: u32,
}

struct Params {
    width: u32,
    height: u32,
    // The grid: a point every `step` pixels, from pixel 0 on.
    step: u32,
    grid_width: u32,
    grid_height: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
    layers: array<Layer, 4>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
// Four layers of grid points: determinant << 1 | (trace > 0), or 0 where the filter does not fit.
@group(0) @binding(2) var<storage, read_write> responses: array<i32>;

// Corners outside the picture only ever belong to points whose filter does not fit, and whose
// result is replaced by 0; whatever the bounds checks return for them does no harm.
fn corner(x: u32, y: u32) -> u32 {
    return integral[y * (params.width + 1u) + x];
}

// Sum of the columns left of `x` between the rows `y0` (included) and `y1` (not included).
fn above(x: u32, y0: u32, y1: u32) -> u32 {
    return corner(x, y1) - corner(x, y0);
}

// Sum of the rows over `y` between the columns `x0` (included) and `x1` (not included).
fn beside(x0: u32, x1: u32, y: u32) -> u32 {
    return corner(x1, y) - corner(x0, y);
}

// The weights 1 -2 1 of three lobes side by side, from the running sums at their four borders.
fn second_difference(s0: u32, s1: u32, s2: u32, s3: u32) -> i32 {
    return bitcast<i32>(s3 - s0 - 3u * (s2 - s1));
}

fn dxx(x: u32, y: u32, l: u32) -> i32 {
    let y0 = y - l + 1u;
    let y1 = y + l;
    let x0 = x - (3u * l - 1u) / 2u;
    return second_difference(
        above(x0, y0, y1),
        above(x0 + l, y0, y1),
        above(x0 + 2u * l, y0, y1),
        above(x0 + 3u * l, y0, y1),
    );
}

fn dyy(x: u32, y: u32, l: u32) -> i32 {
    let x0 = x - l + 1u;
    let x1 = x + l;
    let y0 = y - (3u * l - 1u) / 2u;
    return second_difference(
        beside(x0, x1, y0),
        beside(x0, x1, y0 + l),
        beside(x0, x1, y0 + 2u * l),
        beside(x0, x1, y0 + 3u * l),
    );
}

// The lobe right of column `x` minus the lobe left of it, over all rows above `y`.
fn right_minus_left(x: u32, y: u32, l: u32) -> u32 {
    return beside(x + 1u, x + l + 1u, y) - beside(x - l, x, y);
}

fn dxy(x: u32, y: u32, l: u32) -> i32 {
    let upper = right_minus_left(x, y, l) - right_minus_left(x, y - l, l);
    let lower = right_minus_left(x, y + l + 1u, l) - right_minus_left(x, y + 1u, l);
    return bitcast<i32>(upper - lower);
}

// `dxx` at (x, y) and at (x + l, y).
fn dxx_pair(x: u32, y: u32, l: u32) -> vec2i {
    let y0 = y - l + 1u;
    let y1 = y + l;
    let x0 = x - (3u * l - 1u) / 2u;
    let s0 = above(x0, y0, y1);
    let s1 = above(x0 + l, y0, y1);
    let s2 = above(x0 + 2u * l, y0, y1);
    let s3 = above(x0 + 3u * l, y0, y1);
    let s4 = above(x0 + 4u * l, y0, y1);
    return vec2i(second_difference(s0, s1, s2, s3), second_difference(s1, s2, s3, s4));
}

// `dyy` at (x, y) and at (x, y + l).
fn dyy_pair(x: u32, y: u32, l: u32) -> vec2i {
    let x0 = x - l + 1u;
    let x1 = x + l;
    let y0 = y - (3u * l - 1u) / 2u;
    let s0 = beside(x0, x1, y0);
    let s1 = beside(x0, x1, y0 + l);
    let s2 = beside(x0, x1, y0 + 2u * l);
    let s3 = beside(x0, x1, y0 + 3u * l);
    let s4 = beside(x0, x1, y0 + 4u * l);
    return vec2i(second_difference(s0, s1, s2, s3), second_difference(s1, s2, s3, s4));
}

// `right_minus_left` at (x, y) and at (x + l, y).
fn right_minus_left_pair(x: u32, y: u32, l: u32) -> vec2u {
    let c0 = corner(x - l, y);
    let c1 = corner(x, y);
    let c2 = corner(x + 1u, y);
    let c3 = corner(x + l, y);
    let c4 = corner(x + l + 1u, y);
    let c5 = corner(x + 2u * l + 1u, y);
    return vec2u(c4 - c2 - (c1 - c0), c5 - c4 - (c3 - c1));
}

fn response(xx: i32, yy: i32, xy: i32, layer: Layer) -> i32 {
    // One rounded product each, and nothing to fuse it with: the same integers on every device.
    let nxx = i32(round(f32(xx) * layer.scale_xx));
    let nyy = i32(round(f32(yy) * layer.scale_xx));
    let nxy = i32(round(f32(xy) * layer.scale_xy));
    let determinant = nxx * nyy - nxy * nxy;
    return (determinant << 1u) | select(0, 1, nxx + nyy > 0);
}

fn store(i: u32, j: u32, k: u32, lobe: u32, value: i32) {
    if i >= params.grid_width || j >= params.grid_height {
        return;
    }
    let x = i * params.step;
    let y = j * params.step;
    let border = (3u * lobe - 1u) / 2u;
    let fits = x >= border && x + border < params.width && y >= border && y + border < params.height;
    responses[(k * params.grid_height + j) * params.grid_width + i] = select(0, value, fits);
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let k = id.z;
    let layer = params.layers[k];
    let l = layer.lobe;
    if TILE == 1 {
        let x = id.x * params.step;
        let y = id.y * params.step;
        store(id.x, id.y, k, l, response(dxx(x, y, l), dyy(x, y, l), dxy(x, y, l), layer));
        return;
    }
    let x = id.x / l * 2u * l + id.x % l;
    let y = id.y / l * 2u * l + id.y % l;
    let xx_upper = dxx_pair(x, y, l);
    let xx_lower = dxx_pair(x, y + l, l);
    let yy_left = dyy_pair(x, y, l);
    let yy_right = dyy_pair(x + l, y, l);
    let r0 = right_minus_left_pair(x, y - l, l);
    let r1 = right_minus_left_pair(x, y, l);
    let r2 = right_minus_left_pair(x, y + 1u, l);
    let r3 = right_minus_left_pair(x, y + l, l);
    let r4 = right_minus_left_pair(x, y + l + 1u, l);
    let r5 = right_minus_left_pair(x, y + 2u * l + 1u, l);
    let xy_upper = bitcast<vec2i>(r1 - r0 - (r4 - r2));
    let xy_lower = bitcast<vec2i>(r3 - r1 - (r5 - r4));
    store(x, y, k, l, response(xx_upper.x, yy_left.x, xy_upper.x, layer));
    store(x + l, y, k, l, response(xx_upper.y, yy_right.x, xy_upper.y, layer));
    store(x, y + l, k, l, response(xx_lower.x, yy_left.y, xy_lower.x, layer));
    store(x + l, y + l, k, l, response(xx_lower.y, yy_right.y, xy_lower.y, layer));
}
