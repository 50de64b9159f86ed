// Arguments of the indirect dispatches behind the keypoint list: one workgroup per keypoint, in rows of DISPATCH_WIDTH
// workgroups, since one dimension of a dispatch ends at 65,535.

#import keypoint

// Constants:
//   DISPATCH_WIDTH   workgroups per row of a dispatch

// Maxima found, also those for which the list had no room.
@group(0) @binding(0) var<storage, read> keypoint_count: u32;
@group(0) @binding(1) var<storage, read> keypoints: array<Keypoint>;
// Workgroups along x, y and z.
@group(0) @binding(2) var<storage, read_write> groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    // The counter also counts keypoints for which the list had no room.
    let count = min(keypoint_count, arrayLength(&keypoints));
    groups[0] = min(count, u32(DISPATCH_WIDTH));
    groups[1] = (count + DISPATCH_WIDTH - 1u) / DISPATCH_WIDTH;
    groups[2] = 1u;
}
