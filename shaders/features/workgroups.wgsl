// How many workgroups the stages after the keypoint list need: one for each keypoint, in rows of
// DISPATCH_WIDTH because one dimension alone ends at 65,535.

#import keypoint

@group(0) @binding(0) var<storage, read> found: u32;
@group(0) @binding(1) var<storage, read> keypoints: array<Keypoint>;
@group(0) @binding(2) var<storage, read_write> groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    // The counter goes on where the room is used up.
    let count = min(found, arrayLength(&keypoints));
    groups[0] = min(count, u32(DISPATCH_WIDTH));
    groups[1] = (count + DISPATCH_WIDTH - 1u) / DISPATCH_WIDTH;
    groups[2] = 1u;
}
