// How many workgroups the stages after the keypoint list need: one for each keypoint, in rows of
// DISPATCH_WIDTH because one dimension alone ends at 65,535.

struct KeypointList {
    count: u32,
    // Six words each, of no interest here.
    keypoints: array<array<u32, 6>>,
}

@group(0) @binding(0) var<storage, read> list: KeypointList;
@group(0) @binding(1) var<storage, read_write> groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    let count = min(list.count, arrayLength(&list.keypoints));
    groups[0] = min(count, u32(DISPATCH_WIDTH));
    groups[1] = (count + DISPATCH_WIDTH - 1u) / DISPATCH_WIDTH;
    groups[2] = 1u;
}
