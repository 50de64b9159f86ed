// Non-maximum suppression over 3x3x3 samples of one octave, and the maximum's position between
// the samples.
//
// Of the two middle layers, 2x2x2 samples at a time are each other's neighbours, so at most one
// of them survives: a thread finds the largest of its block first and then holds only that one
// against its 26 neighbours (Neubeck and Van Gool, 'Efficient Non-Maximum Suppression', ICPR 2006).

struct Params {
    width: u32,
    height: u32,
    step: u32,
    grid_width: u32,
    grid_height: u32,
    octave: u32,
    threshold: i32,
    padding: u32,
    // Filter sides of the four layers, in pixels.
    sizes: vec4u,
}

struct Keypoint {
    x: f32,
    y: f32,
    scale: f32,
    response: i32,
    octave: u32,
    index: u32,
}

struct KeypointList {
    // All that were found, even where the room did not suffice.
    count: atomic<u32>,
    keypoints: array<Keypoint>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> responses: array<i32>;
@group(0) @binding(2) var<storage, read_write> list: KeypointList;

struct Sample {
    determinant: i32,
    // Column and row on the grid, layer.
    at: vec3u,
}

// 3x3 determinants, row by row.
struct Patch {
    above: vec3i,
    level: vec3i,
    below: vec3i,
}

fn response_at(at: vec3u) -> i32 {
    return responses[(at.z * params.grid_height + at.y) * params.grid_width + at.x];
}

fn larger(best: Sample, at: vec3u) -> Sample {
    if at.x < params.grid_width && at.y < params.grid_height {
        let determinant = response_at(at) >> 1u;
        // Equal ones: the earlier of the order (layer, row, column) wins.
        if determinant > best.determinant {
            return Sample(determinant, at);
        }
    }
    return best;
}

fn row(at: vec3u) -> vec3i {
    let left = response_at(at - vec3u(1u, 0u, 0u));
    let right = response_at(at + vec3u(1u, 0u, 0u));
    return vec3i(left, response_at(at), right) >> vec3u(1u);
}

fn patch_around(at: vec3u) -> Patch {
    return Patch(row(at - vec3u(0u, 1u, 0u)), row(at), row(at + vec3u(0u, 1u, 0u)));
}

fn max_of(v: vec3i) -> i32 {
    return max(max(v.x, v.y), v.z);
}

fn max_of_patch(samples: Patch) -> i32 {
    return max_of(max(max(samples.above, samples.level), samples.below));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let block = vec3u(2u * id.x, 2u * id.y, 1u);
    var best = Sample(params.threshold - 1, vec3u(0u));
    best = larger(best, block);
    best = larger(best, block + vec3u(1u, 0u, 0u));
    best = larger(best, block + vec3u(0u, 1u, 0u));
    best = larger(best, block + vec3u(1u, 1u, 0u));
    best = larger(best, block + vec3u(0u, 0u, 1u));
    best = larger(best, block + vec3u(1u, 0u, 1u));
    best = larger(best, block + vec3u(0u, 1u, 1u));
    best = larger(best, block + vec3u(1u, 1u, 1u));
    if best.determinant < params.threshold {
        return;
    }
    let at = best.at;
    let value = best.determinant;

    // All nine neighbours of the layer above the sample must be real ones, not the 0 that says
    // that the filter does not fit. The layers below then fit, too.
    let border = (params.sizes[at.z + 1u] - 1u) / 2u;
    let x = at.x * params.step;
    let y = at.y * params.step;
    let margin = border + params.step;
    if x < margin || x + margin >= params.width || y < margin || y + margin >= params.height {
        return;
    }

    let lower = patch_around(at - vec3u(0u, 0u, 1u));
    let here = patch_around(at);
    let upper = patch_around(at + vec3u(0u, 0u, 1u));
    let earlier = max(max_of_patch(lower), max(max_of(here.above), here.level.x));
    let later = max(max_of_patch(upper), max(max_of(here.below), here.level.z));
    if value <= earlier || value < later {
        return;
    }

    // A quadratic through central differences (Brown and Lowe, BMVC 2002). The power of two keeps
    // the products of three well inside the range of f32 and changes no digit.
    let unit = 1.0 / 65536.0;
    let centre = f32(value) * unit;
    let l0 = vec3f(lower.above) * unit;
    let l1 = vec3f(lower.level) * unit;
    let l2 = vec3f(lower.below) * unit;
    let h0 = vec3f(here.above) * unit;
    let h1 = vec3f(here.level) * unit;
    let h2 = vec3f(here.below) * unit;
    let u0 = vec3f(upper.above) * unit;
    let u1 = vec3f(upper.level) * unit;
    let u2 = vec3f(upper.below) * unit;
    let gradient = 0.5 * vec3f(h1.z - h1.x, h2.y - h0.y, u1.y - l1.y);
    let xx = h1.z + h1.x - 2.0 * centre;
    let yy = h2.y + h0.y - 2.0 * centre;
    let ss = u1.y + l1.y - 2.0 * centre;
    let xy = 0.25 * (h2.z - h2.x - h0.z + h0.x);
    let xs = 0.25 * (u1.z - u1.x - l1.z + l1.x);
    let ys = 0.25 * (u2.y - u0.y - l2.y + l0.y);
    let row_x = vec3f(xx, xy, xs);
    let row_y = vec3f(xy, yy, ys);
    let row_s = vec3f(xs, ys, ss);
    let cofactors_x = cross(row_y, row_s);
    let cofactors_y = cross(row_s, row_x);
    let cofactors_s = cross(row_x, row_y);
    let determinant = dot(row_x, cofactors_x);
    if determinant == 0.0 {
        return;
    }
    let offset = -(gradient.x * cofactors_x + gradient.y * cofactors_y + gradient.z * cofactors_s) / determinant;
    if !all(abs(offset) <= vec3f(0.5)) {
        return;
    }

    let slot = atomicAdd(&list.count, 1u);
    if slot < arrayLength(&list.keypoints) {
        let size = f32(params.sizes[at.z]);
        let interval = size - f32(params.sizes[at.z - 1u]);
        list.keypoints[slot] = Keypoint(
            (f32(at.x) + offset.x) * f32(params.step),
            (f32(at.y) + offset.y) * f32(params.step),
            1.2 * (size + interval * offset.z) / 9.0,
            response_at(at),
            params.octave,
            ((at.z - 1u) * params.grid_height + at.y) * params.grid_width + at.x,
        );
    }
}
