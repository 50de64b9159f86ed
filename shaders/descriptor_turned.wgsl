// The descriptor along each keypoint's orientation.

@group(0) @binding(3) var<storage, read> orientations: array<f32>;
// 16 subregions a keypoint, row by row: sum dx, sum dy, sum |dx|, sum |dy|.
@group(0) @binding(4) var<storage, read_write> descriptors: array<vec4f>;

@compute @workgroup_size(SAMPLES)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(list.count, arrayLength(&list.keypoints)) {
        return;
    }
    let keypoint = list.keypoints[n];
    let x = from_corner(keypoint.x);
    let y = from_corner(keypoint.y);
    let radius = whole(16.0 * keypoint.scale);
    let angle = orientations[n];
    let along = vec2f(cos(angle), sin(angle));
    let across = vec2f(-along.y, along.x);

    let u = f32(local) - 11.5;
    var bands = Bands();
    for (var row = 0u; row < SAMPLES; row++) {
        let v = f32(row) - 11.5;
        let offset = f32(radius) * (u * along + v * across);
        let response = haar(x + whole(offset.x), y + whole(offset.y), radius);
        bands = add(bands, row, vec2f(dot(response, along), dot(response, across)));
    }
    finish(n, local, bands);
}
