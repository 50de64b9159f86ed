use std::path::Path;

use super::*;
use crate::{
    disparity::{DisparityMap, NONE},
    io::{disparity_png, pfm, png},
};

/// Writes grey pictures of 3x2 pixels, each of one value.
fn pictures(folder: &Path, names: &[(&str, u8)]) {
    for &(name, grey) in names {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let mut bytes = Vec::new();
        png::write_grey8(&mut bytes, &Plane::filled((3, 2), grey)).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
}

/// Writes a map of 3x2 disparities as PNG or PFM, by the file extension.
fn map(path: &Path, disparities: [i32; 6]) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let (map, mut bytes) = (DisparityMap::new((3, 2), disparities.to_vec()).unwrap(), Vec::new());
    if path.extension().unwrap() == "png" {
        disparity_png::write(&mut bytes, &map).unwrap();
    } else {
        pfm::write_disparities(&mut bytes, &map).unwrap();
    }
    std::fs::write(path, bytes).unwrap();
}

fn only(path: &Path) -> SceneFiles {
    let mut scenes = SceneFiles::find(path).unwrap();
    assert_eq!(scenes.len(), 1);
    scenes.remove(0)
}

const KNOWN: [i32; 6] = [256, 512, 768, 1024, 128, NONE];
const PIXELS: [f32; 6] = [1.0, 2.0, 3.0, 4.0, 0.5, f32::INFINITY];

#[test]
fn the_layout_of_the_shipped_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Art");
    pictures(&path, &[("left.png", 1), ("right.png", 2), ("nonocc.png", 255), ("nonocc_right.png", 0)]);
    map(&path.join("disp_left.pfm"), KNOWN);
    let files = only(&path);
    assert_eq!(files.name, "Art");
    assert_eq!(files.files(View::Left).unwrap().len(), 4);
    let scene = files.read(View::Left).unwrap();
    assert_eq!((scene.left.rgb(0, 0), scene.right.rgb(0, 0)), ([1; 3], [2; 3]));
    assert_eq!((scene.truth.data(), scene.non_occluded.as_ref().unwrap().data()), (&PIXELS[..], &[255; 6][..]));
    assert!(files.read(View::Right).unwrap_err().to_string().contains("disp_right.pfm"));
    map(&path.join("disp_right.pfm"), [256; 6]);
    let right = files.read(View::Right).unwrap();
    assert_eq!((right.truth.get(0, 0), right.non_occluded.as_ref().unwrap().get(0, 0)), (1.0, 0));
    assert_eq!(right.reference_view().rgb(0, 0), [2; 3]);

    let scores = scene.score(&Plane::filled((3, 2), 1.0)).unwrap();
    assert_eq!((scores.all.known, scores.all.average), (5, 6.5 / 5.0));
    assert_eq!(scores.non_occluded, Some(scores.all));
    std::fs::remove_file(path.join("nonocc.png")).unwrap();
    assert_eq!(only(&path).read(View::Left).unwrap().score(&scene.truth).unwrap().non_occluded, None);
    std::fs::remove_file(path.join("right.png")).unwrap();
    assert!(only(&path).read(View::Left).unwrap_err().to_string().contains("right.png"));
}

#[test]
fn middlebury_in_both_forms() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    pictures(path, &[("im0.png", 1), ("im1.png", 2), ("mask0nocc.png", 128)]);
    map(&path.join("disp0GT.pfm"), [1; 6]);
    let scene = only(path).read(View::Left).unwrap();
    assert_eq!((scene.truth.get(0, 0), scene.non_occluded.as_ref().unwrap().get(0, 0)), (1.0 / 256.0, 128));
    assert_eq!(scene.score(&scene.truth).unwrap().non_occluded.unwrap().known, 0);
    map(&path.join("disp0.pfm"), KNOWN);
    std::fs::rename(path.join("mask0nocc.png"), path.join("mask0nocc")).unwrap();
    let scene = only(path).read(View::Left).unwrap();
    assert_eq!((scene.truth.data(), scene.non_occluded.unwrap().get(0, 0)), (&PIXELS[..], 128));
}

#[test]
fn kitti_by_frame_and_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("training");
    for frame in ["000001_10", "000000_10", "000000_11"] {
        let of = |folder: &str| format!("{folder}/{frame}.png");
        pictures(&path, &[(&of("image_2"), 1), (&of("image_3"), 2)]);
        if frame.ends_with("10") {
            map(&path.join(of("disp_occ_0")), KNOWN);
            map(&path.join(of("disp_noc_0")), [256, NONE, NONE, NONE, NONE, NONE]);
        }
    }
    let frames = SceneFiles::find(&path).unwrap();
    let names: Vec<_> = frames.iter().map(|frame| &*frame.name).collect();
    assert_eq!(names, ["000000_10", "000001_10"]);
    assert_eq!(SceneFiles::find(folder.path()).unwrap(), frames);
    assert_eq!(only(&path.join("image_2/000001_10.png")), frames[1]);
    let scene = frames[1].read(View::Left).unwrap();
    assert_eq!(scene.truth.data(), PIXELS);
    assert_eq!(scene.non_occluded.unwrap().data(), [255, 0, 0, 0, 0, 0]);
    assert!(frames[0].read(View::Right).unwrap_err().to_string().contains("no truth for the right view"));
    let without_truth = SceneFiles::find(&path.join("image_2/000000_11.png")).unwrap_err().to_string();
    assert!(without_truth.contains("a scene is a folder with"), "{without_truth}");

    // KITTI 2012, in colours and in grey.
    for [left, right] in [["colored_0", "colored_1"], ["image_0", "image_1"]] {
        let path = folder.path().join(left).join("training");
        let picture = |folder: &str| format!("{folder}/000007_10.png");
        pictures(&path, &[(&picture(left), 3), (&picture(right), 4)]);
        map(&path.join(picture("disp_occ")), KNOWN);
        let scene = only(&path).read(View::Left).unwrap();
        assert_eq!((scene.truth.data(), scene.right.rgb(0, 0), scene.non_occluded), (&PIXELS[..], [4; 3], None));
    }
}

