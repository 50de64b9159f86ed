// Number of points per row of a map. A workgroup counts a row at a time.

#import point_rule

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
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
@group(0) @binding(2) var<storage, read> confidences: array<u32>;
// Arguments of a draw, then one u32 per row.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;

var<workgroup> total: atomic<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    for (var y = group.x; y < params.height; y += params.groups) {
        var own = 0u;
        for (var x = thread; x < params.width; x += WORKGROUP) {
            own += select(0u, 1u, is_point(x, y));
        }
        if thread == 0u {
            atomicStore(&total, 0u);
        }
        workgroupBarrier();
        atomicAdd(&total, own);
        workgroupBarrier();
        if thread == 0u {
            counts[ARGUMENTS + y] = atomicLoad(&total);
        }
        workgroupBarrier();
    }
}
