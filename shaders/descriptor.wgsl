// The 64 values that describe each keypoint's surroundings, one workgroup a keypoint: M-SURF
// (Agrawal, Konolige, Blas, 'CenSurE', ECCV 2008, section 3.3), made symmetric.
//
// 24x24 samples; 4x4 subregions of 9x9 samples that overlap. Both Gaussians are products of a
// column's and a row's factor. So a thread walks down one column of samples and gathers the four
// bands of subregions it crosses; then a thread gathers the nine columns of one subregion.

@group(0) @binding(3) var<storage, read> orientations: array<f32>;
// 16 subregions a keypoint, row by row: sum dx, sum dy, sum |dx|, sum |dy|.
@group(0) @binding(4) var<storage, read_write> descriptors: array<vec4f>;

var<workgroup> columns: array<array<vec4f, 4>, 24>;
var<workgroup> squares: array<f32, 16>;

// Of the Gaussian around a subregion's centre, sigma 2.5, for samples up to 4 away.
fn sample_weight(distance: vec4f) -> vec4f {
    return select(vec4f(0.0), exp(-distance * distance / (2.0 * 2.5 * 2.5)), abs(distance) <= vec4f(4.0));
}

@compute @workgroup_size(24)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(list.count, arrayLength(&list.keypoints)) {
        return;
    }
    let keypoint = list.keypoints[n];
    let s = keypoint.scale;
    let angle = orientations[n];
    let along = vec2f(cos(angle), sin(angle));
    let across = vec2f(-along.y, along.x);
    let radius = sixteenths(s);

    let u = f32(local) - 11.5;
    var band_0 = vec4f(0.0);
    var band_1 = vec4f(0.0);
    var band_2 = vec4f(0.0);
    var band_3 = vec4f(0.0);
    for (var row = 0u; row < 24u; row++) {
        let v = f32(row) - 11.5;
        let offset = s * (u * along + v * across);
        let response = haar(keypoint.x + offset.x, keypoint.y + offset.y, radius);
        let rotated = vec2f(dot(response, along), dot(response, across));
        let values = vec4f(rotated, abs(rotated));
        let weights = sample_weight(v - vec4f(-7.5, -2.5, 2.5, 7.5));
        band_0 += weights.x * values;
        band_1 += weights.y * values;
        band_2 += weights.z * values;
        band_3 += weights.w * values;
    }
    columns[local][0] = band_0;
    columns[local][1] = band_1;
    columns[local][2] = band_2;
    columns[local][3] = band_3;
    workgroupBarrier();

    var cell = vec4f(0.0);
    if local < 16u {
        let column = local % 4u;
        let band = local / 4u;
        for (var k = 0u; k < 9u; k++) {
            let distance = f32(k) - 4.0;
            cell += exp(-distance * distance / (2.0 * 2.5 * 2.5)) * columns[5u * column + k][band];
        }
        let from_centre = vec2f(f32(column), f32(band)) - 1.5;
        cell *= exp(-dot(from_centre, from_centre) / (2.0 * 1.5 * 1.5));
        squares[local] = dot(cell, cell);
    }
    workgroupBarrier();

    if local < 16u {
        var square = 0.0;
        for (var k = 0u; k < 16u; k++) {
            square += squares[k];
        }
        let length = sqrt(square);
        descriptors[16u * n + local] = select(cell / length, vec4f(0.0), length < 1e-6);
    }
}
