use hsad::verify::trials::WorkgroupsTrial;

use crate::common::{assert_twin, leaves};

#[test]
fn a_workgroup_for_every_keypoint_in_the_list() {
    // A count beyond the capacity of 300 means keypoints that are not in the list.
    for (found, expected) in
        [(0, [0_u32, 0, 1]), (1, [1, 1, 1]), (256, [256, 1, 1]), (257, [256, 2, 1]), (9999, [256, 2, 1])]
    {
        let trial = WorkgroupsTrial { found, capacity: 300 };
        assert_eq!(leaves(&trial), [expected.to_vec().into()], "{found} keypoints");
        assert_twin("workgroups", &trial);
    }
}
