use hsad::features::{dispatch::Dispatch, keypoints::list_buffer};

use crate::common::{download, gpu, poison, run, write};

#[test]
fn a_workgroup_for_every_keypoint_in_the_list() {
    let list = list_buffer(&gpu().device, 300).unwrap();
    let stage = Dispatch::new(&gpu().device, &list);
    // A count beyond the room of 300 means keypoints that are not in the list.
    for (count, expected) in
        [(0, [0, 0, 1]), (1, [1, 1, 1]), (256, [256, 1, 1]), (257, [256, 2, 1]), (9999, [256, 2, 1])]
    {
        write(&list, &[count]);
        poison(stage.groups());
        run(|encoder| stage.record(encoder));
        assert_eq!(download::<u32>(stage.groups()), expected, "{count} keypoints");
    }
}
