use hsad::{
    features::{keypoints::KeypointList, workgroups::Workgroups},
    reference::workgroups::workgroups,
};

use crate::common::{download, gpu, poison, run, write};

#[test]
fn a_workgroup_for_every_keypoint_in_the_list() {
    let list = KeypointList::new(&gpu().device, 300).unwrap();
    let stage = Workgroups::new(&gpu().device, &list);
    // A count beyond the room of 300 means keypoints that are not in the list.
    for (count, expected) in
        [(0, [0, 0, 1]), (1, [1, 1, 1]), (256, [256, 1, 1]), (257, [256, 2, 1]), (9999, [256, 2, 1])]
    {
        write(list.found(), &[count]);
        poison(stage.groups());
        run(|encoder| stage.record(encoder));
        assert_eq!(download::<u32>(stage.groups()), expected, "{count} keypoints");
        assert_eq!(workgroups(count, 300, 256), expected, "{count} keypoints");
    }
}