#[test]
fn middlebury_to_2006_in_grey_values_by_the_height_of_the_pictures() {
    let folder = tempfile::tempdir().unwrap();
    for (names, height, scale) in [
        (["im2", "im6", "disp2", "disp6"], 375, 1.0 / 4.0),
        (["im2", "im6", "disp2", "disp6"], 381, 1.0 / 8.0),
        (["view1", "view5", "disp1", "disp5"], 370, 1.0 / 3.0),
        (["view1", "view5", "disp1", "disp5"], 1110, 1.0),
        (["view1", "view5", "disp1", "disp5"], 77, f32::NAN),
    ] {
        let path = folder.path().join(height.to_string());
        std::fs::create_dir(&path).unwrap();
        for (name, grey) in names.into_iter().zip([7, 8, 60, 0]) {
            let mut bytes = Vec::new();
            // Of the last map the first column is not known.
            let known = |x: u32| if x == 0 { grey } else { grey.max(7) };
            png::write_grey8(&mut bytes, &Plane::from_fn((2, height), |x, _| known(x))).unwrap();
            std::fs::write(path.join(name).with_extension("png"), bytes).unwrap();
        }
        let files = only(&path);
        if scale.is_nan() {
            assert!(files.read(View::Left).unwrap_err().to_string().ends_with("name the scale of the truth"));
        } else {
            let scene = files.read(View::Left).unwrap();
            assert_eq!((scene.truth.get(1, 1), scene.left.rgb(0, 0)), (60.0 * scale, [7; 3]));
            assert_eq!(files.read(View::Right).unwrap().truth.get(0, 0), f32::INFINITY);
        }
        assert_eq!(files.with_truth_scale(-0.5).read(View::Left).unwrap().truth.get(1, 1), -30.0);
    }
}

#[test]
fn scene_flow_from_its_root_and_below() {
    let folder = tempfile::tempdir().unwrap();
    let (root, sequence) = (folder.path().join("flying"), "TRAIN/A/0000");
    let of = |tree: &str, side: &str, frame: &str| format!("{tree}/{sequence}/{side}/{frame}");
    for frame in ["0006.png", "0007.png"] {
        let views = ["left", "right"].map(|side| of("frames_cleanpass", side, frame));
        pictures(&root, &[(&views[0], 1), (&views[1], 2)]);
    }
    for side in ["left", "right"] {
        map(&root.join(of("disparity", side, "0007.pfm")), KNOWN);
    }
    let scene = only(&root);
    assert_eq!(scene.name, "TRAIN-A-0000-0007");
    let read = scene.read(View::Left).unwrap();
    assert_eq!((read.truth.data(), read.left.rgb(0, 0), read.right.rgb(0, 0)), (&PIXELS[..], [1; 3], [2; 3]));
    assert_eq!(scene.read(View::Right).unwrap().truth.data(), PIXELS);
    assert_eq!(only(&root.join("frames_cleanpass").join(sequence)), scene);
    let negative = scene.clone().with_truth_scale(-1.0).read(View::Left).unwrap();
    assert_eq!((negative.truth.get(0, 0), negative.truth.get(2, 1)), (-1.0, f32::INFINITY));
}

#[test]
fn what_does_not_belong_together_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert!(SceneFiles::find(path).unwrap_err().to_string().contains("a folder without a scene"));
    assert!(SceneFiles::find(&path.join("missing")).unwrap_err().to_string().contains("missing"));
    pictures(path, &[("left.png", 1), ("right.png", 2), ("nonocc.png", 255)]);
    std::fs::write(path.join("disp_left.pfm"), b"Pf\n1 1\n-1\n\0\0\0\0").unwrap();
    let message = |path: &Path| only(path).read(View::Left).unwrap_err().to_string();
    assert!(
        message(path)
            .contains("disp_left.pfm: its size is 1x1 and that of the views 3x2: it belongs to other pictures")
    );
    let wide = Plane::filled((6, 4), 1.0);
    let mut bytes = Vec::new();
    pfm::write(&mut bytes, &wide).unwrap();
    std::fs::write(path.join("disp_left.pfm"), bytes).unwrap();
    assert!(message(path).contains("it belongs to pictures 2.000 times as wide"));
    map(&path.join("disp_left.pfm"), KNOWN);
    let mut bytes = Vec::new();
    png::write_grey8(&mut bytes, &Plane::filled((2, 2), 255)).unwrap();
    std::fs::write(path.join("nonocc.png"), &bytes).unwrap();
    assert!(message(path).contains("nonocc.png: its size is 2x2"));
    std::fs::write(path.join("right.png"), &bytes).unwrap();
    assert!(message(path).contains("the right view 2x2"));
}
