// Non-maximum suppression over 3x3x3 samples of one octave, then the position of the maximum between the samples, one
// axis at a time.
//
// Of a block of 2x2x2 samples in the two middle layers, all neighbours of each other, at most one is a maximum: a
// thread finds the largest sample of its block and compares only that sample with its 26 neighbours (Neubeck and Van
// Gool, 'Efficient Non-Maximum Suppression', ICPR 2006).

#import keypoint

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y

struct Params {
    width: u32,
    height: u32,
    step: u32,
    grid_width: u32,
    grid_height: u32,
    octave: u32,
    threshold: i32,
    padding: u32,
    // Sides of the filters of the four layers, in pixels.
    sizes: vec4u,
}

@group(0) @binding(0) var<uniform> params: Params;
// Four layers of grid points: determinant << 1 | (trace > 0), or 0 where the filter leaves the picture.
@group(0) @binding(1) var<storage, read> responses: array<i32>;
// Maxima found, also those for which the list had no room.
@group(0) @binding(2) var<storage, read_write> keypoint_count: atomic<u32>;
@group(0) @binding(3) var<storage, read_write> keypoints: array<Keypoint>;

struct Sample {
    determinant: i32,
    // Column and row of the grid, layer.
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

fn larger_sample(best: Sample, at: vec3u) -> Sample {
    if at.x < params.grid_width && at.y < params.grid_height {
        let determinant = response_at(at) >> 1u;
        // Of equal determinants the first in the order layer, row, column wins.
        if determinant > best.determinant {
            return Sample(determinant, at);
        }
    }
    return best;
}

fn three_in_row(at: vec3u) -> vec3i {
    let left = response_at(at - vec3u(1u, 0u, 0u));
    let right = response_at(at + vec3u(1u, 0u, 0u));
    return vec3i(left, response_at(at), right) >> vec3u(1u);
}

fn patch_around(at: vec3u) -> Patch {
    return Patch(three_in_row(at - vec3u(0u, 1u, 0u)), three_in_row(at), three_in_row(at + vec3u(0u, 1u, 0u)));
}

fn max_of(v: vec3i) -> i32 {
    return max(max(v.x, v.y), v.z);
}

fn max_of_patch(samples: Patch) -> i32 {
    return max_of(max(max(samples.above, samples.level), samples.below));
}

// Vertex of the parabola through three samples along one axis, of which the middle one is the largest: -0.5 to 0.5
// samples from the middle. The numerator fits in i32; twice the curvature needs u32.
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
    best = larger_sample(best, block);
    best = larger_sample(best, block + vec3u(1u, 0u, 0u));
    best = larger_sample(best, block + vec3u(0u, 1u, 0u));
    best = larger_sample(best, block + vec3u(1u, 1u, 0u));
    best = larger_sample(best, block + vec3u(0u, 0u, 1u));
    best = larger_sample(best, block + vec3u(1u, 0u, 1u));
    best = larger_sample(best, block + vec3u(0u, 1u, 1u));
    best = larger_sample(best, block + vec3u(1u, 1u, 1u));
    if best.determinant < params.threshold {
        return;
    }
    let at = best.at;
    let value = best.determinant;

    // All nine neighbours in the next layer must be responses, not the 0 of a filter that leaves the picture. The
    // smaller filters of the layers below then lie inside too.
    let border = (params.sizes[at.z + 1u] - 1u) / 2u;
    let x = at.x * params.step;
    let y = at.y * params.step;
    let margin = border + params.step;
    if x < margin || x + margin >= params.width || y < margin || y + margin >= params.height {
        return;
    }

    let lower = patch_around(at - vec3u(0u, 0u, 1u));
    let middle = patch_around(at);
    let upper = patch_around(at + vec3u(0u, 0u, 1u));
    let earlier = max(max_of_patch(lower), max(max_of(middle.above), middle.level.x));
    let later = max(max_of_patch(upper), max(max_of(middle.below), middle.level.z));
    if value <= earlier || value < later {
        return;
    }

    let slot = atomicAdd(&keypoint_count, 1u);
    if slot < arrayLength(&keypoints) {
        let size = f32(params.sizes[at.z]);
        let interval = size - f32(params.sizes[at.z - 1u]);
        keypoints[slot] = Keypoint(
            (f32(at.x) + vertex(middle.level.x, value, middle.level.z)) * f32(params.step),
            (f32(at.y) + vertex(middle.above.y, value, middle.below.y)) * f32(params.step),
            1.2 * (size + interval * vertex(lower.level.y, value, upper.level.y)) / 9.0,
            0.0,
            response_at(at),
            params.octave,
            ((at.z - 1u) * params.grid_height + at.y) * params.grid_width + at.x,
        );
    }
}
