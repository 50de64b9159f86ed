// The descriptor along the picture's own axes. Its samples' squares reach to the next samples'
// centres, so 26x26 corners serve all of them: 7 times fewer reads than sample by sample.

// 16 subregions a keypoint, row by row: sum dx, sum dy, sum |dx|, sum |dy|.
@group(0) @binding(3) var<storage, read_write> descriptors: array<vec4f>;

const CORNERS = SAMPLES + 2u;

var<workgroup> corners: array<array<u32, CORNERS>, CORNERS>;

fn three_corners(row: u32, column: u32) -> vec3u {
    return vec3u(corners[row][column], corners[row][column + 1u], corners[row][column + 2u]);
}

@compute @workgroup_size(CORNERS)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let n = group.y * DISPATCH_WIDTH + group.x;
    if n >= min(list.count, arrayLength(&list.keypoints)) {
        return;
    }
    let keypoint = list.keypoints[n];
    let radius = whole(16.0 * keypoint.scale);
    // A sample's offset of m + 1/2 radii rounds to m radii and this.
    let half = (radius + 1) / 2;
    let x = from_corner(keypoint.x) + half + (i32(local) - 13) * radius;
    let y = from_corner(keypoint.y) + half - 13 * radius;
    for (var row = 0u; row < CORNERS; row++) {
        corners[row][local] = area(x, y + i32(row) * radius);
    }
    workgroupBarrier();

    var bands = Bands();
    if local < SAMPLES {
        var upper = three_corners(0u, local);
        var here = three_corners(1u, local);
        for (var row = 0u; row < SAMPLES; row++) {
            let lower = three_corners(row + 2u, local);
            bands = add(bands, row, halves(Ring(upper, here.x, here.z, lower), radius));
            upper = here;
            here = lower;
        }
    }
    finish(n, local, bands);
}
