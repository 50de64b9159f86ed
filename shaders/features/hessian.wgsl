// Determinant of the Hessian by box filters (Bay et al., 'Speeded-Up Robust Features', CVIU 110,
// 2008, section 3.2), for the four layers of one octave.
//
// Every corner that the three filters of a point read from the integral image has a counterpart
// one lobe (a third of the filter's side) further on. So, where the grid has a point for every
// pixel (DENSE), a thread takes four rows a lobe apart and walks along them a lobe at a time,
// reading 12 corners a point instead of 32. On coarser grids no corners meet, and a thread takes
// one point; but half of the filters are those of the finer octave, whose results are copied.

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
    // The grid of the finer octave, and how many layers come from there.
    finer_width: u32,
    finer_height: u32,
    shared_layers: u32,
    layers: array<Layer, 4>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
// Responses of the finer octave, where there is one.
@group(0) @binding(2) var<storage, read> finer: array<i32>;
// Four layers of grid points: determinant << 1 | (trace > 0), or 0 where the filter does not fit.
@group(0) @binding(3) var<storage, read_write> responses: array<i32>;

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

// What follows is for four points at once, at (x, y), (x, y + l), (x, y + 2 l) and (x, y + 3 l).

fn four_corners(x: u32, y: u32, l: u32) -> vec4u {
    return vec4u(corner(x, y), corner(x, y + l), corner(x, y + 2u * l), corner(x, y + 3u * l));
}

fn four_second_differences(s0: vec4u, s1: vec4u, s2: vec4u, s3: vec4u) -> vec4i {
    return bitcast<vec4i>(s3 - s0 - 3u * (s2 - s1));
}

// `above` for the rows of Dxx.
fn four_above(x: u32, y: u32, l: u32) -> vec4u {
    return four_corners(x, y + l, l) - four_corners(x, y - l + 1u, l);
}

fn four_dyy(x: u32, y: u32, l: u32) -> vec4i {
    let x0 = x - l + 1u;
    let x1 = x + l;
    let y0 = y - (3u * l - 1u) / 2u;
    let s = four_corners(x1, y0, l) - four_corners(x0, y0, l);
    let s4 = beside(x0, x1, y0 + 4u * l);
    let s5 = beside(x0, x1, y0 + 5u * l);
    let s6 = beside(x0, x1, y0 + 6u * l);
    return four_second_differences(s, vec4u(s.yzw, s4), vec4u(s.zw, s4, s5), vec4u(s.w, s4, s5, s6));
}

// The columns left of `x`: their lobe above each point minus their lobe below it.
fn four_upper_minus_lower(x: u32, y: u32, l: u32) -> vec4u {
    let above = four_corners(x, y - l, l) - four_corners(x, y + 1u, l);
    let last = corner(x, y + 3u * l) - corner(x, y + 4u * l + 1u);
    return vec4u(above.yzw, last) - above;
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

fn one_point(i: u32, j: u32, k: u32) {
    let l = params.layers[k].lobe;
    let x = i * params.step;
    let y = j * params.step;
    store(i, j, k, l, response(dxx(x, y, l), dyy(x, y, l), dxy(x, y, l), params.layers[k]));
}

// The finer octave's second and fourth filter are this one's first and second.
fn copy(i: u32, j: u32, k: u32) {
    if i < params.grid_width && j < params.grid_height {
        let value = finer[((2u * k + 1u) * params.finer_height + 2u * j) * params.finer_width + 2u * i];
        responses[(k * params.grid_height + j) * params.grid_width + i] = value;
    }
}

// WALK points in each of four rows, all of them a lobe apart, the uppermost left one at (first, y).
fn walk(first: u32, y: u32, k: u32) {
    let layer = params.layers[k];
    let l = layer.lobe;
    // The corners that a point shares with the one before it.
    let border = first - (3u * l - 1u) / 2u;
    var s0 = four_above(border, y, l);
    var s1 = four_above(border + l, y, l);
    var s2 = four_above(border + 2u * l, y, l);
    var left_outer = four_upper_minus_lower(first - l, y, l);
    var right_inner = four_upper_minus_lower(first + 1u, y, l);
    for (var n = 0u; n < WALK; n++) {
        let x = first + n * l;
        let s3 = four_above(border + (n + 3u) * l, y, l);
        let left_inner = four_upper_minus_lower(x, y, l);
        let right_outer = four_upper_minus_lower(x + l + 1u, y, l);
        let xx = four_second_differences(s0, s1, s2, s3);
        let yy = four_dyy(x, y, l);
        let xy = bitcast<vec4i>(right_outer - right_inner - (left_inner - left_outer));
        store(x, y, k, l, response(xx.x, yy.x, xy.x, layer));
        store(x, y + l, k, l, response(xx.y, yy.y, xy.y, layer));
        store(x, y + 2u * l, k, l, response(xx.z, yy.z, xy.z, layer));
        store(x, y + 3u * l, k, l, response(xx.w, yy.w, xy.w, layer));
        s0 = s1;
        s1 = s2;
        s2 = s3;
        left_outer = left_inner;
        right_inner = right_outer;
    }
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let k = id.z;
    if DENSE == 1 {
        let l = params.layers[k].lobe;
        walk(id.x / l * WALK * l + id.x % l, id.y / l * 4u * l + id.y % l, k);
    } else if k < params.shared_layers {
        copy(id.x, id.y, k);
    } else {
        one_point(id.x, id.y, k);
    }
}
