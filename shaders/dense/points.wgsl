// The points of a map as vertices, in raster order, and the arguments of their draw.
//
// A workgroup writes a row at a time: the points of the rows above say where the row begins, and prefix sums say where each point
// goes (Blelloch, 'Prefix Sums and Their Applications', 1990; here by Hillis and Steele's steps).

#import point_rule
#import texel_bytes
#import words

// Constants:
//   WORKGROUP   threads per workgroup
//   ARGUMENTS   number of u32 in front of the counts

struct Params {
    width: u32,
    height: u32,
    least: i32,
    min_confidence: u32,
    // Number of workgroups.
    groups: u32,
    // Disparities of the first and of the last entry of the table, fixed-point.
    first: i32,
    last: i32,
    // The principal point, in pixels.
    cx: f32,
    cy: f32,
    // Most points that `vertices` holds; those in excess are left out.
    capacity: u32,
    // 0: each point is a vertex; otherwise each is an instance of so many vertices.
    instanced: u32,
    // 1: the picture has the red channel only.
    grey: u32,
    // 1: the picture's format decodes sRGB, so that texels are linear and are encoded again.
    linear: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
@group(0) @binding(2) var<storage, read> confidences: array<u32>;
// Two f32 per disparity: the depth, and the depth divided by the focal length.
@group(0) @binding(3) var words: texture_storage_2d<r32uint, read>;
@group(0) @binding(4) var picture: texture_2d<f32>;
// Vertices, instances, first vertex and first instance of a draw, then the number of points of each row.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
// x, y and z as f32; red, green, blue and confidence as bytes, the first one lowest.
@group(0) @binding(6) var<storage, read_write> vertices: array<vec4u>;

var<workgroup> sums: array<u32, WORKGROUP>;

// The sum of the values of this thread and of those before it.
fn inclusive_sum(value: u32, thread: u32) -> u32 {
    sums[thread] = value;
    workgroupBarrier();
    for (var step = 1u; step < WORKGROUP; step *= 2u) {
        var before = 0u;
        if thread >= step {
            before = sums[thread - step];
        }
        workgroupBarrier();
        sums[thread] += before;
        workgroupBarrier();
    }
    return sums[thread];
}

fn vertex(x: u32, y: u32) -> vec4u {
    let disparity = disparities[y * params.width + x];
    let entry = 2u * u32(clamp(disparity, params.first, params.last) - params.first);
    let depth = bitcast<f32>(word_at(entry));
    let per_pixel = bitcast<f32>(word_at(entry + 1u));
    // One difference and one product, which every device rounds alike.
    let position = vec3f((f32(x) - params.cx) * per_pixel, (f32(y) - params.cy) * per_pixel, depth);
    let bytes = texel_bytes(textureLoad(picture, vec2u(x, y), 0), params.grey != 0u, params.linear != 0u);
    return vec4u(bitcast<vec3u>(position), bytes.r | bytes.g << 8u | bytes.b << 16u | confidence_at(x, y) << 24u);
}

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    for (var y = group.x; y < params.height; y += params.groups) {
        var above = 0u;
        for (var row = thread; row < y; row += WORKGROUP) {
            above += counts[ARGUMENTS + row];
        }
        _ = inclusive_sum(above, thread);
        var written = sums[WORKGROUP - 1];
        workgroupBarrier();
        for (var start = 0u; start < params.width; start += WORKGROUP) {
            let x = start + thread;
            let is_kept = is_point(x, y);
            let index = written + inclusive_sum(select(0u, 1u, is_kept), thread) - 1u;
            if is_kept && index < params.capacity {
                vertices[index] = vertex(x, y);
            }
            written += sums[WORKGROUP - 1];
            workgroupBarrier();
        }
        if thread == 0u && y + 1u == params.height {
            let points = min(written, params.capacity);
            let is_instanced = params.instanced != 0u;
            counts[0] = select(points, params.instanced, is_instanced);
            counts[1] = select(1u, points, is_instanced);
            counts[2] = 0u;
            counts[3] = 0u;
        }
    }
}
