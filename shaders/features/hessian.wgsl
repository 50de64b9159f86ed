// Determinant of the Hessian by box filters, for the four layers of one octave (Bay et al., 'Speeded-Up Robust
// Features', CVIU 110, 2008, section 3.2).
//
// Each corner of the three filters of one point is also a corner of the filters one lobe (a third of the filter's side)
// further on. On the dense grid (DENSE = 1), one point per pixel, a thread takes WALK points in each of four rows, all
// one lobe apart, and reads 12 corners per point instead of 32. On coarser grids no corners coincide: a thread takes
// one point, and copies the responses of filters that the finer octave has already applied.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   DENSE              1: the grid has one point per pixel; 0: fewer
//   WALK               points per thread in each of its four rows, if DENSE

struct Layer {
    // A third of the filter's side, in pixels.
    lobe: u32,
    // Factors from Dxx and Dyy, and from Dxy, to 1/256 grey level.
    scale_xx: f32,
    scale_xy: f32,
    padding: u32,
}

struct Params {
    width: u32,
    height: u32,
    // Grid of this octave: one point every `step` pixels, from pixel 0 on.
    step: u32,
    grid_width: u32,
    grid_height: u32,
    // Grid of the finer octave, and number of layers copied from the finer octave.
    finer_width: u32,
    finer_height: u32,
    shared_layers: u32,
    layers: array<Layer, 4>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> integral: array<u32>;
// Responses of the finer octave, if there is a finer octave.
@group(0) @binding(2) var<storage, read> finer: array<i32>;
// Four layers of grid points: determinant << 1 | (trace > 0), or 0 where the filter leaves the picture.
@group(0) @binding(3) var<storage, read_write> responses: array<i32>;

// Entry of the integral image. Corners outside the picture belong to filters that leave the picture, whose responses
// are replaced by 0: the value that the bounds check returns for such a corner does not matter.
fn corner(x: u32, y: u32) -> u32 {
    return integral[y * (params.width + 1u) + x];
}

// Sum of the columns left of `x`, from row `y0` to row `y1` exclusive.
fn above(x: u32, y0: u32, y1: u32) -> u32 {
    return corner(x, y1) - corner(x, y0);
}

// Sum of the rows above `y`, from column `x0` to column `x1` exclusive.
fn beside(x0: u32, x1: u32, y: u32) -> u32 {
    return corner(x1, y) - corner(x0, y);
}

// Three adjacent lobes weighted 1, -2, 1, from the prefix sums at their four borders.
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

// The lobe right of column `x` minus the lobe left of column `x`, over all rows above `y`.
fn right_minus_left(x: u32, y: u32, l: u32) -> u32 {
    return beside(x + 1u, x + l + 1u, y) - beside(x - l, x, y);
}

fn dxy(x: u32, y: u32, l: u32) -> i32 {
    let upper = right_minus_left(x, y, l) - right_minus_left(x, y - l, l);
    let lower = right_minus_left(x, y + l + 1u, l) - right_minus_left(x, y + 1u, l);
    return bitcast<i32>(upper - lower);
}

// The functions named four_* compute four points at once: (x, y), (x, y + l), (x, y + 2 l) and (x, y + 3 l).

fn four_corners(x: u32, y: u32, l: u32) -> vec4u {
    return vec4u(corner(x, y), corner(x, y + l), corner(x, y + 2u * l), corner(x, y + 3u * l));
}

fn four_second_differences(s0: vec4u, s1: vec4u, s2: vec4u, s3: vec4u) -> vec4i {
    return bitcast<vec4i>(s3 - s0 - 3u * (s2 - s1));
}

// `above` over the rows of the Dxx filters.
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

// Sum of the columns left of `x`: the lobe above each point minus the lobe below the point.
fn four_upper_minus_lower(x: u32, y: u32, l: u32) -> vec4u {
    let above = four_corners(x, y - l, l) - four_corners(x, y + 1u, l);
    let last = corner(x, y + 3u * l) - corner(x, y + 4u * l + 1u);
    return vec4u(above.yzw, last) - above;
}

// Determinant and sign of the trace of one Hessian, as `responses` stores both.
fn response(xx: i32, yy: i32, xy: i32, layer: Layer) -> i32 {
    // Each product is rounded at once and cannot be fused with an addition: the integers are equal on every device.
    let nxx = i32(round(f32(xx) * layer.scale_xx));
    let nyy = i32(round(f32(yy) * layer.scale_xx));
    let nxy = i32(round(f32(xy) * layer.scale_xy));
    let determinant = nxx * nyy - nxy * nxy;
    return (determinant << 1u) | select(0, 1, nxx + nyy > 0);
}

fn store_if_inside(i: u32, j: u32, k: u32, lobe: u32, value: i32) {
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
    store_if_inside(i, j, k, l, response(dxx(x, y, l), dyy(x, y, l), dxy(x, y, l), params.layers[k]));
}

// Layers 0 and 1 have the filters of layers 1 and 3 of the finer octave.
fn copy_from_finer(i: u32, j: u32, k: u32) {
    if i < params.grid_width && j < params.grid_height {
        let value = finer[((2u * k + 1u) * params.finer_height + 2u * j) * params.finer_width + 2u * i];
        responses[(k * params.grid_height + j) * params.grid_width + i] = value;
    }
}

// WALK points in each of four rows, all one lobe apart; the upper left point is (first, y).
fn four_rows(first: u32, y: u32, k: u32) {
    let layer = params.layers[k];
    let l = layer.lobe;
    // Prefix sums of the columns, shared by a point and the next point of its row.
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
        store_if_inside(x, y, k, l, response(xx.x, yy.x, xy.x, layer));
        store_if_inside(x, y + l, k, l, response(xx.y, yy.y, xy.y, layer));
        store_if_inside(x, y + 2u * l, k, l, response(xx.z, yy.z, xy.z, layer));
        store_if_inside(x, y + 3u * l, k, l, response(xx.w, yy.w, xy.w, layer));
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
        four_rows(id.x / l * WALK * l + id.x % l, id.y / l * 4u * l + id.y % l, k);
    } else if k < params.shared_layers {
        copy_from_finer(id.x, id.y, k);
    } else {
        one_point(id.x, id.y, k);
    }
}
