// Non-maximum suppression over 3x3x3 samples of one octave, and the maximum's position between
// the samples, an axis at a time.
//
// Of the two middle layers, 2x2x2 samples at a time are each other's neighbours, so at most one
// of them survives: a thread finds the largest of its block first and then holds only that one
// against its 26 neighbours (Neubeck and Van Gool, 'Efficient Non-Maximum Suppression', ICPR 2006).

#import keypoint

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

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> responses: array<i32>;
// All that were found, even where the room did not suffice.
@group(0) @binding(2) var<storage, read_write> found: atomic<u32>;
@group(0) @binding(3) var<storage, read_write> keypoints: array<Keypoint>;

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

// Where the parabola through three samples along one axis has its vertex, from the middle one,
// which is the largest: -0.5 to 0.5. The numerator fits in i32; twice the curvature needs u32.
fn vertex(before: i32, value: i32, after: i32) -> f32 {
    let curvature = bitcast<u32>(2 * value - before - after);
    if curvature == 0u {
        return 0.0;
    }
    return 0.5 * f32(after - before) / f32(curvature);
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

    let slot = atomicAdd(&found, 1u);
    if slot < arrayLength(&keypoints) {
        let size = f32(params.sizes[at.z]);
        let interval = size - f32(params.sizes[at.z - 1u]);
        keypoints[slot] = Keypoint(
            (f32(at.x) + vertex(here.level.x, value, here.level.z)) * f32(params.step),
            (f32(at.y) + vertex(here.above.y, value, here.below.y)) * f32(params.step),
            1.2 * (size + interval * vertex(lower.level.y, value, upper.level.y)) / 9.0,
            0.0,
            response_at(at),
            params.octave,
            ((at.z - 1u) * params.grid_height + at.y) * params.grid_width + at.x,
        );
    }
}
