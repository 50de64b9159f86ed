// Semi-global matching, one path: the path costs along all lines of one direction. One thread per line
// (shared/line.wgsl).

#import line

// Constants:
//   WORKGROUP   threads per workgroup
//   QUADS       vectors per pixel of a volume: WORDS / 4

struct Params {
    width: u32,
    // Rows of the band, and the row of the census transforms where the band begins.
    rows: u32,
    first_row: u32,
    // Index in `paths`, in vectors, where the band begins in the volume of this path.
    path_start: u32,
    // 1: lines continue from the row before the band, whose path costs are in `paths`.
    goes_on: u32,
    // Step to the next pixel of a line, -1, 0 or 1 each.
    dx: i32,
    dy: i32,
    // Members from here on are read by select.wgsl alone, whose uniform has this layout too.
    volumes_start: u32,
    volume_quads: u32,
    min_disparity: i32,
    disparities: u32,
    uniqueness: u32,
    confidence_offset: u32,
    key_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// From census.wgsl: the luma of a pixel is the lowest byte of its first u32.
@group(0) @binding(1) var<storage, read> reference: array<vec2<u32>>;
// Matching costs: QUADS vectors per pixel, four disparities packed per u32, 8 bits each.
@group(0) @binding(2) var<storage, read> costs: array<vec4<u32>>;
// Volumes of path costs, packed as the matching costs.
@group(0) @binding(3) var<storage, read_write> paths: array<vec4<u32>>;

@compute @workgroup_size(WORKGROUP, 1)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= line_count() {
        return;
    }
    var line = first_pixel(id.x);
    for (var i = 0u; i < line_length(); i++) {
        let luma = luma_at(line);
        let packed = path_costs(line, luma);
        let start = params.path_start + (u32(line.y) * params.width + u32(line.x)) * QUADS;
        for (var q = 0; q < QUADS; q++) { // unroll
            paths[start + q] = packed[q];
        }
        line = next_pixel(line, packed, luma);
    }
}
